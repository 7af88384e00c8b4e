# SPDX-License-Identifier: Apache-2.0
"""Arrays of other libraries than NumPy: their functions, and whether their values are checked.

A formula takes its functions from its arguments, by the names of the array API standard. What needs
no NumPy besides is marked by `any_array`, and returns arrays of the library that it is given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, wraps
from importlib import import_module
from inspect import signature
from types import SimpleNamespace
from typing import ParamSpec, Protocol, TypeVar, cast

import numpy as np

from mxeon.models.core.arrays import Array, Numbers
from mxeon.models.core.drjit_arrays import drjit_namespace, is_drjit, lift, number_type

P = ParamSpec("P")
R = TypeVar("R")

_checking: ContextVar[bool] = ContextVar("checking", default=True)
_any_array: ContextVar[bool] = ContextVar("any_array", default=False)


class Namespace(Protocol):
    """Functions of the array API standard of which formulas are made."""

    abs: Callable[..., Array]
    acos: Callable[..., Array]
    asarray: Callable[..., Array]
    asin: Callable[..., Array]
    asinh: Callable[..., Array]
    astype: Callable[..., Array]
    atan: Callable[..., Array]
    atan2: Callable[..., Array]
    broadcast_to: Callable[..., Array]
    concat: Callable[..., Array]
    cos: Callable[..., Array]
    cosh: Callable[..., Array]
    exp: Callable[..., Array]
    expm1: Callable[..., Array]
    hypot: Callable[..., Array]
    log: Callable[..., Array]
    log1p: Callable[..., Array]
    maximum: Callable[..., Array]
    mean: Callable[..., Array]
    minimum: Callable[..., Array]
    permute_dims: Callable[..., Array]
    remainder: Callable[..., Array]
    reshape: Callable[..., Array]
    sin: Callable[..., Array]
    sinh: Callable[..., Array]
    sort: Callable[..., Array]
    sqrt: Callable[..., Array]
    square: Callable[..., Array]
    stack: Callable[..., Array]
    sum: Callable[..., Array]
    tanh: Callable[..., Array]
    tensordot: Callable[..., Array]
    where: Callable[..., Array]
    finfo: Callable[..., np.finfo[np.float64]]
    isdtype: Callable[..., bool]


# NumPy below 2 has other names for some functions.
_NAMES = {
    "acos": np.arccos,
    "asin": np.arcsin,
    "asinh": np.arcsinh,
    "concat": np.concatenate,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "permute_dims": np.transpose,
}
NUMPY = cast(Namespace, np if hasattr(np, "atan") else SimpleNamespace(**{**vars(np), **_NAMES}))


@contextmanager
def unchecked() -> Iterator[None]:
    """Context in which the functions of `mxeon.models` do not look at the values of arrays.

    Kinds and shapes are still checked, but a value outside its range gives whatever the formula
    gives, which may be NaN. So does a value that `jax.jit`, `jax.grad` or `torch.vmap` traces,
    within this context or without: it has no numbers yet. The setting belongs to the thread or task
    that enters the context.

        >>> from mxeon.models import lambert_brdf
        >>> with unchecked():
        ...     lambert_brdf([0.6, 0.0, 0.8], [0.8, 0.0, 0.6], 1.5).round(6)
        array([0.477465])
    """
    token = _checking.set(False)
    try:
        yield
    finally:
        _checking.reset(token)


def checking() -> bool:
    """Whether values are looked at: False within `unchecked`."""
    return _checking.get()


def library(value: object) -> str:
    """Name of the library other than NumPy whose array this is; "" for everything else."""
    if isinstance(value, np.ndarray | np.generic | float | int | list | tuple):
        return ""
    if is_drjit(value):
        return "drjit"
    name = type(value).__module__.partition(".")[0]
    if name == "torch" and hasattr(value, "dtype"):
        return name
    return name.removesuffix("lib") if hasattr(value, "__array_namespace__") else ""


def array_namespace(*arrays: object) -> Namespace:
    """Functions for these arrays: NumPy itself, unless one of them is another library's."""
    others = [each for each in arrays if library(each)]
    return _others_namespace(others) if others else NUMPY


def _others_namespace(others: Sequence[object]) -> Namespace:
    """Functions of the one library whose arrays these are."""
    names = sorted({library(each) for each in others})
    if len(names) > 1:
        raise ValueError(f"arrays must be of one library; got {' and '.join(names)}")
    if names == ["drjit"]:
        return cast(Namespace, drjit_namespace())
    if names == ["torch"]:
        try:
            return cast(Namespace, import_module("array_api_compat.torch"))
        except ImportError:
            raise ImportError(
                "arrays of torch need array-api-compat: pip install '.[arrays]' in a checkout of mxeon"
            ) from None
    return cast(Namespace, _own_namespace(others[0]))


def _own_namespace(array: object) -> object:
    """What an array of the standard says itself."""
    namespace: Callable[[], object] = array.__array_namespace__  # type: ignore[attr-defined]
    try:
        return namespace()
    except NotImplementedError:  # of JAX's keys of random numbers
        dtype = getattr(array, "dtype", type(array).__name__)
        raise ValueError(f"arrays must be of real numbers; got one of {dtype}") from None


def any_array(function: Callable[P, R]) -> Callable[P, R]:
    """Function that takes arrays of any library but Dr.Jit, and returns arrays of that library.

    Without such arrays it is the function itself, to the last bit. With them numbers, lists and arrays
    of NumPy are brought to their library, precision and device.
    """
    return _portable(function, drjit=False)


def any_array_or_drjit(function: Callable[P, R]) -> Callable[P, R]:
    """`any_array` of a function that takes arrays of Dr.Jit too."""
    return _portable(function, drjit=True)


def _portable(function: Callable[P, R], drjit: bool) -> Callable[P, R]:
    """Function that brings its arguments to the library of any of them."""

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        # Call it as it is without another library's arrays.
        others = [each for each in _values((*args, *kwargs.values())) if library(each)]
        if not others:
            return function(*args, **kwargs)
        convert = _converter(others, drjit)
        values = (convert(each) for each in args)
        left = _numbers(function, len(args)) | kwargs
        named = {name: convert(each) for name, each in left.items()}
        token = _any_array.set(True)
        try:
            return cast(Callable[..., R], function)(*values, **named)
        finally:
            _any_array.reset(token)

    vars(wrapper)["takes_drjit"] = drjit
    return wrapper


@cache
def _numbers(function: Callable[..., object], given: int) -> dict[str, object]:
    """Numbers that are defaults of a function's parameters, but of the first ones, which are given."""
    left = list(signature(function).parameters.values())[given:]
    return {each.name: each.default for each in left if type(each.default) is float}


def _values(arguments: Iterable[object]) -> Iterator[object]:
    """Arguments, of a mapping by names what it holds."""
    for each in arguments:
        yield from each.values() if isinstance(each, Mapping) else (each,)


def _converter(others: Sequence[object], drjit: bool) -> Callable[[object], object]:
    """What brings an argument to the library, the precision and the device of these arrays."""
    if library(others[0]) == "drjit":
        return _drjit_converter(others, drjit)
    xp = _others_namespace(others)
    arrays = cast("Sequence[Array]", others)
    floating = [each.dtype for each in arrays if xp.isdtype(each.dtype, "real floating")]
    dtype = floating[0] if floating else xp.asarray(0.5).dtype
    place = {"device": arrays[0].device} if library(others[0]) == "torch" else {}

    def convert(value: object) -> object:
        if isinstance(value, Mapping):
            return {name: convert(each) for name, each in value.items()}
        if library(value):
            array = cast(Array, value)
            return array if xp.isdtype(array.dtype, "real floating") else xp.astype(array, dtype)
        if isinstance(value, bool) or not isinstance(
            value, np.ndarray | float | int | list | tuple
        ):
            return value
        numbers = np.asarray(value)
        return xp.asarray(numbers, dtype=dtype, **place) if numbers.dtype.kind in "iuf" else value

    return convert


def _drjit_converter(others: Sequence[object], accepted: bool) -> Callable[[object], object]:
    """What brings an argument to Dr.Jit, where a function takes its arrays."""
    if not accepted:
        raise ValueError(
            "arrays must not be Dr.Jit's: the page on arrays lists the functions that take them"
        )
    if checking():
        raise ValueError(
            "arrays of Dr.Jit have no values until they are evaluated, and cannot be checked; call "
            "within mxeon.models.unchecked()"
        )
    number = number_type(others)
    return lambda value: value if isinstance(value, bool | str) else lift(number, value)


def like(values: Numbers, array: Array) -> Array:
    """Values of NumPy as an array of another's library, precision and device."""
    xp = array_namespace(array)
    if xp is NUMPY:
        return np.asarray(values, np.float64)
    place = {"device": array.device} if library(array) == "torch" else {}
    return xp.asarray(values, dtype=array.dtype, **place)


def accept(name: str, value: object) -> None:
    """Raise ValueError unless the function at hand takes this other library's array as `name`."""
    if not _any_array.get():
        raise ValueError(
            f"{name} must be an array of NumPy, not of {library(value)}: this function takes no other; "
            "the page on arrays lists those that do"
        )


def host_values(value: object) -> Numbers | None:
    """Values of another library's array in NumPy; None where a transformation traces it."""
    try:
        if library(value) != "torch":
            return np.asarray(value)
        tensor: Callable[[], object] = value.detach  # type: ignore[attr-defined]
        return np.asarray(tensor().cpu())  # type: ignore[attr-defined]
    except (TypeError, RuntimeError) as error:  # of JAX, of torch
        if "deleted" in str(error):
            raise ValueError("arrays must have values; got one that was deleted") from None
        return None
