# SPDX-License-Identifier: Apache-2.0
"""Conversion to libraries that follow the array API standard, and differentiable functions.

A formula calls the standard's functions in the library of its arguments. The decorator `any_array` wraps public
functions: if one argument is an array of PyTorch or JAX, all arguments are converted to that
library, precision and device. Traced arguments are not checked, because a traced argument has no
values.

Automatic differentiation multiplies the derivatives of all steps, so a square root at 0 may lead to
infinity times 0. The functions from `cosine` to the end of the file avoid such products. For NumPy,
these functions equal the plain operations to the last bit. For other libraries, a separate branch
returns the value at the end of the domain, with the derivative that the docstring states.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from importlib import import_module
from inspect import signature
from itertools import chain, repeat
from typing import Any, ParamSpec, Protocol, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Array", "ArrayLike", "Number", "Numbers"]

# Results are float64. If all arguments are numbers, the result is a NumPy scalar, which acts like an array.
Array: TypeAlias = NDArray[np.float64]

# An array or a number. Results have the type of the argument.
Number = TypeVar("Number", Array, float)

# Validated arguments, in the precision of the caller's arrays.
Numbers: TypeAlias = NDArray[Any]


P = ParamSpec("P")
R = TypeVar("R")


class Namespace(Protocol):
    """The functions of the array API standard in one library."""

    def __getattr__(self, name: str) -> Callable[..., Array]: ...


PLAIN = np.ndarray, np.generic, float, int, list, tuple
# NumPy 1 lacks some names of the array API standard, such as `atan`.
NUMPY = cast(Namespace, np if hasattr(np, "atan") else import_module("array_api_compat.numpy"))
# The keys are names of libraries. OTHERS has array types without the standard's methods.
OTHERS: dict[str, type] = {}
FUNCTIONS: dict[str, Namespace] = {}


def library(value: object) -> str:
    """Name of an array's library, or "" for NumPy and for values that are not arrays."""
    if isinstance(value, PLAIN):
        return ""
    name = type(value).__module__.partition(".")[0]
    if hasattr(value, "dtype") if name == "torch" else hasattr(value, "__array_namespace__"):
        return name.removesuffix("lib")
    return next((name for name, kind in OTHERS.items() if isinstance(value, kind)), "")


def array_namespace(*arrays: object) -> Namespace:
    """Array functions of the arguments' library. Numbers belong to NumPy."""
    foreign = {name: each for each in arrays if (name := library(each))}
    if not foreign:
        return NUMPY
    if len(foreign) > 1:
        raise ValueError(f"arrays must be of one library; got {' and '.join(sorted(foreign))}")
    (name,) = foreign
    if name not in FUNCTIONS:
        found = import_module("array_api_compat").array_namespace(foreign[name])
        FUNCTIONS[name] = cast(Namespace, found)
    return FUNCTIONS[name]


def any_array(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator that lets a function accept and return arrays of any library.

    Results for NumPy arrays are unchanged to the last bit. If an argument is an array of another
    library, numbers, lists and NumPy arrays are converted to that library, precision and device.
    Plain numbers for parameters annotated as `float` are not converted.
    """
    parameters = signature(function).parameters.values()
    names = [each.name for each in parameters]
    plain = {each.name for each in parameters if each.annotation == "float"}
    numbers = {each.name: each.default for each in parameters if type(each.default) is float}

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        values = (
            each.values() if isinstance(each, Mapping) else (each,)
            for each in (*args, *kwargs.values())
        )
        foreign = [each for each in chain.from_iterable(values) if library(each)]
        if not foreign:
            return function(*args, **kwargs)
        convert = _converter(foreign)
        named = {name: numbers[name] for name in names[len(args) :] if name in numbers} | kwargs

        def converted(name: str, value: object) -> object:
            return value if name in plain and not library(value) else convert(value)

        return cast(Callable[..., R], function)(
            *map(converted, chain(names, repeat("")), args),
            **{name: converted(name, value) for name, value in named.items()},
        )

    return wrapper


def _converter(foreign: Sequence[object]) -> Callable[[object], object]:
    """A function that converts values to the library, precision and device of `foreign`."""
    xp, arrays = array_namespace(*foreign), cast("Sequence[Array]", foreign)
    for each in arrays:
        try:
            real = bool(xp.isdtype(each.dtype, ("bool", "integral", "real floating")))
        except TypeError:  # NumPy does not know the type of JAX's random keys
            real = False
        if not real:
            raise ValueError(f"arrays must be of real numbers; got one of {each.dtype}")
    floating = [each.dtype for each in arrays if xp.isdtype(each.dtype, "real floating")]
    dtype = floating[0] if floating else xp.asarray(0.5).dtype
    place = _device(arrays[0])

    def convert(value: object) -> object:
        if isinstance(value, Mapping):
            return {name: convert(each) for name, each in value.items()}
        if library(value):
            array = cast(Array, value)
            return array if xp.isdtype(array.dtype, "real floating") else xp.astype(array, dtype)
        if isinstance(value, bool) or not isinstance(value, PLAIN):
            return value
        if isinstance(value, float | int):  # numbers become constants in compiled code
            return xp.asarray(value, dtype=dtype, **place)
        array = np.asarray(value)
        return xp.asarray(array, dtype=dtype, **place) if array.dtype.kind in "iuf" else value

    return convert


def _device(array: object) -> dict[str, object]:
    """Keyword argument `device` of a PyTorch array; an empty dictionary for other libraries."""
    return {"device": cast(Array, array).device} if library(array) == "torch" else {}


def like(values: Numbers, array: Array) -> Array:
    """NumPy values converted to the library, precision and device of another array."""
    xp = array_namespace(array)
    if xp is NUMPY:
        return np.asarray(values, np.float64)
    return xp.asarray(values, dtype=array.dtype, **_device(array))


def host_values(value: object) -> Numbers | None:
    """Another library's array as a NumPy array, or None if the array is traced."""
    try:
        if library(value) != "torch":
            return np.asarray(value)
        import torch

        compiles = torch.compiler.is_compiling()
        return None if compiles else np.asarray(cast(torch.Tensor, value).detach().cpu())
    except (TypeError, RuntimeError) as error:  # errors of JAX and torch while tracing
        if "deleted" in str(error):
            raise ValueError("arrays must have values; got one that was deleted") from None
        return None


def cosine(z: Array) -> Array:
    """Cosine of a direction's polar angle: z, clamped to [0, 1] because z may be rounded."""
    # In NumPy arrays, z is not negative, because the caller has checked the direction.
    return np.minimum(z, 1.0) if array_namespace(z) is NUMPY else within(z)


def least_normal(x: Array) -> float:
    """Smallest normal number in the precision of x."""
    return float(precision(x).tiny)


def precision(x: Array) -> np.finfo[np.float64]:
    """Floating-point limits of an array's dtype, or of float32 for a value without dtype."""
    return cast("np.finfo[np.float64]", array_namespace(x).finfo(getattr(x, "dtype", np.float32)))


def at_most(x: Array, high: float) -> Array:
    """The smaller of x and `high`. At x = `high` the derivative is 1."""
    xp = array_namespace(x)
    return xp.minimum(x, high) if xp is NUMPY else xp.where(x > high, high, x)


def trimmed(x: Array, high: float) -> Array:
    """x clamped to `high`, if x exceeds `high` only by rounding. Derivatives ignore the clamp."""
    xp = array_namespace(x)
    return xp.minimum(x, high) if xp is NUMPY else x


def at_least_0(x: Array) -> Array:
    """The larger of x and 0; at 0 the derivative is 1."""
    xp = array_namespace(x)
    return xp.maximum(x, 0.0) if xp is NUMPY else xp.where(x < 0.0, 0.0, x)


def magnitude(x: Array) -> Array:
    """Absolute value of x; at 0 the derivative is 1."""
    xp = array_namespace(x)
    return xp.abs(x) if xp is NUMPY else xp.where(x < 0.0, -x, x)


def within(x: Array, low: float = 0.0, high: float = 1.0) -> Array:
    """x clamped to [low, high]; at both ends the derivative is 1."""
    xp = array_namespace(x)
    return np.clip(x, low, high) if xp is NUMPY else xp.where(x < low, low, at_most(x, high))


def except_where(
    edge: Callable[[Array], Numbers],
    value: Array | float,
    formula: Callable[[Array], Array],
    x: Array,
    interior: float,
) -> Array:
    """formula(x), but `value` with derivative 0 where `edge(x)` is true."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return formula(x)
    at = edge(x)
    return xp.where(at, value, formula(xp.where(at, interior, x)))


def root(x: Array) -> Array:
    """Square root; at 0 the derivative is set to 0."""
    return except_where(lambda x: ~(x > 0.0), 0.0, array_namespace(x).sqrt, x, 1.0)


def hypot(x: Array, y: Array) -> Array:
    """Length of (x, y); at the origin the derivative is set to 0."""
    length = array_namespace(x, y).hypot
    return except_where(lambda x: (x == 0.0) & (y == 0.0), 0.0, lambda x: length(x, y), x, 1.0)


def arcsine(x: Array) -> Array:
    """Arc sine of x clamped to [-1, 1]; at both ends and beyond, the derivative is set to 0."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return xp.asin(xp.minimum(xp.maximum(x, -1.0), 1.0))
    end = like(np.asarray(0.5 * np.pi), x)
    ends = xp.where(x < 0.0, -end, end)
    return except_where(lambda x: ~(xp.abs(x) < 1.0), ends, xp.asin, x, 0.0)


def arccosine(x: Array) -> Array:
    """Arc cosine of x clamped to [-1, 1]; at both ends and beyond, the derivative is set to 0."""
    xp = array_namespace(x)
    if xp is NUMPY:
        return xp.acos(xp.minimum(xp.maximum(x, -1.0), 1.0))
    return 0.5 * np.pi - arcsine(x)


def angle(y: Array, x: Array) -> Array:
    """Polar angle of (x, y). At the origin, the result and the derivatives are as at (1, 0)."""
    xp = array_namespace(x, y)
    if xp is NUMPY:
        return xp.atan2(y, x)
    origin = (x == 0.0) & (y == 0.0)
    return xp.atan2(y, xp.where(origin, 1.0, x))


def power(base: Array, exponent: Array | float) -> Array:
    """base^exponent. An infinite derivative at base 0 is replaced by 0."""
    flat = 1.0 * (cast(Array, exponent) == 0.0)
    steep = exponent < 1.0
    return except_where(lambda x: (x == 0.0) & steep, flat, lambda x: x**exponent, base, 1.0)


def below_1(x: Array) -> float:
    """Largest number below 1 in the precision of x."""
    return 1.0 - 0.5 * float(precision(x).eps)


def guarded(x: Array, valid: Numbers, placeholder: float) -> Array:
    """x, replaced by `placeholder` where `valid` is false. NumPy arrays are returned unchanged."""
    xp = array_namespace(x, valid)
    return x if xp is NUMPY else xp.where(valid, x, placeholder)
