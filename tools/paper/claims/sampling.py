# SPDX-License-Identifier: Apache-2.0
"""Claims of [Portsmouth2025], Section 4: mean, variance and largest weight of samplers."""

import numpy as np

from mxeon.models import sampling
from tools.paper.claims import ROUNDING, Measured, Section
from tools.paper.samplers import moments

DEGREES = np.append(np.arange(0.0, 90.0, 3.0), [89.0, 89.9])
COSINES = np.linspace(0.0, 1.0, 10001)
SECTION = Section("Section 4: importance sampling")
claim = SECTION.claim


def at(degrees: float) -> float:
    return float(np.cos(np.radians(degrees)))


def over_angles(name: str, roughness: float) -> np.ndarray:
    """Mean, variance and maximum of a sampler's weight at all polar angles, (3, angles)."""
    return np.transpose([moments(name, at(degrees), roughness) for degrees in DEGREES])


@claim(
    "Fig. 11", "cosine sampling: variance over 100 times larger at grazing", "ratio", least=100.0
)
def cosine_variance() -> Measured:
    normal, grazing = (moments("cosine", at(each), 1.0)[1] for each in (0.0, 89.9))
    sentence = f"{normal:.4f} at normal incidence, {grazing:.2f} at 89.9°"
    return f"{sentence}, {grazing / normal:.0f} times", grazing / normal


@claim(
    "Fig. 11", "the variance of cosine sampling has a peak", "step over the step before", most=0.9
)
def cosine_diverges() -> Measured:
    """Growth of the variance from mu = 1e-4 to 1e-5, divided by the growth from 1e-3 to 1e-4.

    If the variance had a peak, the growth would decrease. Instead, each factor of 10 in mu adds
    (A r)^2 / 2 ln(10) to the variance.
    """
    variances = [moments("cosine", mu, 1.0, nodes=200)[1] for mu in (1e-3, 1e-4, 1e-5)]
    first, second = np.diff(variances)
    listed = ", ".join(f"{variance:.2f}" for variance in variances)
    sentence = f"{listed} at mu = 1e-3, 1e-4, 1e-5: each step adds as much as the one before"
    return f"{sentence} (ratio {second / first:.3f}), without a bound", second / first


@claim("Section 4", "det of the inverse of M is positive everywhere", "det M", least=ROUNDING)
def determinant() -> Measured:
    """Least determinant of the inverse of M over all cosines and roughnesses."""
    a, b, c, d = (
        entry(COSINES[:, np.newaxis], np.linspace(0.0, 1.0, 101))
        for entry in (sampling.ltc_ma, sampling.ltc_mb, sampling.ltc_mc, sampling.ltc_md)
    )
    det = c * (a - b * d)
    return f"det M from {det.min():.3f} to {det.max():.3f}", det.min()


@claim("Section 4", "general LTC wastes samples below the horizon", "share", least=1e-3)
def wasted() -> Measured:
    d = sampling.ltc_md(COSINES, 1.0)
    share = 1.0 - sampling.cltc_kept_fraction(d)
    at = COSINES[share.argmax()]
    sentence = f"up to {100 * share.max():.2f} % of the samples at r = 1, at mu = {at:g}"
    return sentence, share.max()


@claim("Listing 3", "no sample below the horizon", "z", least=0.0)
def side_of_the_lune() -> Measured:
    """Smallest z that Listing 3 samples if wo is the normal, because d > 0 near the normal."""
    mu = np.linspace(0.999, 1.0, 100_001)
    d = sampling.ltc_md(mu, 1.0)
    u1, u2 = np.random.default_rng(2).random((2, 200_000))
    wh = sampling.cltc_clipped(u1, u2, -d[-1])
    lowest = np.min(d[-1] * wh[:, 0] + wh[:, 2])
    sentence = f"d > 0 for mu > {mu[d > 0.0].min():.5f}: up to {d.max():.1e} at r = 1"
    return f"{sentence}, where the listing draws z down to {lowest:.1e}", lowest


@claim("Fig. 11", "CLTC alone is biased", "loss", least=1e-4)
def clipped_bias() -> Measured:
    losses = {r: 1.0 - over_angles("cltc", r)[0].min() for r in (0.25, 0.5, 0.7, 1.0)}
    listed = ", ".join(f"{100 * loss:.2f} % at r = {r:g}" for r, loss in losses.items())
    return f"energy lost, at most over the angle: {listed}", list(losses.values())


@claim("Fig. 11", "the mixture: small largest weight", "weight", most=1.5)
def mixture_weight() -> Measured:
    _, variance, largest = over_angles("eon_cltc", 1.0)
    return f"variance up to {variance.max():.4f}, weight up to {largest.max():.2f}", largest.max()


@claim(
    "Section 4, Fig. 13",
    "the mixture: variance over 100 times smaller at grazing",
    "ratio",
    least=100.0,
)
def gain() -> Measured:
    """Ratios of the variance of cosine sampling to the variance of CLTC plus uniform sampling."""
    parts, ratios = [], []
    for degrees in (60.0, 85.0, 89.0, 89.9, 90.0 - np.degrees(1e-6)):
        cosine, mixture = (
            moments(name, at(degrees), 1.0, nodes=200)[1] for name in ("cosine", "eon_cltc")
        )
        parts.append(f"{cosine / mixture:.0f} at {degrees:.7g}°")
        ratios.append(cosine / mixture)
    return f"at r = 1 the ratio is {', '.join(parts)}", ratios


@claim(
    "Section 4",
    "the mixture turns into cosine sampling as r goes to 0",
    "variance of the mixture over that of cosine",
    most=1.0,
)
def low_roughness() -> Measured:
    """Mean variance of CLTC plus uniform sampling, relative to cosine sampling."""
    weight = np.sin(np.radians(2.0 * DEGREES))
    parts, ratios = [], []
    for r in (0.02, 0.05, 0.1, 0.2):
        mixture, cosine = (
            weight @ over_angles(name, r)[1] / weight.sum() for name in ("eon_cltc", "cosine")
        )
        parts.append(f"{mixture:.1e} and {cosine:.1e} at r = {r:g}")
        ratios.append(mixture / cosine)
    return f"variance of mixture and cosine: {', '.join(parts)}", ratios


@claim("Listing 4", "defined for u1 in [0, 1] and r in [0, 1]", "u1 / P_u", least=0.0, most=1.0)
def no_number() -> Measured:
    """If u1 <= P_u, Listing 4 divides u1 by P_u, so u1 = P_u = 0 results in NaN."""
    with np.errstate(invalid="ignore"):
        u1 = np.float64(0.0) / np.float64(0.0**0.1)
    return f"at r = 0, u1 = 0: P_u = 0, u1 / P_u = {u1}", u1
