# SPDX-License-Identifier: Apache-2.0
"""Directions in the frame of a normal and a tangent."""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_sphere, checked_triples
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import any_array, array_namespace, host_values, library

UP, ALONG = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)  # MaterialX's defaults on a surface
PARALLEL = 1e-6  # length that is left of a tangent without the part along the normal


@any_array
def into_frame(w: ArrayLike, normal: ArrayLike, tangent: ArrayLike) -> Array:
    """Components of vectors along the tangent, the bitangent and the normal.

    The tangent is any vector not parallel to the normal; its part along the normal is taken away.
    """
    vectors, axes = _vectors(w), _axes(normal, tangent)
    xp = array_namespace(vectors)
    return xp.stack([xp.sum(vectors * axis, axis=-1) for axis in axes], axis=-1) + 0.0


@any_array
def out_of_frame(w: ArrayLike, normal: ArrayLike, tangent: ArrayLike) -> Array:
    """Vectors with these components along the tangent, the bitangent and the normal."""
    vectors, (x, y, z) = _vectors(w), _axes(normal, tangent)
    turned: Array = vectors[..., :1] * x + vectors[..., 1:2] * y + vectors[..., 2:] * z
    return turned + 0.0


def _vectors(w: ArrayLike) -> Array:
    array = checked_triples("w", w)
    return array if library(array) else np.asarray(array, np.float64)


def _axes(normal: ArrayLike, tangent: ArrayLike) -> tuple[Array, Array, Array]:
    """Tangent, bitangent and normal, of length 1 and perpendicular to each other."""
    z, along = checked_sphere("normal", normal), checked_triples("tangent", tangent)
    xp = array_namespace(z, along)
    x = along - xp.sum(along * z, axis=-1)[..., np.newaxis] * z
    length = xp.sqrt(xp.sum(x * x, axis=-1))[..., np.newaxis]
    shortest = host_values(length) if library(length) else length
    if shortest is not None and not np.all(shortest > PARALLEL):
        raise ValueError("tangent must not be parallel to the normal; name another one")
    # The bitangent is the cross product, which the array standard has in an extension alone.
    x = x / length
    turned = [(1, 2), (2, 0), (0, 1)]
    y = xp.stack([z[..., i] * x[..., j] - z[..., j] * x[..., i] for i, j in turned], axis=-1)
    return x, y, z
