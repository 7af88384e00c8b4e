# SPDX-License-Identifier: Apache-2.0
"""Roughness of microfacets, alpha along tangent and bitangent, from what an artist sets.

- `roughness`, `anisotropy`, `glossiness` (...): In [0, 1].

Result (..., 2): in [0, 1]. Raises `ValueError`, which names the first bad element, if an argument
leaves its range or the shapes do not broadcast.
"""

from __future__ import annotations

from mxeon.models.core.arguments import checked_numbers, checked_pairs
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_most
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import broadcastable

LARGEST_ANISOTROPY = 0.98  # beyond it alpha along the tangent would soon divide by 0


@any_array
def roughness_anisotropy(roughness: ArrayLike, anisotropy: ArrayLike) -> Array:
    """Pair of alphas of a roughness that is stretched along the tangent.

        alpha_x = min(roughness^2 / aspect, 1),  alpha_y = roughness^2 aspect,
        aspect = sqrt(1 - min(anisotropy, 0.98))

    Result (..., 2): alpha along the tangent and along the bitangent, in [0, 1]. The specification
    has the square, the direction, and that anisotropy 0 is isotropic; it has no equation. The
    aspect is that of its implementations: Burley's with the factor 1 instead of 0.9.
    [MaterialX2026], roughness_anisotropy; [Burley2012], Section 5.4.

        >>> roughness_anisotropy(0.5, [0.0, 0.75])
        array([[0.25 , 0.25 ],
               [0.5  , 0.125]])
    """
    return _stretched(*checked_numbers(roughness=roughness, anisotropy=anisotropy))


def _stretched(r: Array, a: Array) -> Array:
    """`roughness_anisotropy` on valid arrays."""
    xp = array_namespace(r, a)
    aspect = xp.sqrt(1.0 - at_most(a, LARGEST_ANISOTROPY))
    return xp.stack([at_most(r * r / aspect, 1.0), r * r * aspect], axis=-1)


@any_array
def roughness_dual(roughness: ArrayLike) -> Array:
    """Pair of alphas of two roughnesses, their squares.

    - `roughness` (..., 2): Roughness along the tangent and along the bitangent, in [0, 1].

    [MaterialX2026], roughness_dual.

        >>> roughness_dual([0.5, 1.0])
        array([0.25, 1.  ])
    """
    (pairs,) = broadcastable({"roughness": checked_pairs("roughness", roughness)}, {})
    return pairs * pairs


@any_array
def glossiness_anisotropy(glossiness: ArrayLike, anisotropy: ArrayLike) -> Array:
    """Pair of alphas of the roughness 1 - glossiness; see `roughness_anisotropy`.

    [MaterialX2026], glossiness_anisotropy.

        >>> glossiness_anisotropy(0.5, 0.75)
        array([0.5  , 0.125])
    """
    g, a = checked_numbers(glossiness=glossiness, anisotropy=anisotropy)
    return _stretched(1.0 - g, a)
