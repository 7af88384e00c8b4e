# SPDX-License-Identifier: Apache-2.0
"""Sampling of the hemisphere independent of the material, and the frame of wo.

Directions leave the surface, local frame with the normal +z. Random numbers `u` lie in [0, 1).

- `u` (..., 2): Independent uniform random numbers, in [0, 1).
- `wi` (..., 3): Unit vectors on or above the horizon.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked, checked_directions, checked_pairs
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.edges import hypot, root
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import broadcastable


@any_array
def uniform_sample(u: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled uniformly on the hemisphere, and its density.

    `wi` (..., 3): Unit vectors, z = u[..., 0]. `pdf` (...): 1/(2 pi), in 1/sr. [Portsmouth2025],
    Listing 4.

        >>> wi, pdf = uniform_sample([0.8, 0.0])
        >>> wi.round(12), round(float(pdf), 6)
        (array([0.6, 0. , 0.8]), 0.159155)
    """
    u1, u2 = unpack_uniforms(u)
    wi = uniform_direction(u1, 1.0 - u1, u2)
    return wi, _uniform_density(wi)


@any_array
def uniform_pdf(wi: ArrayLike) -> Array:
    """Density of `uniform_sample` at `wi`, in solid angle.

    Result (...): 1/(2 pi), in 1/sr.

        >>> round(float(uniform_pdf([0.0, 0.6, 0.8])), 6)
        0.159155
    """
    return _uniform_density(checked_directions("wi", wi))


@any_array
def cosine_sample(u: ArrayLike) -> tuple[Array, Array]:
    """Direction sampled proportionally to its cosine with the normal, and its density.

    `wi` (..., 3): Unit vectors, z > 0. `pdf` (...): z / pi, in 1/sr. [Portsmouth2025], Eq. (21).

        >>> wi, pdf = cosine_sample([0.36, 0.0])
        >>> wi.round(12), round(float(pdf), 6)
        (array([0.6, 0. , 0.8]), 0.254648)
    """
    u1, u2 = unpack_uniforms(u)
    wi = around(root(1.0 - u1), root(u1), u2)
    return wi, wi[..., 2] / np.pi


@any_array
def cosine_pdf(wi: ArrayLike) -> Array:
    """Density of `cosine_sample` at `wi`, in solid angle.

    Result (...): z / pi, in 1/sr.

        >>> round(float(cosine_pdf([0.6, 0.0, 0.8])), 6)
        0.254648
    """
    (w,) = broadcastable({"wi": checked_directions("wi", wi)}, {})
    return w[..., 2] / np.pi


def checked_draw(wo: ArrayLike, u: ArrayLike, **numbers: ArrayLike) -> list[Array]:
    """Checked arguments of a sampler, in this order, as float64 arrays whose shapes broadcast."""
    return _broadcastable({"wo": checked_directions("wo", wo), "u": _checked_pairs(u)}, numbers)


def checked_pdf(wo: ArrayLike, wi: ArrayLike, **numbers: ArrayLike) -> list[Array]:
    """Checked arguments of a density, in this order, as float64 arrays whose shapes broadcast."""
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    return _broadcastable(vectors, numbers)


def unpack_uniforms(u: ArrayLike) -> tuple[Array, Array]:
    """The two random numbers of each pair, checked, as float64 arrays of shape (...)."""
    u = _checked_pairs(u)
    return u[..., 0], u[..., 1]


def uniform_direction(u1: Array, rest: Array, u2: Array) -> Array:
    """Direction of `uniform_sample`; `rest` is 1 - u1."""
    return around(u1, root(rest * (1.0 + u1)), u2)


def around(mu: Array, S: Array, u2: Array) -> Array:
    """Direction with cosine `mu` and sine `S` at the azimuth 2 pi u2."""
    xp, phi = array_namespace(u2), 2.0 * np.pi * u2
    return stack_xyz(S * xp.cos(phi), S * xp.sin(phi), mu)


def stack_xyz(x: Array, y: Array, z: Array) -> Array:
    """Components, broadcast against each other, as vectors along a last axis."""
    xp = array_namespace(x, y, z)
    shape = np.broadcast_shapes(*(tuple(each.shape) for each in (x, y, z)))
    return xp.stack([xp.broadcast_to(each, shape) for each in (x, y, z)], axis=-1)


def azimuth_frame(wo: Array) -> tuple[Array, Array, Array]:
    """Cosine and sine of the azimuth of `wo`, and the sine of its polar angle.

    The azimuth of a `wo` along the normal counts as 0.
    """
    xp, sine = array_namespace(wo), hypot(wo[..., 0], wo[..., 1])
    tilted = sine > 0.0
    length = xp.where(tilted, sine, 1.0)
    return xp.where(tilted, wo[..., 0] / length, 1.0), wo[..., 1] / length, sine


def rotate_z(w: Array, cosine: Array, sine: Array) -> Array:
    """Vectors rotated about the normal by the angle that has this cosine and sine."""
    x, y = w[..., 0], w[..., 1]
    return stack_xyz(cosine * x - sine * y, sine * x + cosine * y, w[..., 2])


def _broadcastable(vectors: dict[str, Numbers], numbers: dict[str, ArrayLike]) -> list[Array]:
    """Vectors and checked numbers as float64 arrays; raise if their shapes do not broadcast."""
    return broadcastable(vectors, {name: checked(name, value) for name, value in numbers.items()})


def _checked_pairs(u: ArrayLike) -> Array:
    """Checked random numbers of shape (..., 2), as a float64 array."""
    return broadcastable({"u": checked_pairs("u", u)}, {})[0]


def _uniform_density(wi: Numbers) -> Array:
    """1/(2 pi) in the shape of `wi` without its last axis."""
    return (0.0 * wi[..., 2] + 0.5 / np.pi)[()]
