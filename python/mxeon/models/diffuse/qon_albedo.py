# SPDX-License-Identifier: Apache-2.0
"""Albedos of QON at unit reflectance, in closed form: multiply by rho.

- `mu` (...): Cosine of the polar angle, in [0, 1].
- `sigma` (...): Deviation of the facets' slope angle, in radian, in [0, pi/2].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import root
from mxeon.models.core.namespaces import any_array
from mxeon.models.diffuse import formulas
from mxeon.models.diffuse.formulas import C1, qon_a, qon_b


@any_array
def qon_albedo_dir(mu: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of QON at unit reflectance.

        E(mu) = A + B G(mu) / pi,  G = pi (c1 - H(mu)) + 2/3 sqrt(1 - mu^2)

    Result (...): positive; above 1, to 1.02, near grazing for sigma < 0.6. Accuracy: relative error
    below 1e-15. [Portsmouth2025], Eqs. (5), (8).

        >>> qon_albedo_dir([0.0, 1.0], 0.5).round(6)
        array([0.949924, 0.784483])
    """
    mu, sigma = checked_numbers(mu=mu, sigma=sigma)
    g_over_pi = C1 - formulas.fon_loss(mu) + 2.0 / (3.0 * np.pi) * root((1.0 - mu) * (1.0 + mu))
    return qon_a(sigma) + qon_b(sigma) * g_over_pi


@any_array
def qon_albedo_avg(sigma: ArrayLike) -> Array:
    """Average albedo of QON at unit reflectance.

        <E> = A + (2/3 - 64 / (45 pi)) B

    Result (...): in (0, 1]. [Portsmouth2025], Eq. (9).

        >>> qon_albedo_avg(0.5).round(6)
        np.float64(0.855278)
    """
    (sigma,) = checked_numbers(sigma=sigma)
    return qon_a(sigma) + (2.0 / 3.0 - 64.0 / (45.0 * np.pi)) * qon_b(sigma)
