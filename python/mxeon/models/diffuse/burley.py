# SPDX-License-Identifier: Apache-2.0
"""Burley's diffuse model, as in [MaterialX2026], section `burley_diffuse_bsdf`.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `mu` (...): Cosine of the polar angle of wo, in [0, 1].
- `rho` (..., C): Reflectance per channel, in [0, 1]; a number is one channel.
- `roughness` (...): In [0, 1]: sigma of the text.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_colors
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.evaluation import evaluate
from mxeon.models.core.namespaces import any_array
from mxeon.models.diffuse.formulas import cosines


@any_array
def burley_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """BRDF of Burley's diffuse model.

        f = rho / pi (1 + k (1 - mu_o)^5) (1 + k (1 - mu_i)^5),
        k = F_D90 - 1 = 2 roughness (wi . wh)^2 - 1 / 2

    Result (..., C): BRDF in 1/sr, in [0, 25/4 / pi]. With (wi . wh)^2 = (1 + wo . wi) / 2 there is
    no half vector to normalize, and opposite directions at grazing need no case of their own.
    Accuracy: error below 66 / roughness times 2^-53 of f + 1 / pi. [MaterialX2026], section
    `burley_diffuse_bsdf`; [Burley2012], section 5.3.

        >>> burley_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], [0.2, 0.8], 0.5).round(6)
        array([0.063985, 0.255939])
    """
    return evaluate(_formula, wo, wi, rho, roughness=roughness)


@any_array
def burley_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of Burley's diffuse model, in closed form.

        E(mu) = rho (1 + n (h + 2 r mu / 3) + h / 21 + r mu / 84 + n Q),
        n = (1 - mu)^5,  h = r - 1/2,
        Q = (h^2 + r^2 (1 - mu^2) / 2) / 21 + h r mu / 42 + r^2 (3 mu^2 - 1) / 504

    Result (..., C): It exceeds rho where the surface is rough: up to 1.558 rho at grazing. Form: f
    is a polynomial in mu_i and cos(phi). The integrals are 2 n! 5! / (n + 6)! for mu_i^n
    (1 - mu_i)^5: 1/21, 1/84, 1/252. Accuracy: absolute error below 1e-12. [MaterialX2026], sections
    `burley_diffuse_bsdf` and Directional Albedo.

        >>> burley_albedo_dir(0.0, 1.0, 1.0).round(6)
        array([1.55754])
    """
    (rho,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    h, n = r - 0.5, (1.0 - m) ** 5
    both = (h**2 + 0.5 * r**2 * (1.0 - m) * (1.0 + m)) / 21.0
    both = both + h * r * m / 42.0 + r**2 * (3.0 * m**2 - 1.0) / 504.0
    unit = 1.0 + n * (h + 2.0 / 3.0 * r * m) + h / 21.0 + r * m / 84.0 + n * both
    return rho * unit


def _formula(wo: Array, wi: Array, rho: Array, roughness: Array) -> Array:
    """f on valid arrays, channels first."""
    mu_o, mu_i, s = cosines(wo, wi)
    k = roughness * (1.0 + mu_o * mu_i + s) - 0.5
    return rho / np.pi * (1.0 + k * (1.0 - mu_o) ** 5) * (1.0 + k * (1.0 - mu_i) ** 5)
