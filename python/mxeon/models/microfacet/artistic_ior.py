# SPDX-License-Identifier: Apache-2.0
"""Complex index of refraction of a metal from two colors, and back."""

from __future__ import annotations

from mxeon.models.core.arguments import checked_numbers
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_least_0, root
from mxeon.models.core.namespaces import any_array, array_namespace


@any_array
def artistic_ior(reflectivity: ArrayLike, edge_color: ArrayLike) -> tuple[Array, Array]:
    """Complex index of refraction n + i k with a reflectance at normal incidence.

        n = edge_color n_min + (1 - edge_color) n_max,
        n_min = (1 - r) / (1 + r),  n_max = (1 + sqrt(r)) / (1 - sqrt(r)),
        k^2 = (n_max - n) (n - 1 / n_max)

    - `reflectivity` (...): Reflectance at normal incidence r, per channel, in [0, 1).
    - `edge_color` (...): Per channel, in [0, 1]: 0 has the largest n, and no extinction; 1 the
      least n.

    `ior`, `extinction` (...): n in (0, inf) and k in [0, inf). Form: the paper's k^2 is (r
    (n + 1)^2 - (n - 1)^2) / (1 - r), a difference of large numbers. Its roots in n are n_max and
    1 / n_max, and k^2 is their product here. The reflectance of n and k is r to within a few
    roundings: `artistic_parameters` takes both back. [Gulbrandsen2014]; [MaterialX2026],
    artistic_ior.

        >>> ior, extinction = artistic_ior(0.944, 0.998)
        >>> round(float(ior), 4), round(float(extinction), 4)
        (0.1676, 3.2568)
    """
    r, g = checked_numbers(reflectivity=reflectivity, edge_color=edge_color)
    n_min, n_max = _extremes(r)
    ior = g * n_min + (1.0 - g) * n_max
    square = g * (n_max - n_min) * ((ior - n_min) + (n_min - 1.0 / n_max))
    return ior, root(at_least_0(square))


@any_array
def artistic_parameters(ior: ArrayLike, extinction: ArrayLike) -> tuple[Array, Array]:
    """Reflectivity and edge color of a complex index of refraction.

        r = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2),  g = (n_max - n) / (n_max - n_min)

    - `ior`, `extinction` (...): n and k per channel, in [0, 1e50].

    `reflectivity`, `edge_color` (...): r in [0, 1]. The edge color lies in [0, 1] for metals that
    the parameterization reaches, those with n >= (1 - r) / (1 + r); it is above 1 for others, and 0
    at r = 0, where n is 1 for every edge color. [Gulbrandsen2014].

        >>> r, g = artistic_parameters(*artistic_ior(0.9, 0.25))
        >>> round(float(r), 9), round(float(g), 9)
        (0.9, 0.25)
    """
    n, k = checked_numbers(ior=ior, extinction=extinction)
    r = normal_reflectance(n, k)
    # With 1 - r = 4 n / S, S = (n + 1)^2 + k^2, both extremes times n have no pole at r = 1.
    xp, S = array_namespace(n, k), (n + 1.0) ** 2 + k**2
    largest = (1.0 + root(r)) ** 2 * S / 4.0
    width = largest - 4.0 * n**2 / (S * (1.0 + r))
    edge = (largest - n**2) / xp.where(width > 0.0, width, 1.0)
    return r, xp.where(width > 0.0, edge, 0.0)


def normal_reflectance(ior: Array, extinction: Array) -> Array:
    """Fresnel reflectance at normal incidence, without a check of the arguments.

    Result (...).
    """
    square = extinction**2
    return ((ior - 1.0) ** 2 + square) / ((ior + 1.0) ** 2 + square)


def _extremes(r: Array) -> tuple[Array, Array]:
    """The least and the largest n of a reflectance; 1 - sqrt(r) is (1 - r) / (1 + sqrt(r))."""
    return (1.0 - r) / (1.0 + r), (1.0 + root(r)) ** 2 / (1.0 - r)
