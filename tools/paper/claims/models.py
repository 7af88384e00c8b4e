# SPDX-License-Identifier: Apache-2.0
"""Sections 2 and 3 of [Portsmouth2025]: values and albedos of QON, FON and EON."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.diffuse import (
    C1,
    eon_albedo_dir,
    eon_brdf,
    fon_albedo_avg,
    fon_albedo_dir,
    fon_albedo_dir_approx,
    fon_brdf,
    oren_nayar_brdf,
    qon_albedo_avg,
    qon_albedo_dir,
    qon_aq,
    qon_bq,
    qon_brdf,
    qon_fujii_brdf,
)
from tools.paper.claims import ROUNDING, Measured, Section

MU = np.array([0.0, 1e-3, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0])
FINE = np.linspace(0.0, 1.0, 10001)
SIGMA = np.array([0.1, 0.2, 0.3, 0.5, 0.8, 0.5 * np.pi])
ROUGHNESS = np.array([0.1, 0.5, 1.0])
RHO = np.array([0.18, 0.8, 1.0])
# Full Oren-Nayar exceeds albedo 1 below this sigma; above it is called high.
HIGH_SIGMA = 0.6
SECTION = Section("Sections 2 and 3: the models")
claim = SECTION.claim


def pairs(count: int = 100_000) -> np.ndarray:
    """Random pairs of directions of the hemisphere."""
    rng = np.random.default_rng(1)
    z, phi = rng.random((2, count)), 2.0 * np.pi * rng.random((2, count))
    S = np.sqrt((1.0 - z) * (1.0 + z))
    return np.stack([S * np.cos(phi), S * np.sin(phi), z], axis=-1)


def agreement(*errors: ArrayLike) -> Measured:
    """Largest error, which should be rounding."""
    largest = max(float(np.max(np.abs(error))) for error in errors)
    return f"largest difference {largest:.1e}", largest


def average(albedo: Callable[..., Any], *parameter: float) -> float:
    """Integral of 2 mu E(mu) over [0, 1], with the variable theta, in which albedos are smooth."""
    x, weight = np.polynomial.legendre.leggauss(64)
    theta, weight = 0.25 * np.pi * (1.0 + x), 0.25 * np.pi * weight
    return float(np.sum(weight * np.sin(2.0 * theta) * albedo(np.cos(theta), *parameter)))


@claim("Eqs. (1)-(4)", "the vector form of QON is its angular form")
def vector_form() -> Measured:
    wo, wi = pairs()
    theta_o, theta_i = np.arccos(wo[:, 2]), np.arccos(wi[:, 2])
    phi = np.arctan2(wi[:, 1], wi[:, 0]) - np.arctan2(wo[:, 1], wo[:, 0])
    alpha, beta = np.maximum(theta_o, theta_i), np.minimum(theta_o, theta_i)
    g = np.maximum(np.cos(phi), 0.0) * np.sin(alpha) * np.tan(beta)
    value = (qon_aq(0.7) + qon_bq(0.7) * g) / np.pi
    return agreement((value - qon_brdf(wo, wi, 1.0, 0.7)[:, 0]) / np.maximum(g, 1.0))


@claim("Eqs. (5), (8)", "directional albedo of QON")
def qon_directional() -> Measured:
    return agreement(
        *(qon_albedo_dir(MU, s) - albedo_dir_quadrature(qon_brdf, MU, 1.0, s)[:, 0] for s in SIGMA)
    )


@claim("below Eq. (8)", "G_q tends to pi/2 at grazing")
def qon_grazing() -> Measured:
    G = np.pi * (qon_albedo_dir(0.0, SIGMA) - qon_aq(SIGMA)) / qon_bq(SIGMA)
    return agreement(G - np.pi / 2.0)


@claim("Eq. (9)", "average albedo of QON")
def qon_average() -> Measured:
    return agreement(*(qon_albedo_avg(s) - average(qon_albedo_dir, s) for s in SIGMA))


@claim(
    "below Eq. (9)",
    "QON exceeds albedo 1 at grazing and low sigma",
    "excess over 1",
    least=ROUNDING,
)
def qon_gain() -> Measured:
    sigma = np.linspace(0.0, 0.5 * np.pi, 1001)
    albedo = qon_albedo_dir(0.0, sigma)
    place = f"E = {albedo.max():.4f} at grazing, sigma = {sigma[albedo.argmax()]:.2f}"
    return f"{place}; above 1 up to sigma = {sigma[albedo > 1.0].max():.2f}", albedo.max() - 1.0


@claim(
    "footnote 4",
    "full Oren-Nayar exceeds 1 near grazing, except at high sigma",
    f"excess over 1 below sigma = {HIGH_SIGMA}, shortfall above,",
    least=ROUNDING,
)
def full_gain() -> Measured:
    """The distance of the largest albedo from 1, on the claimed side."""
    mu = np.array([1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2])
    albedos = np.array([albedo_dir_quadrature(oren_nayar_brdf, mu, 1.0, s).max() for s in SIGMA])
    listed = ", ".join(f"{E:.3f} at sigma = {s:.2g}" for s, E in zip(SIGMA, albedos, strict=True))
    side = np.where(SIGMA < HIGH_SIGMA, 1.0, -1.0)
    return f"largest E for mu <= 0.2: {listed}", side * (albedos - 1.0)


@claim(
    "Section 1, [Fujii2013]",
    "Fujii's QON resembles full Oren-Nayar",
    "its rms over the least of the others",
    most=1.0,
)
def rms_to_full() -> Measured:
    wo, wi = pairs()
    full = oren_nayar_brdf(wo, wi, 0.8, 0.25 * np.pi)[:, 0]
    values = {
        "Fujii's QON": qon_fujii_brdf(wo, wi, 0.8, 0.25 * np.pi),
        "FON": fon_brdf(wo, wi, 0.8, 0.5),
        "QON": qon_brdf(wo, wi, 0.8, 0.25 * np.pi),
        "EON": eon_brdf(wo, wi, 0.8, 0.5),
    }
    rms = {n: np.sqrt(np.mean(((v[:, 0] - full) * wi[:, 2]) ** 2)) for n, v in values.items()}
    listed = ", ".join(f"{name} {value:.4f}" for name, value in rms.items())
    nearest = min(value for name, value in rms.items() if name != "Fujii's QON")
    sentence = f"rms of f cos to full Oren-Nayar, over random pairs: {listed}"
    return sentence, rms["Fujii's QON"] / nearest


@claim(
    "Sections 1, 2.2",
    "FON fixes QON's discontinuity and dark ring",
    "jump in FON over jump in QON",
    most=0.1,
)
def kink() -> Measured:
    """Jumps of the slope of f in s at s = 0, at the largest roughness, both directions at the same angle."""
    parts, ratios = [], []
    for degrees in (5, 25, 60):
        mu = np.cos(np.radians(degrees))
        qon, fon = qon_bq(0.5 * np.pi) / mu, (1.0 / mu - 1.0) / (1.0 + C1)
        parts.append(f"{qon:.2g} / pi in QON and {fon:.2g} / pi in FON at {degrees}°")
        ratios.append(fon / qon)
    return f"at s = 0 the slope of f in s jumps by {', '.join(parts)}", ratios


@claim("Eqs. (12), (13)", "directional albedo of FON")
def fon_directional() -> Measured:
    return agreement(
        *(
            fon_albedo_dir(MU, r) - albedo_dir_quadrature(fon_brdf, MU, 1.0, r)[:, 0]
            for r in ROUGHNESS
        )
    )


@claim(
    "below Eq. (13)",
    "FON conserves energy, and preserves it at grazing",
    "excess over 1",
)
def fon_conserves() -> Measured:
    albedo = fon_albedo_dir(FINE[:, np.newaxis], ROUGHNESS)
    excess, grazing = albedo.max() - 1.0, np.abs(albedo[0] - 1.0).max()
    return f"largest E = 1 + {excess:.1e}; at mu = 0, E = 1 to {grazing:.1e}", [excess, grazing]


@claim("Eq. (14)", "the quartic is within 0.1 % of the albedo", "error", most=1e-3)
def quartic() -> Measured:
    error = np.abs(fon_albedo_dir_approx(FINE, 1.0) - fon_albedo_dir(FINE, 1.0)).max()
    return f"{100 * error:.3f} % at r = 1", error


@claim("Eq. (14)", "with it the albedo stays at most 1", "excess over 1")
def quartic_conserves() -> Measured:
    mu = np.linspace(0.0, 0.01, 10001)
    albedo = fon_albedo_dir_approx(mu, 1.0)
    excess = albedo.max() - 1.0
    return f"E exceeds 1 by {excess:.1e}, for mu < {mu[albedo > 1.0].max():.4f}", excess


@claim("Eq. (15)", "average albedo of FON")
def fon_average() -> Measured:
    return agreement(*(fon_albedo_avg(r) - average(fon_albedo_dir, r) for r in ROUGHNESS))


@claim("below Eq. (15)", "FON loses about 20 % at high roughness", "loss", least=0.15, most=0.25)
def fon_loses() -> Measured:
    average_loss, largest = 1.0 - fon_albedo_avg(1.0), 1.0 - fon_albedo_dir(1.0, 1.0)
    sentence = f"at r = 1, {100 * average_loss:.1f} % on average, {100 * largest:.1f} % at most"
    return sentence, [average_loss, largest]


@claim("Eqs. (16), (19)", "EON as printed is EON as computed here")
def printed_eon() -> Measured:
    """Eqs. (16) and (19) as printed, with quotients 0/0."""
    wo, wi = pairs()
    errors = []
    for r in ROUGHNESS:
        loss_o, loss_i = 1.0 - fon_albedo_dir(wo[:, 2], r), 1.0 - fon_albedo_dir(wi[:, 2], r)
        E = fon_albedo_avg(r)
        for rho in RHO:
            multiple = rho**2 / np.pi * E / (1.0 - rho * (1.0 - E)) * loss_o * loss_i / (1.0 - E)
            value = fon_brdf(wo, wi, rho, r)[:, 0] + multiple
            errors.append((value - eon_brdf(wo, wi, rho, r)[:, 0]) * wi[:, 2])
    return agreement(*errors)


@claim("Eq. (18)", "closed form of the series of bounces")
def series() -> Measured:
    bounces, errors = np.arange(1, 400)[:, np.newaxis], []
    for r in ROUGHNESS:
        E = fon_albedo_avg(r)
        total = np.sum(RHO * E * (RHO * (1.0 - E)) ** bounces, axis=0)
        errors.append(total - RHO**2 * E * (1.0 - E) / (1.0 - RHO * (1.0 - E)))
    return agreement(*errors)


@claim("Eq. (20)", "albedo of the multiple-scattering lobe")
def multiple_albedo() -> Measured:
    def multiple_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, r: float) -> Any:
        return eon_brdf(wo, wi, rho, r) - fon_brdf(wo, wi, rho, r)

    E = fon_albedo_avg(1.0)
    share = RHO**2 * E * (1.0 - E) / (1.0 - RHO * (1.0 - E))
    lost = (1.0 - fon_albedo_dir(MU, 1.0))[:, np.newaxis]
    albedo = albedo_dir_quadrature(multiple_brdf, MU[:, np.newaxis], RHO[:, np.newaxis], 1.0)
    return agreement(albedo[..., 0] - share * lost / (1.0 - E))


@claim("Section 3", "EON passes the white furnace: E = 1 at rho = 1")
def furnace() -> Measured:
    return agreement(*(albedo_dir_quadrature(eon_brdf, MU, 1.0, r)[:, 0] - 1.0 for r in ROUGHNESS))


@claim("Section 3", "EON is reciprocal")
def reciprocal() -> Measured:
    wo, wi = pairs()
    return agreement(eon_brdf(wo, wi, RHO, 1.0) - eon_brdf(wi, wo, RHO, 1.0))


@claim("Eq. (28)", "directional albedo of EON")
def eon_directional() -> Measured:
    return agreement(
        *(
            eon_albedo_dir(MU, rho, r)[:, 0] - albedo_dir_quadrature(eon_brdf, MU, rho, r)[:, 0]
            for r in ROUGHNESS
            for rho in RHO
        )
    )


def listing_1_albedo(mu: np.ndarray) -> np.ndarray:
    """The exact albedo of the listing at roughness 1, in the order of its operations, float32 for float32."""
    one, third = np.float32(1.0), np.float32(2.0 / 3.0)
    S = np.sqrt(one - mu * mu)
    with np.errstate(divide="ignore", invalid="ignore"):
        G = S * (np.arccos(mu) - S * mu) + third * ((S / mu) * (one - S * S * S) - S)
    A = one / (one + np.float32(C1))
    albedo: np.ndarray = A + A * G / np.float32(np.pi)
    return albedo


@claim("Listing 1", "its exact albedo is exact in float32, to 1e-6", "error", most=1e-6)
def listing_1() -> Measured:
    mu = np.append(np.float32(0.0), np.logspace(-6.0, 0.0, 100_001, dtype=np.float32))
    error = np.abs(listing_1_albedo(mu) - fon_albedo_dir(mu, 1.0))
    at = mu[np.nanargmax(error)]
    sentence = f"{error[0]} at mu = 0; error up to {np.nanmax(error):.2e}, at mu = {at:.1e}"
    return sentence, [error[0], np.nanmax(error)]
