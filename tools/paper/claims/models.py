# SPDX-License-Identifier: Apache-2.0
"""Claims of [Portsmouth2025], Sections 2 and 3: values and albedos of QON, FON and EON."""

import numpy as np

from mxeon.models import diffuse
from mxeon.models.core.quadrature import albedo_dir_quadrature
from tools.paper.claims import ROUNDING, Measured, Section

FINE = np.linspace(0.0, 1.0, 10001)
SIGMA = np.array([0.1, 0.2, 0.3, 0.5, 0.8, 0.5 * np.pi])
ROUGHNESS = np.array([0.1, 0.5, 1.0])
# The paper claims albedos of the full Oren-Nayar model above 1 for sigmas below HIGH_SIGMA.
HIGH_SIGMA = 0.6
SECTION = Section("Sections 2 and 3: the models")
claim = SECTION.claim


def pairs(count: int = 100_000) -> np.ndarray:
    rng = np.random.default_rng(1)
    z, phi = rng.random((2, count)), 2.0 * np.pi * rng.random((2, count))
    S = np.sqrt((1.0 - z) * (1.0 + z))
    return np.stack([S * np.cos(phi), S * np.sin(phi), z], axis=-1)


@claim(
    "below Eq. (9)",
    "QON exceeds albedo 1 at grazing and low sigma",
    "excess over 1",
    least=ROUNDING,
)
def qon_gain() -> Measured:
    sigma = np.linspace(0.0, 0.5 * np.pi, 1001)
    albedo = diffuse.qon_albedo_dir(0.0, sigma)
    place = f"E = {albedo.max():.4f} at grazing, sigma = {sigma[albedo.argmax()]:.2f}"
    return f"{place}; above 1 up to sigma = {sigma[albedo > 1.0].max():.2f}", albedo.max() - 1.0


@claim(
    "footnote 4",
    "full Oren-Nayar exceeds 1 near grazing, except at high sigma",
    f"excess over 1 below sigma = {HIGH_SIGMA}, shortfall above,",
    least=ROUNDING,
)
def full_gain() -> Measured:
    """Largest albedos minus 1 for low sigmas, and 1 minus largest albedos for high sigmas."""
    mu = np.array([1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2])
    albedos = np.array(
        [albedo_dir_quadrature(diffuse.oren_nayar_brdf, mu, 1.0, s).max() for s in SIGMA]
    )
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
    full = diffuse.oren_nayar_brdf(wo, wi, 0.8, 0.25 * np.pi)[:, 0]
    values = {
        "Fujii's QON": diffuse.qon_fujii_brdf(wo, wi, 0.8, 0.25 * np.pi),
        "FON": diffuse.fon_brdf(wo, wi, 0.8, 0.5),
        "QON": diffuse.qon_brdf(wo, wi, 0.8, 0.25 * np.pi),
        "EON": diffuse.eon_brdf(wo, wi, 0.8, 0.5),
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
    """Jumps of df/ds at s = 0 for the largest roughness and for equal polar angles of wo and wi."""
    parts, ratios = [], []
    for degrees in (5, 25, 60):
        mu = np.cos(np.radians(degrees))
        qon, fon = diffuse.qon_bq(0.5 * np.pi) / mu, (1.0 / mu - 1.0) / (1.0 + diffuse.C1)
        parts.append(f"{qon:.2g} / pi in QON and {fon:.2g} / pi in FON at {degrees}°")
        ratios.append(fon / qon)
    return f"at s = 0 the slope of f in s jumps by {', '.join(parts)}", ratios


@claim(
    "below Eq. (13)",
    "FON conserves energy, and preserves it at grazing",
    "excess over 1",
)
def fon_conserves() -> Measured:
    albedo = diffuse.fon_albedo_dir(FINE[:, np.newaxis], ROUGHNESS)
    excess, grazing = albedo.max() - 1.0, np.abs(albedo[0] - 1.0).max()
    return f"largest E = 1 + {excess:.1e}; at mu = 0, E = 1 to {grazing:.1e}", [excess, grazing]


@claim("Eq. (14)", "the quartic is within 0.1 % of the albedo", "error", most=1e-3)
def quartic() -> Measured:
    error = np.abs(
        diffuse.fon_albedo_dir_approx(FINE, 1.0) - diffuse.fon_albedo_dir(FINE, 1.0)
    ).max()
    return f"{100 * error:.3f} % at r = 1", error


@claim("Eq. (14)", "with it the albedo stays at most 1", "excess over 1")
def quartic_conserves() -> Measured:
    mu = np.linspace(0.0, 0.01, 10001)
    albedo = diffuse.fon_albedo_dir_approx(mu, 1.0)
    excess = albedo.max() - 1.0
    return f"E exceeds 1 by {excess:.1e}, for mu < {mu[albedo > 1.0].max():.4f}", excess


@claim("below Eq. (15)", "FON loses about 20 % at high roughness", "loss", least=0.15, most=0.25)
def fon_loses() -> Measured:
    average_loss, largest = (
        1.0 - diffuse.fon_albedo_avg(1.0),
        1.0 - diffuse.fon_albedo_dir(1.0, 1.0),
    )
    sentence = f"at r = 1, {100 * average_loss:.1f} % on average, {100 * largest:.1f} % at most"
    return sentence, [average_loss, largest]


def listing_1_albedo(mu: np.ndarray) -> np.ndarray:
    """The exact albedo at roughness 1, computed in float32 with the operations of Listing 1."""
    one, third = np.float32(1.0), np.float32(2.0 / 3.0)
    S = np.sqrt(one - mu * mu)
    with np.errstate(divide="ignore", invalid="ignore"):
        G = S * (np.arccos(mu) - S * mu) + third * ((S / mu) * (one - S * S * S) - S)
    A = one / (one + np.float32(diffuse.C1))
    albedo: np.ndarray = A + A * G / np.float32(np.pi)
    return albedo


@claim("Listing 1", "its exact albedo is exact in float32, to 1e-6", "error", most=1e-6)
def listing_1() -> Measured:
    mu = np.append(np.float32(0.0), np.logspace(-6.0, 0.0, 100_001, dtype=np.float32))
    error = np.abs(listing_1_albedo(mu) - diffuse.fon_albedo_dir(mu, 1.0))
    at = mu[np.nanargmax(error)]
    sentence = f"{error[0]} at mu = 0; error up to {np.nanmax(error):.2e}, at mu = {at:.1e}"
    return sentence, [error[0], np.nanmax(error)]
