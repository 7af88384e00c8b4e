# SPDX-License-Identifier: Apache-2.0
"""Dr.Jit's functions under the names of the array API standard, and tables of piecewise cubics.

A Dr.Jit number is an array of values. A direction is an `Array3f` with components on the first
axis. Dr.Jit can evaluate the formulas of `mxeon.models` because of the standard names.

A curve over (0, 1] is tabulated as a cubic in each of 16 equal parts of each octave. The index of a
part is computed from the bits of a float32, without a logarithm. Octaves resolve a curve at any
scale. The albedo of facets depends on cosine / alpha, so the scale is small if alpha is small.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from types import SimpleNamespace
from typing import cast

import numpy as np

from mxeon.models.core.arrays import FUNCTIONS, OTHERS, Array, Namespace
from mxeon.models.core.chebyshev import chebyshev_nodes

OCTAVES, PARTS = 126, 16  # octaves from the smallest normal float32 to 1, and parts per octave
LOWER_BITS = 19  # lower bits of a float32, which do not affect octave and part
MIDDLE = 1.5  # middle of the octave that starts at 1


def register_functions() -> None:
    """Let the formulas of `mxeon.models` accept Dr.Jit numbers."""
    drjit = import_module("drjit")

    def log1p(x: Array) -> Array:
        u = 1.0 + x  # the quotient log(u) / (u - 1) cancels the rounding of u
        rounded = drjit.log(u) * (x / drjit.select(u == 1.0, 1.0, u - 1.0))
        return cast(Array, drjit.select(u == 1.0, x, rounded))

    functions = {"stack": vector, "where": drjit.select, "log1p": log1p, "finfo": np.finfo}
    FUNCTIONS["drjit"] = cast(Namespace, SimpleNamespace(**vars(drjit) | functions))
    OTHERS["drjit"] = drjit.ArrayBase


def vector(parts: Sequence[Array]) -> Array:
    """Dr.Jit numbers stacked into an `Array2f`, `Array3f` or `Array4f`."""
    kind = type(parts[0])
    name = f"Array{len(parts)}f{'64' * kind.__name__.endswith('64')}"
    return cast(Array, getattr(import_module(kind.__module__), name)(*parts))


def octave_cells(x: Array) -> tuple[Array, Array]:
    """Index of the part with x, and x minus the octave's middle, divided by the octave's start."""
    drjit = import_module("drjit")
    integer, single = drjit.uint32_array_t(type(x)), drjit.float32_array_t(type(x))
    x = drjit.maximum(x, 2.0**-OCTAVES)
    clamped = drjit.minimum(drjit.detach(x), 1.0 - 2.0**-24)
    bits = drjit.reinterpret_array(integer, single(clamped))
    # The reciprocal of the octave's start, a power of two, is computed from the exponent bits.
    scale = type(x)(drjit.reinterpret_array(single, 0x7F000000 - (bits & 0x7F800000)))
    return (bits >> LOWER_BITS) - PARTS, drjit.fma(x, scale, -MIDDLE)


def octave_cubics(curve: Callable[[Array], Array]) -> Array:
    """Coefficients of a cubic through four points in each part, (parts, 4), constant first."""
    places = 1.0 + (np.arange(PARTS)[:, np.newaxis] + np.sort(chebyshev_nodes(4))) / PARTS
    octaves = 2.0 ** np.arange(-OCTAVES, 0)[:, np.newaxis, np.newaxis]
    powers = np.linalg.inv(np.vander((places - MIDDLE).ravel(), 4, True).reshape(-1, 4, 4))
    return np.asarray(np.einsum("pij,opj->opi", powers, curve(octaves * places)).reshape(-1, 4))


def gather_cubic(table: Array, cell: Array, x: Array) -> Array:
    """Value at x of the cubic of a cell. Each row of the table has the coefficients of a cell."""
    drjit = import_module("drjit")
    c = drjit.gather(type(vector([x] * 4)), table, cell)
    return cast(Array, drjit.fma(drjit.fma(drjit.fma(c.w, x, c.z), x, c.y), x, c.x))
