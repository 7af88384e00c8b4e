# SPDX-License-Identifier: Apache-2.0
"""Curves over (0, 1] as cubics in parts of octaves, for Dr.Jit.

The bits of a float32 give the part without a logarithm. Octaves resolve curves at any scale, such as the albedo of
facets, which depends on cosine / alpha.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import cast

import numpy as np

from mxeon.mitsuba.arrays import vector
from mxeon.models.core.arrays import Array
from mxeon.models.core.chebyshev import chebyshev_nodes

OCTAVES, PARTS = 126, 16  # down to the smallest normal float32; parts of each
LOWER_BITS = 19  # bits of a float32 below octave and part
MIDDLE = 1.5  # middle of the octave that starts at 1


def octave_cells(x: Array) -> tuple[Array, Array]:
    """Index of a number's part, and its distance from the octave's middle relative to the octave."""
    drjit = import_module("drjit")
    integer, single = drjit.uint32_array_t(type(x)), drjit.float32_array_t(type(x))
    x = drjit.maximum(x, 2.0**-OCTAVES)
    inside = drjit.minimum(drjit.detach(x), 1.0 - 2.0**-24)
    bits = drjit.reinterpret_array(integer, single(inside))
    # Divide by the start of the octave, whose exponent is known.
    scale = type(x)(drjit.reinterpret_array(single, 0x7F000000 - (bits & 0x7F800000)))
    return (bits >> LOWER_BITS) - PARTS, drjit.fma(x, scale, -MIDDLE)


def octave_cubics(curve: Callable[[Array], Array]) -> Array:
    """Coefficients of cubics through four points of a curve in each part, lowest first, shape (parts, 4)."""
    places = 1.0 + (np.arange(PARTS)[:, np.newaxis] + np.sort(chebyshev_nodes(4))) / PARTS
    octaves = 2.0 ** np.arange(-OCTAVES, 0)[:, np.newaxis, np.newaxis]
    powers = np.linalg.inv(np.vander((places - MIDDLE).ravel(), 4, True).reshape(-1, 4, 4))
    return np.asarray(np.einsum("pij,opj->opi", powers, curve(octaves * places)).reshape(-1, 4))


def gather_cubic(table: Array, cell: Array, x: Array) -> Array:
    """Value of a cell's cubic, whose four coefficients are rows of a table."""
    drjit = import_module("drjit")
    c = drjit.gather(type(vector([x] * 4)), table, cell)
    return cast(Array, drjit.fma(drjit.fma(drjit.fma(c.w, x, c.z), x, c.y), x, c.x))
