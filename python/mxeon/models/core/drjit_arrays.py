# SPDX-License-Identifier: Apache-2.0
"""Arrays of Dr.Jit, the compiler of Mitsuba: one number of it stands for many.

A direction is an `Array3f`, three such numbers. Here a number counts as one of shape (), a direction as one
of shape (3,), so that the checks of shapes and the formulas are those of the other libraries.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from types import SimpleNamespace
from typing import TypeAlias, cast

import numpy as np

from mxeon.models.core.arrays import Array

LONGEST = 4  # components of an array of Dr.Jit

Number: TypeAlias = Array  # one of Dr.Jit, whose type is that of the variant


@dataclass(frozen=True)
class Columns:
    """A direction or color whose components are numbers of Dr.Jit, indexed as arrays (..., C) are."""

    parts: tuple[Number, ...]
    ndim = 1

    @property
    def shape(self) -> tuple[int]:
        """(C,)."""
        return (len(self.parts),)

    def __getitem__(self, key: object) -> Number:
        """Component, by its number or by (..., number)."""
        return self.parts[cast(int, key[-1] if isinstance(key, tuple) else key)]

    def __iter__(self) -> Iterator[Number]:
        return iter(self.parts)


def is_drjit(value: object) -> bool:
    """Whether this is an array of Dr.Jit, or components of one."""
    drjit = sys.modules.get("drjit")
    return isinstance(value, Columns) or (drjit is not None and isinstance(value, drjit.ArrayBase))


def lift(number: Callable[[float], Number], value: object) -> object:
    """Number or `Columns` of Dr.Jit for an argument: its own, or a number, direction or color of NumPy."""
    if is_drjit(value):
        dynamic = isinstance(value, Columns) or import_module("drjit").size_v(value) < 0
        return value if dynamic else Columns(tuple(cast("Sequence[Number]", value)))
    numbers = np.asarray(value)
    if numbers.ndim > 1:
        raise ValueError(
            "beside arrays of Dr.Jit, one of NumPy must be a number, a direction or a color; got shape "
            f"{numbers.shape}"
        )
    parts = tuple(number(float(each)) for each in numbers.ravel())
    return Columns(parts) if numbers.ndim else parts[0]


def constant(value: float | Number) -> float | None:
    """Number that is written into a kernel and has no gradient; None for every other array."""
    if isinstance(value, float):
        return value
    drjit, state = import_module("drjit"), cast(SimpleNamespace, value).state
    if drjit.grad_enabled(value) or state != drjit.VarState.Literal:
        return None
    return float(value[0])


def number_type(values: Sequence[object]) -> Callable[[float], Number]:
    """Type of the numbers of these arrays of Dr.Jit."""
    first = cast(Number, values[0])
    kind = type(first[0] if import_module("drjit").size_v(first) >= 0 else first)
    if kind is float or ".scalar" in kind.__module__:
        raise ValueError("arrays of Dr.Jit must be compiled ones, such as those of drjit.llvm.ad")
    return cast("Callable[[float], Number]", kind)


def vector(parts: Sequence[Number]) -> Array:
    """`Array2f`, `Array3f` or `Array4f` of numbers of Dr.Jit; of one the number, of more the list."""
    if len(parts) == 1:
        return parts[0]
    if len(parts) > LONGEST:
        return cast(Array, list(parts))
    kind = type(parts[0])
    name = f"Array{len(parts)}f{'64' * kind.__name__.endswith('64')}"
    return cast(Array, getattr(import_module(kind.__module__), name)(*parts))


@lru_cache(maxsize=1)
def drjit_namespace() -> SimpleNamespace:
    """Functions of Dr.Jit, which has most names of the standard; the first axis is that of components."""
    drjit = import_module("drjit")

    def log1p(x: Number) -> Number:
        u = 1.0 + x  # whose rounding the quotient undoes
        rounded = drjit.log(u) * (x / drjit.select(u == 1.0, 1.0, u - 1.0))
        return cast(Number, drjit.select(u == 1.0, x, rounded))

    def tensordot(rows: Array, parts: Sequence[Number], axes: int) -> list[Number]:
        return [sum(c * x for c, x in zip(row, parts, strict=True)) for row in rows.tolist()]

    others = {"stack": vector, "where": drjit.select, "log1p": log1p, "tensordot": tensordot}
    return SimpleNamespace(**vars(drjit) | others)
