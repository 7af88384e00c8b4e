# SPDX-License-Identifier: Apache-2.0
"""Section 4 of [Portsmouth2025]: variance, largest and mean weight of the samplers, by quadrature.

At unit reflectance the weight is f cos(theta_i) / p, and its mean should be 1.
"""

import numpy as np

from mxeon.figures.claims import FAILS, HOLDS, IN_PART, Claim, verdict
from mxeon.models.brdf import eon_brdf
from mxeon.models.quadrature import hemisphere_nodes
from mxeon.models.sampling import SAMPLERS, cltc, ltc

PDF = {sampler.name: sampler.pdf for sampler in SAMPLERS}
DEGREES = np.append(np.arange(0.0, 90.0, 3.0), [89.0, 89.9])
COSINES = np.linspace(0.0, 1.0, 10001)


def moments(name, degrees, roughness, nodes=96):
    """Variance, largest value and mean of the weight, at an angle in degrees."""
    wo, wi, projected = hemisphere_nodes(np.cos(np.radians(degrees)), nodes)
    value, pdf = eon_brdf(wo, wi, 1.0, roughness)[:, 0], PDF[name](wo, wi, roughness)
    drawn = pdf > 0.0
    value, cosine, pdf, projected = value[drawn], wi[drawn, 2], pdf[drawn], projected[drawn]
    mean = projected @ value
    return projected @ (value * value * cosine / pdf) - mean**2, np.max(value * cosine / pdf), mean


def over_angles(name, roughness):
    """The same at all of `DEGREES`, shape (3, angles)."""
    return np.transpose([moments(name, degrees, roughness) for degrees in DEGREES])


def cosine_variance():
    normal, grazing = (moments("cosine", degrees, 1.0)[0] for degrees in (0.0, 89.9))
    found = f"{normal:.4f} at normal incidence, {grazing:.2f} at 89.9°"
    return f"{found}, {grazing / normal:.0f} times", verdict(grazing > 100.0 * normal)


def cosine_diverges():
    """Near grazing, each factor of 10 in mu adds the same: (A r)^2 / 2 ln 10."""
    below = [moments("cosine", 90.0 - np.degrees(mu), 1.0, 200)[0] for mu in (1e-3, 1e-4, 1e-5)]
    listed = ", ".join(f"{variance:.2f}" for variance in below)
    return f"{listed} at mu = 1e-3, 1e-4, 1e-5: without a bound, like the logarithm", FAILS


def gain():
    """The variance of cosine sampling over that of the mixture."""
    parts = []
    for degrees in (60.0, 85.0, 89.0, 89.9, 90.0 - np.degrees(1e-6)):
        cosine, mixture = (moments(name, degrees, 1.0, 200)[0] for name in ("cosine", "eon_cltc"))
        parts.append(f"{cosine / mixture:.0f} at {degrees:.7g}°")
    return f"at r = 1 the ratio is {', '.join(parts)}", IN_PART


def clipped_bias():
    means = {r: over_angles("cltc", r)[2].min() for r in (0.25, 0.5, 0.7, 1.0)}
    listed = ", ".join(f"{100 * (1 - mean):.2f} % at r = {r:g}" for r, mean in means.items())
    return f"energy lost, at most over the angle: {listed}", verdict(max(means.values()) < 0.9999)


def mixture():
    variance, largest, mean = over_angles("eon_cltc", 1.0)
    found = f"variance up to {variance.max():.4f}, weight up to {largest.max():.2f}"
    return f"{found}, mean within {np.abs(mean - 1.0).max():.0e} of 1", verdict(largest.max() < 1.5)


def low_roughness():
    """The variance of mixture and cosine, each averaged over the projected hemisphere."""
    weight = np.sin(np.radians(2.0 * DEGREES))
    parts, worse = [], 0.0
    for r in (0.02, 0.05, 0.1, 0.2):
        both = [weight @ over_angles(name, r)[0] / weight.sum() for name in ("eon_cltc", "cosine")]
        parts.append(f"{both[0]:.1e} and {both[1]:.1e} at r = {r:g}")
        worse = r if both[0] > both[1] else worse
    found = f"variance of mixture and cosine: {', '.join(parts)}"
    return f"{found}; the mixture is the worse one up to r = {worse:g}", IN_PART


def no_number():
    """The draw of Listing 4 divides u1 by P_u where u1 <= P_u."""
    with np.errstate(invalid="ignore"):
        u1 = np.float64(0.0) / np.float64(0.0**0.1)
    return f"at r = 0, u1 = 0: P_u = 0, u1 / P_u = {u1}", verdict(np.isfinite(u1))


def determinant():
    a, b, c, d = (
        entry(COSINES[:, np.newaxis], np.linspace(0.0, 1.0, 101))
        for entry in (ltc.ltc_a, ltc.ltc_b, ltc.ltc_c, ltc.ltc_d)
    )
    det = c * (a - b * d)
    return f"det M from {det.min():.3f} to {det.max():.3f}", verdict(det.min() > 0.0)


def side_of_the_lune():
    """What Listing 3 draws along the normal, where the fitted d is positive."""
    mu = np.linspace(0.999, 1.0, 100_001)
    d = ltc.ltc_d(mu, 1.0)
    u = np.random.default_rng(2).random((2, 200_000))
    wh = cltc.cltc_clipped(*u, -d[-1])
    lowest = np.min(d[-1] * wh[:, 0] + wh[:, 2])
    found = f"d > 0 for mu > {mu[d > 0.0].min():.5f}: up to {d.max():.1e} at r = 1"
    return f"{found}, where the listing draws z down to {lowest:.1e}", verdict(lowest >= 0.0)


def normalized():
    """The density of CLTC over a fine grid; its edge limits the quadrature."""
    errors = []
    for degrees in (0.0, 30.0, 60.0, 85.0):
        wo, wi, projected = hemisphere_nodes(np.cos(np.radians(degrees)), 200)
        errors.append(projected @ (PDF["cltc"](wo, wi, 1.0) / wi[:, 2]) - 1.0)
    largest = np.max(np.abs(errors))
    return f"integral off by {largest:.0e} (quadrature)", verdict(largest < 1e-3)


def wasted():
    d = ltc.ltc_d(COSINES, 1.0)
    share = 1.0 - cltc.cltc_kept_fraction(d)
    at = COSINES[share.argmax()]
    return f"up to {100 * share.max():.2f} % of the samples at r = 1, at mu = {at:g}", HOLDS


CLAIMS = (
    Claim("Fig. 11", "cosine sampling: variance over 100 times larger at grazing", cosine_variance),
    Claim("Fig. 11", "the variance of cosine sampling has a peak", cosine_diverges),
    Claim("Section 4", "det of the inverse of M is positive everywhere", determinant),
    Claim("Section 4", "general LTC wastes samples below the horizon", wasted),
    Claim("Eq. (27), Listing 3", "density of CLTC integrates to 1", normalized),
    Claim("Listing 3", "no sample below the horizon", side_of_the_lune),
    Claim("Fig. 11", "CLTC alone is biased", clipped_bias),
    Claim("Fig. 11", "the mixture: small largest weight, no bias", mixture),
    Claim("Section 4, Fig. 13", "the mixture: variance over 100 times smaller at grazing", gain),
    Claim("Section 4", "the mixture turns into cosine sampling as r goes to 0", low_roughness),
    Claim("Listing 4", "defined for u1 in [0, 1] and r in [0, 1]", no_number),
)
