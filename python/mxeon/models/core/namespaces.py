# SPDX-License-Identifier: Apache-2.0
"""Arrays of any library that follows the array API standard: its functions, and what brings arguments to it.

A formula takes its functions from its arguments, by the names of the standard. `any_array` marks what users call: with
arrays of PyTorch or JAX it brings all arguments to that library, its precision and its device. A value that a
transformation traces has no numbers yet, and is not checked.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import wraps
from importlib import import_module
from inspect import signature
from typing import ParamSpec, Protocol, TypeVar, cast

import numpy as np

from mxeon.models.core.arrays import Array, Numbers

P = ParamSpec("P")
R = TypeVar("R")


class Namespace(Protocol):
    """Functions of the array API standard."""

    def __getattr__(self, name: str) -> Callable[..., Array]: ...


PLAIN = np.ndarray, np.generic, float, int, list, tuple  # what is NumPy's, or becomes it
# NumPy below 2 has other names for some functions.
NUMPY = cast(Namespace, np if hasattr(np, "atan") else import_module("array_api_compat.numpy"))
# Types of numbers that are no arrays of the standard, and functions that were found, by library.
OTHERS: dict[str, type] = {}
FUNCTIONS: dict[str, Namespace] = {}


def library(value: object) -> str:
    """Name of the library other than NumPy whose array this is; "" for everything else."""
    if isinstance(value, PLAIN):
        return ""
    name = type(value).__module__.partition(".")[0]
    if hasattr(value, "dtype") if name == "torch" else hasattr(value, "__array_namespace__"):
        return name.removesuffix("lib")
    return next((name for name, kind in OTHERS.items() if isinstance(value, kind)), "")


def array_namespace(*arrays: object) -> Namespace:
    """Functions for these arrays: NumPy itself, unless one of them is another library's."""
    others = [each for each in arrays if library(each)]
    return _others_namespace(others) if others else NUMPY


def _others_namespace(others: Sequence[object]) -> Namespace:
    """Functions of the one library whose arrays these are."""
    names = sorted({library(each) for each in others})
    if len(names) > 1:
        raise ValueError(f"arrays must be of one library; got {' and '.join(names)}")
    if names[0] not in FUNCTIONS:
        found = import_module("array_api_compat").array_namespace(others[0])
        FUNCTIONS[names[0]] = cast(Namespace, found)
    return FUNCTIONS[names[0]]


def any_array(function: Callable[P, R]) -> Callable[P, R]:
    """Function that takes arrays of any library, and returns arrays of that library.

    Without such arrays it is the function itself, to the last bit. With them numbers, lists and arrays
    of NumPy are brought to their library, precision and device.
    """
    parameters = signature(function).parameters.values()
    names = [each.name for each in parameters]
    numbers = {each.name: each.default for each in parameters if type(each.default) is float}

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        others = [each for each in _values((*args, *kwargs.values())) if library(each)]
        if not others:
            return function(*args, **kwargs)
        convert = _converter(others)
        left = {name: numbers[name] for name in names[len(args) :] if name in numbers} | kwargs
        named = {name: convert(each) for name, each in left.items()}
        return cast(Callable[..., R], function)(*map(convert, args), **named)

    return wrapper


def _values(arguments: Iterable[object]) -> Iterator[object]:
    """Arguments, of a mapping by names what it holds."""
    for each in arguments:
        yield from each.values() if isinstance(each, Mapping) else (each,)


def _converter(others: Sequence[object]) -> Callable[[object], object]:
    """What brings an argument to the library, the precision and the device of these arrays."""
    xp, arrays = _others_namespace(others), cast("Sequence[Array]", others)
    for each in arrays:
        try:
            real = bool(xp.isdtype(each.dtype, ("bool", "integral", "real floating")))
        except TypeError:  # of JAX, whose random keys have a type that NumPy does not know
            real = False
        if not real:
            raise ValueError(f"arrays must be of real numbers; got one of {each.dtype}")
    floating = [each.dtype for each in arrays if xp.isdtype(each.dtype, "real floating")]
    dtype = floating[0] if floating else xp.asarray(0.5).dtype
    place = _place(arrays[0])

    def convert(value: object) -> object:
        if isinstance(value, Mapping):
            return {name: convert(each) for name, each in value.items()}
        if library(value):
            array = cast(Array, value)
            return array if xp.isdtype(array.dtype, "real floating") else xp.astype(array, dtype)
        if isinstance(value, bool) or not isinstance(value, PLAIN):
            return value
        if isinstance(value, float | int):  # which a compiler need not trace through NumPy
            return xp.asarray(value, dtype=dtype, **place)
        found = np.asarray(value)
        return xp.asarray(found, dtype=dtype, **place) if found.dtype.kind in "iuf" else value

    return convert


def _place(array: object) -> dict[str, object]:
    """The device of an array, where a library has arrays on several at once."""
    return {"device": cast(Array, array).device} if library(array) == "torch" else {}


def like(values: Numbers, array: Array) -> Array:
    """Values of NumPy as an array of another's library, precision and device."""
    xp = array_namespace(array)
    if xp is NUMPY:
        return np.asarray(values, np.float64)
    return xp.asarray(values, dtype=array.dtype, **_place(array))


def host_values(value: object) -> Numbers | None:
    """Values of another library's array in NumPy; None where a transformation traces it."""
    try:
        if library(value) != "torch":
            return np.asarray(value)
        import torch

        compiles = torch.compiler.is_compiling()
        return None if compiles else np.asarray(cast(torch.Tensor, value).detach().cpu())
    except (TypeError, RuntimeError) as error:  # of JAX, of torch
        if "deleted" in str(error):
            raise ValueError("arrays must have values; got one that was deleted") from None
        return None
