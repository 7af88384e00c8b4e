# SPDX-License-Identifier: Apache-2.0
"""Dr.Jit's functions under the names of the array API standard, for the formulas of `mxeon.models`.

A Dr.Jit number is an array of values. A direction is an `Array3f`, components on the first axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from types import SimpleNamespace
from typing import cast

import numpy as np

from mxeon.models.core.arrays import FUNCTIONS, OTHERS, Array, Namespace


def register_functions() -> None:
    """Make the formulas accept Dr.Jit numbers."""
    drjit = import_module("drjit")

    def log1p(x: Array) -> Array:
        u = 1.0 + x  # the quotient log(u) / (u - 1) cancels the rounding of u
        rounded = drjit.log(u) * (x / drjit.select(u == 1.0, 1.0, u - 1.0))
        return cast(Array, drjit.select(u == 1.0, x, rounded))

    others = {"stack": vector, "where": drjit.select, "log1p": log1p, "finfo": np.finfo}
    FUNCTIONS["drjit"] = cast(Namespace, SimpleNamespace(**vars(drjit) | others))
    OTHERS["drjit"] = drjit.ArrayBase


def vector(parts: Sequence[Array]) -> Array:
    """Dr.Jit numbers stacked into an `Array2f`, `Array3f` or `Array4f`."""
    kind = type(parts[0])
    name = f"Array{len(parts)}f{'64' * kind.__name__.endswith('64')}"
    return cast(Array, getattr(import_module(kind.__module__), name)(*parts))
