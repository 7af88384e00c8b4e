# SPDX-License-Identifier: Apache-2.0
"""Importance sampling of the Zeltner sheen, whose lobe is a linearly transformed cosine.

A direction `wh` drawn under a clamped cosine, in the frame where wo has azimuth 0, is mapped by
M = [[1/a, 0, -b/a], [0, 1/a, 0], [0, 0, 1]]: wi = M wh / |M wh|. M keeps z, so no sample is wasted,
and the value times the cosine over the density is color E(mu_o) for every sample.

- `wo`, `wi` (..., 3): Unit vectors on or above the horizon.
- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `roughness` (...): In [0, 1]; below 0.01 it counts as 0.01.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_most, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.sampling.hemisphere import (
    azimuth_frame,
    checked_draw,
    checked_pdf,
    cosine_sample,
    rotate_z,
    stack_xyz,
)
from mxeon.models.sheen import zeltner_matrix


@any_array
def zeltner_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled proportionally to the Zeltner lobe times the cosine, and its density.

    `wi` (..., 3): Unit vectors above the horizon. `pdf` (...): 1/sr. [MaterialX2026], Zeltner Sheen
    Model, LTC Inverse Matrix.

        >>> wi, pdf = zeltner_sample([0.6, 0.0, 0.8], [0.25, 0.5], 1.0)
        >>> wi.round(6), round(float(pdf), 6)
        (array([-0.550347,  0.      ,  0.834936]), 0.236007)
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    wh = cosine_sample(u)[0]
    a, b = zeltner_matrix(at_most(wo[..., 2], 1.0), roughness)
    x, y, z = (wh[..., 0] - b * wh[..., 2]) / a, wh[..., 1] / a, wh[..., 2]
    wi = stack_xyz(x, y, z)
    length = root(array_namespace(wi).sum(wi * wi, axis=-1))
    cosine, sine, _ = azimuth_frame(wo)
    pdf = z / np.pi * length**3 * (a * a)
    return rotate_z(wi / length[..., np.newaxis], cosine, sine), pdf


@any_array
def zeltner_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `zeltner_sample` at `wi`, in solid angle.

    Result (...): 1/sr. [MaterialX2026], Zeltner Sheen Model, Cosine-Weighted BRDF.

        >>> round(float(zeltner_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 1.0)), 6)
        0.24421
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    a, b = zeltner_matrix(at_most(wo[..., 2], 1.0), roughness)
    cosine, sine, _ = azimuth_frame(wo)
    wi = rotate_z(wi, cosine, -sine)
    x, y, z = wi[..., 0], wi[..., 1], wi[..., 2]
    square = array_namespace(a, x).square
    squared = square(a * x + b * z) + square(a * y) + square(z)
    pdf: Array = z / np.pi * square(a / squared)
    return pdf
