# SPDX-License-Identifier: Apache-2.0
"""The pbrlib specification of MaterialX: its formulas at their word, and what they give."""

import numpy as np

from mxeon.figures.claims import FAILS, HOLDS, IN_PART, Claim, verdict
from mxeon.figures.curves import directions
from mxeon.models.formulas import qon_a


def coefficient_b():
    """A + B g with the printed B, for sigma = 0, both directions at 60 degrees and together."""
    g = np.sin(np.radians(60.0)) * np.tan(np.radians(60.0))
    value = qon_a(0.0) + (1.0 - 0.0) * g
    found = f"B = 1 at sigma = 0, so pi f / rho = {value:.2f} with both at 60°, not 1"
    return f"{found}; [OrenNayar1994] has B = 0.45 sigma^2 / (sigma^2 + 0.09)", FAILS


def azimuths():
    """The printed cosine of theta_i - theta_o, for azimuths that are opposite."""
    g = np.sin(np.radians(60.0)) * np.tan(np.radians(60.0))
    found = f"both at 60° on opposite sides: g = {g:.2f} as printed"
    return f"{found}, 0 with max(0, cos(phi_i - phi_o))", FAILS


def radiance():
    return "what is printed has no cosine and no irradiance: it is f, in 1/sr", FAILS


def roughness():
    found = "with `energy_compensation` it is the r of EON, dimensionless in [0, 1]"
    return f"{found}: r = 0.5 compares with sigma = {0.25 * np.pi:.2f}", IN_PART


def dielectric():
    """Normal incidence, index 1.5: c = 1, g = 1.5."""
    c, g = 1.0, 1.5

    def fresnel(below):
        inner = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
        return 0.5 * (g - c) ** 2 / below**2 * (1.0 + inner**2)

    found = f"index 1.5 head-on: R = {fresnel(g - c):.2f} as printed"
    return f"{found}, {fresnel(g + c):.2f} with (g + c)^2 below", FAILS


def schlick():
    """Normal incidence, r0 = 0.04, r90 = 1, exponent 5, color82 = 1 (so that a = 0)."""
    r0, r90, c = 0.04, 1.0, 1.0
    printed = (r0 + (r90 - r0)) * (1.0 - c) ** 5
    right = r0 + (r90 - r0) * (1.0 - c) ** 5
    found = f"r0 = 0.04 head-on: F = {printed:.2f} as printed"
    return f"{found}, {right:.2f} with the power beside (r90 - r0) alone", FAILS


def sheen_distribution():
    """Integral of D cos over the hemisphere, by Gauss-Legendre in theta."""
    x, weight = np.polynomial.legendre.leggauss(200)
    theta, weight = 0.25 * np.pi * (1.0 + x), 0.25 * np.pi * weight
    off = 0.0
    for r in (0.1, 0.5, 1.0):
        D = (2.0 + 1.0 / r) * np.sin(theta) ** (1.0 / r) / (2.0 * np.pi)
        total = np.sum(2.0 * np.pi * weight * D * np.cos(theta) * np.sin(theta))
        off = max(off, abs(total - 1.0))
    return f"integral of D cos is 1 to {off:.0e}", HOLDS


def sheen_value():
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
    found = f"albedo at 80°, roughness 1, c = 1: {albedo:.2f} as printed"
    return f"{found}, {albedo / 4.0:.2f} with a 4 below", verdict(albedo <= 1.0)


CLAIMS = (
    Claim("oren_nayar_diffuse_bsdf, B", "the B of Oren and Nayar, 0 at sigma = 0", coefficient_b),
    Claim("oren_nayar_diffuse_bsdf, g", "the g of Oren and Nayar", azimuths),
    Claim("oren_nayar_diffuse_bsdf, L_r", "a radiance", radiance),
    Claim("oren_nayar_diffuse_bsdf", "`roughness` is sigma", roughness),
    Claim("dielectric_bsdf, R", "Fresnel's equations", dielectric),
    Claim("generalized_schlick_bsdf, F", "r0 at normal incidence", schlick),
    Claim("sheen_bsdf, D", "a normalized distribution", sheen_distribution),
    Claim("sheen_bsdf, L_r", "reflects no more than it receives", sheen_value),
)
