# SPDX-License-Identifier: Apache-2.0
"""The pbrlib specification of MaterialX: its printed formulas, evaluated as they stand."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.models.diffuse import qon_aq
from tools.paper.claims import Measured, Section

REMARK = f"""Two sentences of that text cannot be measured. It calls the printed L_r of
`oren_nayar_diffuse_bsdf` a radiance; the formula contains neither a cosine nor an irradiance, so it is
the BRDF f, in 1/sr. It describes `roughness` as the sigma of Oren and Nayar; with
`energy_compensation` it is the r of EON, which is dimensionless and lies in [0, 1], where r = 0.5
corresponds to sigma = {0.25 * np.pi:.2f}."""
_OREN_NAYAR = "oren_nayar_diffuse_bsdf"


def directions(theta: ArrayLike, phi: ArrayLike) -> NDArray[np.float64]:
    """Unit vectors at polar angle `theta` and azimuth `phi`, both in degrees."""
    theta, phi = np.radians(theta), np.radians(phi)
    parts = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


SECTION = Section("The specification of MaterialX's pbrlib before June 2026", REMARK)
claim = SECTION.claim


@claim(f"{_OREN_NAYAR}, B", "the B of Oren and Nayar, 0 at sigma = 0", "error")
def coefficient_b() -> Measured:
    """A + B g with the printed B, for sigma = 0, both directions at 60 degrees and together."""
    g = np.sin(np.radians(60.0)) * np.tan(np.radians(60.0))
    value = qon_aq(0.0) + (1.0 - 0.0) * g
    sentence = f"B = 1 at sigma = 0, so pi f / rho = {value:.2f} with both at 60°, not 1"
    right = "[OrenNayar1994] has B = 0.45 sigma^2 / (sigma^2 + 0.09)"
    return f"{sentence}; {right}", abs(value - 1.0)


@claim(f"{_OREN_NAYAR}, g", "the g of Oren and Nayar", "error")
def azimuths() -> Measured:
    """The printed cosine of theta_i - theta_o, for azimuths that are opposite."""
    theta_o = theta_i = np.radians(60.0)
    factor = np.sin(theta_i) * np.tan(theta_o)
    printed = np.cos(theta_i - theta_o) * factor
    right = max(0.0, np.cos(np.pi)) * factor
    sentence = f"both at 60° on opposite sides: g = {printed:.2f} as printed"
    return f"{sentence}, {right:.0f} with max(0, cos(phi_i - phi_o))", abs(printed - right)


@claim("dielectric_bsdf, R", "Fresnel's equations", "error")
def dielectric() -> Measured:
    """Normal incidence, index 1.5: c = 1, g = 1.5."""
    c, g = 1.0, 1.5

    def reflectance(below: float) -> float:
        inner = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
        return 0.5 * (g - c) ** 2 / below**2 * (1.0 + inner**2)

    printed, right = reflectance(g - c), ((g - c) / (g + c)) ** 2
    sentence = f"index 1.5 at normal incidence: R = {printed:.2f} as printed"
    sentence += f", {reflectance(g + c):.2f} with (g + c)^2 in the denominator"
    return sentence, abs(printed - right)


@claim("generalized_schlick_bsdf, F", "r0 at normal incidence", "error")
def schlick() -> Measured:
    """Normal incidence, r0 = 0.04, r90 = 1, exponent 5, color82 = 1 (so that a = 0)."""
    r0, r90, c = 0.04, 1.0, 1.0
    printed = (r0 + (r90 - r0)) * (1.0 - c) ** 5
    right = r0 + (r90 - r0) * (1.0 - c) ** 5
    sentence = f"r0 = 0.04 at normal incidence: F = {printed:.2f} as printed"
    return f"{sentence}, {right:.2f} with the power on (r90 - r0) alone", abs(printed - r0)


@claim("sheen_bsdf, D", "a normalized distribution", "error")
def sheen_distribution() -> Measured:
    """Integral of D cos over the hemisphere, by Gauss-Legendre in theta."""
    x, weight = np.polynomial.legendre.leggauss(200)
    theta, weight = 0.25 * np.pi * (1.0 + x), 0.25 * np.pi * weight
    errors = []
    for r in (0.1, 0.5, 1.0):
        D = (2.0 + 1.0 / r) * np.sin(theta) ** (1.0 / r) / (2.0 * np.pi)
        total = np.sum(2.0 * np.pi * weight * D * np.cos(theta) * np.sin(theta))
        errors.append(abs(total - 1.0))
    return f"integral of D cos is 1 to {max(errors):.0e}", errors


@claim("sheen_bsdf, L_r", "reflects no more than it receives", "albedo", most=1.0)
def sheen_value() -> Measured:
    """Directional albedo of the printed value with c = 1, at roughness 1, for wo at 80 degrees."""
    x, weight = np.polynomial.legendre.leggauss(200)
    theta, d_theta = 0.25 * np.pi * (1.0 + x), 0.25 * np.pi * weight
    phi, d_phi = np.pi * (1.0 + x), np.pi * weight
    theta, phi = theta[:, np.newaxis], phi[np.newaxis]
    wi, wo = directions(np.degrees(theta), np.degrees(phi)), directions(80.0, 0.0)
    wh = (wo + wi) / np.linalg.norm(wo + wi, axis=-1, keepdims=True)
    D = 3.0 * np.sqrt(1.0 - wh[..., 2] ** 2) / (2.0 * np.pi)
    value = D / (wi[..., 2] + wo[2] - wi[..., 2] * wo[2])
    albedo = np.sum(value * wi[..., 2] * np.sin(theta) * np.outer(d_theta, d_phi))
    sentence = f"albedo at 80°, roughness 1, c = 1: {albedo:.2f} as printed"
    return f"{sentence}, {albedo / 4.0:.2f} with a 4 in the denominator", albedo
