# SPDX-License-Identifier: Apache-2.0
"""Fit of the fraction of light that GGX facets transmit if the relative IOR n is below 1.

Facets beyond the critical angle reflect everything, so no single cosine can represent all facets.
Let tau be the cotangent of the angle between wo and the normal of a facet, and let tau_c be tau at
the critical angle: tau_c^2 = (1 - n^2) / n^2. The fraction of facets below the critical angle is

    S = (1 + v / sqrt(1 + v^2)) / 2,  v = k (tau_m / tau_c - tau_c / tau_m),

and the fraction of transmitted light is S^p (1 - F). F is the reflectance at a value of tau that a
fraction Q of the facets exceeds. Q is proportional to S, and tau solves Q = S with tau_c = tau:

    k (tau_m / tau - tau / tau_m) = w = (Q - 1/2) / sqrt(Q (1 - Q)),
    2 k tau / tau_m = sqrt(w^2 + 4 k^2) - w.

Let mu and s be the cosine and the sine of the polar angle of wo. If mu = 1, the fraction of facets
is exactly 1 / (1 + alpha^2 tau_c^2), which equals S with k = 1/2. For small alpha, S with
2 k = mu s / alpha is the cumulative distribution of GGX's slopes along one axis. The fit is

    tau_m^2 = (mu^2 + a alpha^2) / (s^2 + b alpha^2),  k^2 = k_0 + k_1 mu^2 s^2 / alpha^2.

Each of a, b, k_0, p and Q / S is a sum of fitted terms, or the exponential of a sum. A greedy
search chose the terms among products of mu, x = mu / (mu + alpha), y = sqrt(alpha), z = s / (s +
alpha) and n.

The fraction of light that follows reversed paths from outside (`mxeon.models.transmission`) has the
same form with other coefficients, divided by 1 + r alpha (1 - n^2) / mu with a fitted r.

The fit minimizes the largest errors of the compensated albedo and of the fraction of light on
reversed paths. The search runs in float64, so coefficients may differ slightly between machines.

    python -m tools.fits.ggx_inside
"""

import re

import numpy as np
from scipy.optimize import least_squares

from mxeon.models import dielectric_albedo_dir, fresnel_dielectric, fresnel_dielectric_avg
from mxeon.models.transmission import reversed_transmittance
from mxeon.shaders.functions import source_file

SEED, COUNT = 5, 2500
LEAST = 1e-4  # smallest cosine and roughness
INDICES = (0.33, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.93, 0.95, 0.98)
POWERS = (4, 8, 16)  # half the exponents of p-norms; large exponents approximate the largest error
SCALE = 30.0  # scales errors to about 1


def points(seed=SEED, count=COUNT):
    """Random mu and alpha. Many mu are near 1, near alpha, or near a critical angle's cosine."""
    rng = np.random.default_rng(seed)
    pick, ratio = rng.random((3, count)), rng.random(count)
    alpha = np.where(pick[0] < 0.5, LEAST ** rng.random(count), rng.random(count))
    mu = np.where(pick[1] < 0.5, rng.random(count), alpha * 10.0 ** (3.0 * ratio - 1.5))
    mu = np.where(pick[2] < 0.2, 1.0 - 0.1 * ratio * alpha ** rng.random(count), mu)
    n = rng.uniform(INDICES[0], INDICES[-1], count)
    mu = np.where(pick[2] > 0.7, np.sqrt(1.0 - n * n) + n * alpha * (4.0 * ratio - 2.0), mu)
    return np.clip(mu, LEAST, 1.0), np.clip(alpha, LEAST, 1.0)


def view(mu):
    return np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)


def albedo(mu, alpha, ior):
    """Directional albedo without compensation. For an IOR of 0, the albedo is E_ss."""
    roughness = np.stack([alpha, alpha], axis=-1)
    return np.ravel(dielectric_albedo_dir(view(mu), 1.0, roughness, ior, compensate=False))


def passing(mu, alpha, ior, c):
    """Fitted mean of 1 - F over visible facets, and fitted fraction of light on reversed paths."""
    s2, bent = 1.0 - mu * mu, 1.0 - ior * ior
    x, y, z = mu / (mu + alpha), np.sqrt(alpha), np.sqrt(s2) / (np.sqrt(s2) + alpha)
    ratio = mu * mu * s2 / alpha**2
    facets = (
        c[0] + c[1] * mu * y,
        c[5] + c[6] * mu + c[7] * ior + c[8] * x * y,
        c[11] + c[12] * z + c[13] * mu * y + c[15] * ratio,
        c[17] + c[18] * z * y,
        c[20] + c[21] * mu * y,
    )
    reversed_paths = (
        np.exp(c[2] + c[3] * z * y + c[4] * x * y),
        c[9] + c[10] * mu * y,
        c[14] + c[16] * ratio,
        c[19],
        c[22] + c[23] * x,
    )
    rise = np.exp(c[24] + c[25] * ior + c[26] * alpha + c[27] * x) * alpha * bent / mu

    def transmitted(a, b, k2, part, p):
        median2 = (mu * mu + a * alpha**2) / (s2 + b * alpha**2)
        critical2 = bent / (ior * ior * median2)
        v = np.clip(np.sqrt(k2 / critical2) * (1.0 - critical2), -1e6, 1e6)
        h = np.sqrt(1.0 + v * v)
        tail = 0.5 / (h * (h + np.abs(v)))
        below = np.where(v < 0.0, tail, 1.0 - tail)
        above = part * below
        w = (above - 0.5) / np.sqrt(above * (1.0 - above))
        t = np.sqrt(w * w + 4.0 * k2) - w
        cosine = 1.0 / np.sqrt(1.0 + 4.0 * k2 / (median2 * t * t))
        return below**p * (1.0 - fresnel_dielectric(cosine, ior))

    return transmitted(*facets), transmitted(*reversed_paths) / (1.0 + rise)


def passed(mu, alpha, ior):
    """Exact fractions of light on reversed paths."""

    def outside(a, n):
        return lambda mu: dielectric_albedo_dir(view(mu), 1.0, [a, a], 1.0 / n)

    rows = zip(mu, alpha, ior, strict=True)
    return np.array(
        [reversed_transmittance(np.array([m]), a, n, outside(a, n)).item() for m, a, n in rows]
    )


def sample(mu, alpha):
    """E_ss, and the albedos for all INDICES."""
    return albedo(mu, alpha, 0.0), np.stack([albedo(mu, alpha, n) for n in INDICES])


def errors(coefficients, mu, alpha, ess, albedos):
    """Errors of the compensated albedo for each IOR and each mu, (I, N)."""
    fitted = np.stack([1.0 - passing(mu, alpha, n, coefficients)[0] for n in INDICES])
    average = np.array([float(fresnel_dielectric_avg(n)) for n in INDICES])[:, np.newaxis]
    return (ess * fitted - albedos) * (1.0 + average * (1.0 - ess) / ess)


def fit(mu, alpha, ior, sampled, exact):
    """Fit coefficients to `sampled` albedos and `exact` fractions of light on reversed paths."""

    def powers(coefficients, power):
        share = passing(mu, alpha, ior, coefficients)[1] - exact
        error = SCALE * np.append(errors(coefficients, mu, alpha, *sampled), share)
        return np.sign(error) * np.abs(error) ** power

    found = shipped()
    for power in POWERS:
        found = least_squares(powers, found, args=(power,), max_nfev=30, x_scale=0.1).x
    return found


def shipped():
    text = source_file("glsl", "fresnel_dielectric").read_text(encoding="utf-8")
    lines = re.search(r"vec2 a = .*?risen =[^;]*", text, re.DOTALL)
    assert lines
    return np.array([float(x.replace(" ", "")) for x in re.findall(r"(?:- )?-?\d+\.\d+", lines[0])])


if __name__ == "__main__":
    # Print coefficients of a new search, then errors of the shader's coefficients at other points.
    mu, alpha = points()
    ior = np.random.default_rng(SEED).uniform(INDICES[0], INDICES[-1], len(mu))
    print(fit(mu, alpha, ior, sample(mu, alpha), passed(mu, alpha, ior)).round(5).tolist())
    mu, alpha = points(SEED + 2)
    found = np.abs(errors(shipped(), mu, alpha, *sample(mu, alpha))).max(axis=1)
    for n, largest in zip(INDICES, found, strict=True):
        print(f"largest absolute error of the albedo at {n}: {largest:.3g}")
    share = passing(mu, alpha, ior, shipped())[1] - passed(mu, alpha, ior)
    print(f"largest absolute error of the share by reversed paths: {np.abs(share).max():.3g}")
