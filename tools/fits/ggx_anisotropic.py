# SPDX-License-Identifier: Apache-2.0
"""Isotropic facets that replace anisotropic facets in shaders' fits of E_ss and Fresnel averages.

Let wo be (x, y, z), and let r^2 be (alpha_x^2 + alpha_y^2) / 2. The squared roughnesses along and
across the azimuth of wo are

    v^2 = (alpha_x x)^2 + (alpha_y y)^2 + (r z)^2,  u^2 = 2 r^2 - v^2.

The correlation c of the slopes along and across the azimuth of wo is defined by
c^2 = 1 - (alpha_x alpha_y)^2 / (u v)^2. The loss 1 - E_ss of anisotropic facets is the loss of
isotropic facets with alpha = r at the cosine z r / v, multiplied by

    1 + C_0 c^2 + C_1 d + C_2 t + C_3 c^2 t,  d = 1 - (alpha_x alpha_y)^2 / r^4,  t = v^2 / r^2 - 1,

where the coefficients minimize the largest relative error of E_ss. A Fresnel curve is averaged over
isotropic facets with alpha = v k(0.7 + c^2) at the cosine z k(0.35 c^2), where
k(p) = min((1 + p v) / (1 + p u), 1).

    python -m tools.fits.ggx_anisotropic
"""

import numpy as np
from scipy.optimize import linprog

from mxeon.models.microfacet.fresnel import dielectric
from mxeon.models.microfacet.slopes import slope_nodes
from tools.fits.ggx_albedo import fitted
from tools.fits.minimax import shipped

MISSED = (-0.1268, 0.074, -0.0792, 0.0696)  # the shader's C_0 to C_3
# Grid of the fit: the larger alpha, the ratio of both alphas, and the cosine and azimuth of wo.
LARGEST = (1.0, 0.6, 0.3, 0.1, 0.05)
RATIOS = (1.3, 2.0, 3.0, 4.0, 8.0, 16.0, 30.0, 50.0)
COSINES = (0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.35, 0.5, 0.7, 0.9, 0.99)
AZIMUTHS = np.radians((0.0, 5.0, 12.0, 25.0, 45.0, 65.0, 80.0, 90.0))


def points(ratios=RATIOS):
    """Grid of directions, (3, N), and of alphas of at least 1e-3, (2, N)."""
    a, ratio, mu, phi = (
        each.ravel() for each in np.meshgrid(LARGEST, ratios, COSINES, AZIMUTHS, indexing="ij")
    )
    s = np.sqrt(1.0 - mu * mu)
    wo, alpha = np.stack([s * np.cos(phi), s * np.sin(phi), mu]), np.stack([a, a / ratio])
    keep = alpha[1] >= 1e-3
    return wo[:, keep], alpha[:, keep]


def exact(wo, alpha, ior=None, block=64):
    """The albedo of a dielectric without compensation. Without `ior`, the albedo is E_ss."""
    parts = []
    for start in range(0, wo.shape[1], block):
        c, weight = slope_nodes(wo[:, start : start + block], alpha[:, start : start + block])
        F = 1.0 if ior is None else dielectric(c, np.full(c.shape[-1], ior))
        parts.append(np.sum(F * weight, axis=(0, 1)))
    return np.concatenate(parts)


def terms(wo, alpha):
    """Cosine and alpha of the isotropic facets for E_ss, and the terms c^2, d, t and c^2 t."""
    (x2, y2, z2), (a2, b2) = wo**2, alpha**2
    r2 = 0.5 * (a2 + b2)
    v2 = a2 * x2 + b2 * y2 + r2 * z2
    c2 = np.maximum(1.0 - a2 * b2 / (v2 * (2.0 * r2 - v2)), 0.0)
    t, d = v2 / r2 - 1.0, 1.0 - a2 * b2 / r2**2
    return (wo[2] / np.sqrt(1.0 + t), np.sqrt(r2)), np.stack([c2, d, t, c2 * t])


def missed(wo, alpha):
    """1 - E_ss of the isotropic facets by the shaders' fit."""
    return 1.0 - fitted(*terms(wo, alpha)[0], shipped("ggx_albedo", "ggx_missing"))


def corrected(wo, alpha, coefficients=MISSED):
    """E_ss of the anisotropic facets by the shaders' fit."""
    factor = 1.0 + np.tensordot(coefficients, terms(wo, alpha)[1], axes=1)
    return 1.0 - missed(wo, alpha) * factor


def visible(wo, alpha):
    """Cosine and alpha of the isotropic facets for Fresnel averages."""
    r2 = 0.5 * np.sum(alpha**2, axis=0)
    v2 = np.sum((alpha * wo[:2]) ** 2, axis=0) + r2 * wo[2] ** 2
    v, u = np.sqrt(v2), np.sqrt(2.0 * r2 - v2)
    c2 = terms(wo, alpha)[1][0]
    k = [np.minimum((1.0 + p * v) / (1.0 + p * u), 1.0) for p in (0.35 * c2, 0.7 + c2)]
    return wo[2] * k[0], v * k[1]


def fit(wo, alpha):
    """C_0 to C_3, and the largest relative error of E_ss."""
    E, loss, factors = exact(wo, alpha), missed(wo, alpha), terms(wo, alpha)[1]
    slope, offset = -(loss / E * factors).T, (1.0 - loss) / E - 1.0
    one = np.ones((len(offset), 1))
    found = linprog(
        [0.0] * 4 + [1.0],
        A_ub=np.block([[slope, -one], [-slope, -one]]),
        b_ub=np.concatenate([-offset, offset]),
        bounds=[(None, None)] * 4 + [(0.0, None)],
    )
    return found.x[:4], found.x[4]


def largest_error(ratios=RATIOS, coefficients=MISSED):
    """Largest relative error of E_ss for the given ratios of the alphas."""
    wo, alpha = points(ratios)
    return float(np.max(np.abs(corrected(wo, alpha, coefficients) / exact(wo, alpha) - 1.0)))


def largest_visible_error(ratios=RATIOS, ior=1.5):
    """Largest absolute error that the Fresnel average causes in a dielectric's albedo."""
    wo, alpha = points(ratios)
    mu, isotropic = visible(wo, alpha)
    facets = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu]), np.stack([isotropic, isotropic])
    average = exact(*facets, ior) / exact(*facets)
    return float(np.max(np.abs(average * exact(wo, alpha) - exact(wo, alpha, ior))))


if __name__ == "__main__":
    found, error = fit(*points())
    print("1 - E_ss:", *found.round(4), f"error {error:.3g}")
    for last in (4, 8):
        print(
            f"up to a ratio of {RATIOS[last - 1]:g}: E_ss {largest_error(RATIOS[:last]):.3g}, "
            f"albedo of a dielectric {largest_visible_error(RATIOS[:last]):.3g}"
        )
