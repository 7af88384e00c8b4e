# SPDX-License-Identifier: Apache-2.0
"""Linearly transformed cosines fitted to EON, without and with the coefficient d.

The surface is rotated about the normal until `wo` has azimuth 0. A direction `wh` drawn
under a clamped cosine is mapped by M = [[a, 0, b], [0, c, 0], [d, 0, 1]]:

    wi = M wh / |M wh|,      p(wi) = p(wh) |M wh|^3 / det M.

- `wo`, `wi` (..., 3): Unit vectors on or above the horizon.
- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `roughness` (...): In [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_least_0, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.sampling.hemisphere import (
    azimuth_frame,
    checked_draw,
    checked_pdf,
    cosine_sample,
    rotate_z,
    stack_xyz,
)


@any_array
def ltc0_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled by the transformed cosine without the coefficient d, and its density.

    `wi` (..., 3): Unit vectors above the horizon. `pdf` (...): 1/sr. The paper fits a, b and c
    again for d = 0 and prints no result. Here they are those of the general fit. [Portsmouth2025],
    Section 4, Eqs. (22) to (25), Listing 2.

        >>> wi, pdf = ltc0_sample([0.6, 0.0, 0.8], [0.25, 0.5], 1.0)
        >>> wi.round(6), round(float(pdf), 6)
        (array([-0.310077,  0.      ,  0.950711]), 0.227343)
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    return ltc_transformed(wo, cosine_sample(u)[0], roughness, 0.0)


@any_array
def ltc0_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `ltc0_sample` at `wi`, in solid angle.

    Result (...): 1/sr. [Portsmouth2025], Eqs. (23) and (24).

        >>> round(float(ltc0_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
        0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    return ltc_density(wo, wi, roughness, 0.0)


@any_array
def ltc_sample(wo: ArrayLike, u: ArrayLike, roughness: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled by the transformed cosine, may be below the horizon; and its density.

    `wi` (..., 3): Unit vectors; those with z < 0 are wasted, their weight is 0. `pdf` (...): 1/sr.
    A sample is wasted with probability (1 - 1/sqrt(1 + d^2))/2: at roughness 1 that is 0.0534 at
    grazing, and less everywhere else. [Portsmouth2025], Section 4, Eqs. (22) to (25), Listing 2.

        >>> wi, pdf = ltc_sample([1.0, 0.0, 0.0], [0.95, 0.0], 1.0)
        >>> float(wi[2]) < 0.0
        True
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    return ltc_transformed(wo, cosine_sample(u)[0], roughness, ltc_d(wo[..., 2], roughness))


@any_array
def ltc_pdf(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Density of `ltc_sample` at `wi`, above the horizon, in solid angle.

    Result (...): 1/sr; its integral over the hemisphere is the probability that no sample is
    wasted. [Portsmouth2025], Eqs. (23) and (24).

        >>> round(float(ltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
        0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    return ltc_density(wo, wi, roughness, ltc_d(wo[..., 2], roughness))


# Entries of the matrix: [Portsmouth2025], Listing 2; mu, the cosine of wo, and roughness in [0, 1];
# the paper states no error.
def ltc_a(mu: Array, roughness: Array) -> Array:
    """Entry a of M."""
    a = 0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * roughness
    return 1.0 + roughness * a


def ltc_b(mu: Array, roughness: Array) -> Array:
    """Entry b of M."""
    b = -1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * roughness
    return roughness * b / (mu**3 - 1.43545)


def ltc_c(mu: Array, roughness: Array) -> Array:
    """Entry c of M."""
    return 1.0 + roughness * (0.20013 + (-0.506373 + 0.261777 * mu) * mu)


def ltc_d(mu: Array, roughness: Array | float) -> Array:
    """Entry d of M."""
    d = 0.540852 + (-1.01625 + 0.475392 * mu) * mu
    return roughness * d / (-1.0743 + (0.0725628 + mu) * mu)


def ltc_transformed(
    wo: Array, wh: Array, roughness: Array, d: Array | float
) -> tuple[Array, Array]:
    """Unit M wh in the local frame of the surface, and its density under the clamped cosine."""
    a, b, c = (entry(wo[..., 2], roughness) for entry in (ltc_a, ltc_b, ltc_c))
    x, y, z = wh[..., 0], wh[..., 1], wh[..., 2]
    wi = stack_xyz(a * x + b * z, c * y, d * x + z)
    length = root(array_namespace(wi).sum(wi * wi, axis=-1))
    cosine, sine, _ = azimuth_frame(wo)
    pdf = z / np.pi * length**3 / (c * (a - b * d))
    return rotate_z(wi / length[..., np.newaxis], cosine, sine), pdf


def ltc_density(wo: Array, wi: Array, roughness: Array, d: Array | float) -> Array:
    """Density at `wi` of M wh / |M wh| for `wh` under the clamped cosine."""
    a, b, c = (entry(wo[..., 2], roughness) for entry in (ltc_a, ltc_b, ltc_c))
    cosine, sine, _ = azimuth_frame(wo)
    wi = rotate_z(wi, cosine, -sine)
    x, y, z = wi[..., 0], wi[..., 1], wi[..., 2]
    det = c * (a - b * d)
    # The adjugate of M times wi: wh up to its length.
    wh_z = c * (a * z - d * x)
    squared = (c * (x - b * z)) ** 2 + ((a - b * d) * y) ** 2 + wh_z**2
    return (det / squared) ** 2 * at_least_0(wh_z) / np.pi
