# SPDX-License-Identifier: Apache-2.0
"""Fit of a dielectric's reflectance over the visible facets of GGX for indices n below 1.

Facets beyond the critical angle reflect everything, so no single cosine stands for all of them. With
tau the cotangent of the angle between view and facet and tau_c^2 = (1 - n^2) / n^2 the critical one, the
share of facets below the critical angle is

    S = t^-p,  t = 1 + exp(g asinh(k ln(tau_c^2 / tau_m^2))),

and their mean reflectance is F at the tau that a share REST of them exceeds:

    F = 1 - S (1 - F(tau)),  ln(tau^2 / tau_m^2) = sinh(ln(t REST^(-1/p) - 1) / g) / k.

Along the normal, GGX's share is 1 / (1 + alpha^2 tau_c^2), which corresponds to p = 1 and g k = 1
with small k. For a smooth surface, g = 2 gives the marginal distribution of a slope. With mu the
cosine of the view and s its sine,

    tau_m^2 = (mu^2 + a alpha^2) / (s^2 + b alpha^2),  k^2 = k_0 + k_1 mu^2 s^2 / alpha^2,

and the logarithms of a, b, k_0, k_1, p and g are linear in 1, x = mu / (mu + alpha), s / (s +
alpha), y = sqrt(alpha) and x y. The fit minimizes the largest error of the albedo with its
compensation. The search is in float64 and need not be repeatable; the errors are those of the
coefficients in the shader.

The share of transmitted light according to the reversed paths from outside
(`mxeon.models.transmission`) has the form S (1 - F(tau)) with other coefficients. It differs
because of facets that send light up again: less light passes at grazing.

    python -m tools.fits.ggx_inside
"""

import re

import numpy as np
from scipy.optimize import least_squares

from mxeon.models import dielectric_albedo_dir, fresnel_dielectric, fresnel_dielectric_avg
from mxeon.models.transmission import reversed_transmittance
from mxeon.shaders.functions import source_file

SEED, COUNT = 5, 3000  # views
LEAST = 1e-4  # smallest cosine and roughness
INDICES = (0.33, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.93, 0.95, 0.98)
START = (1.6, 0.0, -3.1, -3.8, 0.0, 0.9)  # constants of the logarithms
REST = 0.7213
POWERS = (1, 2, 3, 5, 8, 12, 16)  # half the exponents of the norms, which approach the maximum norm
SCALE = 45.0  # makes errors about 1
DIGITS = 5


def points(seed=SEED, count=COUNT):
    """Cosines and roughnesses: uniform, uniform in the logarithm, ratios near 1, near the normal and critical angles."""
    rng = np.random.default_rng(seed)
    pick, ratio = rng.random((3, count)), rng.random(count)
    alpha = np.where(pick[0] < 0.5, LEAST ** rng.random(count), rng.random(count))
    mu = np.where(pick[1] < 0.5, rng.random(count), alpha * 10.0 ** (3.0 * ratio - 1.5))
    mu = np.where(pick[2] < 0.2, 1.0 - 0.1 * ratio * alpha ** rng.random(count), mu)
    n = rng.uniform(INDICES[0], INDICES[-1], count)
    mu = np.where(pick[2] > 0.7, np.sqrt(1.0 - n * n) + n * alpha * (4.0 * ratio - 2.0), mu)
    return np.clip(mu, LEAST, 1.0), np.clip(alpha, LEAST, 1.0)


def albedo(mu, alpha, ior):
    """Directional albedo without compensation; at index 0 it is E_ss."""
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    roughness = np.stack([alpha, alpha], axis=-1)
    return np.ravel(dielectric_albedo_dir(wo, 1.0, roughness, ior, compensate=False))


def passing(mu, alpha, ior, coefficients):
    """S (1 - F), from 30 coefficients: five for each logarithm."""
    s = np.sqrt(1.0 - mu * mu)
    x, y = mu / (mu + alpha), np.sqrt(alpha)
    terms = np.stack([np.ones_like(x), x, s / (s + alpha), y, x * y])
    a, b, k0, k1, p, g = np.exp(np.clip(np.reshape(coefficients, (6, 5)) @ terms, -16.0, 12.0))
    median2 = (mu * mu + a * alpha * alpha) / (s * s + b * alpha * alpha)
    k = np.sqrt(k0 + k1 * (mu * s / alpha) ** 2)
    critical2 = (1.0 - ior * ior) / (ior * ior)
    t = 1.0 + np.exp(np.minimum(g * np.arcsinh(k * np.log(critical2 / median2)), 60.0))
    v = np.sinh(np.clip(np.log(t * REST ** (-1.0 / p) - 1.0) / g, -40.0, 40.0)) / k
    c = 1.0 / np.sqrt(1.0 + np.exp(-np.clip(v, -40.0, 40.0)) / median2)
    return t**-p * (1.0 - fresnel_dielectric(c, ior))


def reflectance(mu, alpha, ior, coefficients):
    """Mean reflectance of the visible facets."""
    return 1.0 - passing(mu, alpha, ior, coefficients)


def passed(mu, alpha, ior):
    """Exact shares of reversed paths, one view each."""

    def albedos(a, n):
        return lambda mu: dielectric_albedo_dir(
            np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1), 1.0, [a, a], 1.0 / n
        )

    rows = zip(mu, alpha, ior, strict=True)
    return np.array(
        [reversed_transmittance(np.array([m]), a, n, albedos(a, n)).item() for m, a, n in rows]
    )


def fit_passed(mu, alpha, ior, exact):
    """Coefficients of the share that passes, starting from the reflectance's."""
    found = shipped()

    def powers(coefficients, power):
        error = SCALE * (passing(mu, alpha, ior, coefficients) - exact)
        return np.sign(error) * np.abs(error) ** power

    for power in POWERS[:-2]:
        found = least_squares(powers, found, args=(power,), max_nfev=80, x_scale=0.1).x
    return found


def sample(mu, alpha):
    """E_ss, and albedos of all indices."""
    return albedo(mu, alpha, 0.0), np.stack([albedo(mu, alpha, n) for n in INDICES])


def errors(coefficients, mu, alpha, ess, albedos):
    """Errors of the albedo with its compensation, (I, N)."""
    fitted = np.stack([reflectance(mu, alpha, n, coefficients) for n in INDICES])
    average = np.array([float(fresnel_dielectric_avg(n)) for n in INDICES])[:, np.newaxis]
    return (ess * fitted - albedos) * (1.0 + average * (1.0 - ess) / ess)


def fit(sampled):
    found = np.zeros((6, 5))
    found[:, 0] = START

    def powers(coefficients, power):
        error = SCALE * errors(coefficients, *sampled).ravel()
        return np.sign(error) * np.abs(error) ** power

    for power in POWERS:
        found = least_squares(powers, np.ravel(found), args=(power,), max_nfev=80, x_scale=0.1).x
    return found


def shipped(reversed_paths=False):
    """Coefficients in the shader."""
    text = source_file("glsl", "fresnel_dielectric").read_text(encoding="utf-8")
    pairs = re.findall(r"mix\(vec3\(([-\d., ]+)\), vec3\(([-\d., ]+)\), reversed\)", text)
    rows = np.array([each[reversed_paths].split(",") for each in pairs], float)
    return rows.reshape(2, 5, 3).transpose(0, 2, 1).ravel()


def main():
    """Print the vectors found by a search, and the error of the shader's vectors on other views."""
    mu, alpha = points()
    ior = np.random.default_rng(SEED).uniform(INDICES[0], INDICES[-1], len(mu))
    reversed_paths = fit_passed(mu, alpha, ior, passed(mu, alpha, ior))
    for found in (fit((mu, alpha, *sample(mu, alpha))), reversed_paths):
        for row in np.reshape(found, (2, 3, 5)).transpose(0, 2, 1).reshape(10, 3):
            print(f"vec3({', '.join(f'{x:.{DIGITS}g}' for x in row)})")
    mu, alpha = points(SEED + 2)
    for n, row in zip(
        INDICES, np.abs(errors(shipped(), mu, alpha, *sample(mu, alpha))), strict=True
    ):
        print(f"largest absolute error of the albedo at {n}: {row.max():.3g}")


if __name__ == "__main__":
    main()
