# SPDX-License-Identifier: Apache-2.0
"""Validation of arguments: ranges, directions, switches and choices; `shapes` has their shapes.

Directions leave the surface, in a local frame with the normal +z.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NoReturn, cast

import numpy as np

from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.namespaces import array_namespace, host_values, library
from mxeon.models.core.ranges import CLOSED, RANGES
from mxeon.models.core.shapes import broadcastable, channel_count, spread_pair, with_axis
from mxeon.models.core.tiling import blocks, channels_first
from mxeon.names import NONE, unknown

# Largest error of the squared length of a direction: directions rounded to float32 pass.
UNIT_TOLERANCE = 1e-6

# One rounding of float32: an argument that leaves its range by less counts as the end of the range.
ROUNDING = 2.0**-23


def checked(name: str, value: ArrayLike, quantity: str = "") -> Numbers:
    """Argument as an array of real numbers inside the range that its name has in `RANGES`.

    `quantity` is the key of `RANGES` where it is not the name. A value beyond an end of a range of
    `CLOSED` by less than `ROUNDING` counts as that end.
    """

    def in_range(array: Numbers) -> Numbers:
        low, high, interval = RANGES[quantity or name]
        # In float64: half floats would round the ends of the range to infinity.
        if not array.size or (float(array.min()) >= low and float(array.max()) <= high):
            return array
        # Count one rounding beyond an end as the end.
        beyond = ROUNDING if interval in CLOSED else 0.0
        wide = np.asarray(array, np.float64)
        valid = (wide >= low - beyond) & (wide <= high + beyond)
        if not valid.all():
            _refuse(f"{name} must lie in {interval}", array, valid)
        return np.where(valid, np.clip(array, low, high), array)

    return _array(name, value, in_range)


def checked_real(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of any real numbers."""
    return _array(name, value, lambda array: array)


def checked_numbers(**values: ArrayLike) -> list[Array]:
    """Numbers inside the ranges of their names, in float64, whose shapes broadcast."""
    return broadcastable({}, {name: checked(name, value) for name, value in values.items()})


def checked_vector(name: str, value: ArrayLike) -> Numbers:
    """Argument inside the range of its name, with at least one axis."""
    return with_axis(checked(name, value))


def checked_color(name: str, value: ArrayLike) -> Numbers:
    """Argument inside the range of its name, with an axis of at least one channel."""
    color = checked_vector(name, value)
    if not color.shape[-1]:
        raise ValueError(f"{name} must have at least one channel; got shape {tuple(color.shape)}")
    return color


def checked_rgb(name: str, value: ArrayLike) -> Numbers:
    """Argument inside the range of its name, in red, green and blue; one channel counts for all."""
    color = checked_color(name, value)
    if color.shape[-1] not in (1, 3):
        raise ValueError(f"{name} must have 1 or 3 channels; got shape {tuple(color.shape)}")
    return array_namespace(color).broadcast_to(color, (*color.shape[:-1], 3))


def checked_colors(
    colors: Mapping[str, ArrayLike], **numbers: ArrayLike
) -> tuple[list[Array], list[Array]]:
    """Colors (..., C) and numbers with an axis for their channels, in float64, that broadcast."""
    vectors = {name: checked_color(name, value) for name, value in colors.items()}
    values = broadcastable(vectors, {name: checked(name, each) for name, each in numbers.items()})
    channel_count(vectors)
    return values[: len(colors)], [value[..., np.newaxis] for value in values[len(colors) :]]


def checked_switch(name: str, value: bool) -> bool:
    """Argument that is True or False."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False; got {value!r}")
    return bool(value)


def checked_count(name: str, value: int) -> int:
    """Argument that is a positive integer, and not too large for an array."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or not 0 < value < 2**31:
        raise ValueError(f"{name} must be a positive integer; got {value!r}")
    return int(value)


def checked_choice(
    name: str, value: str, known: Iterable[str], titles: Mapping[str, str] = NONE
) -> str:
    """Argument that is one of the known words, which may have titles; see `mxeon.names.unknown`."""
    if message := unknown(name, value, known, titles):
        raise ValueError(message)
    return value


def checked_directions(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of unit vectors on or above the horizon, (..., 3) in float64."""

    def above(array: Numbers) -> Numbers:
        valid = all(
            are_directions(channels_first(array[block])) for block in blocks(array.shape[:-1])
        )
        if not valid:
            refuse_direction(name, array)
        return on_horizon(array, -1)

    return _array(name, checked_triples(name, value), above)


def checked_transmitted(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 3) of unit vectors, none of which points above the horizon."""

    def below(array: Numbers) -> Numbers:
        z = array[..., 2]
        if (z > ROUNDING).any():
            _refuse(f"{name} must not point above the horizon (z <= 0)", z, ~(z > ROUNDING), "z = ")
        return -on_horizon(-checked_sphere(name, array), -1)

    return _array(name, checked_triples(name, value), below)


def checked_sphere(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 3) of unit vectors, on either side of the surface."""

    def unit(array: Numbers) -> Numbers:
        checked_directions(name, np.concatenate([array[..., :2], np.abs(array[..., 2:])], axis=-1))
        return array

    return _array(name, checked_triples(name, value), unit)


def checked_triples(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of shape (..., 3), whose lengths are not looked at."""
    array = checked_real(name, value)
    if array.shape[-1:] != (3,):
        raise ValueError(f"{name} must have shape (..., 3); got shape {tuple(array.shape)}")
    return array


def checked_pairs(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 2) inside the range that its name has in `RANGES`."""
    array = checked(name, value)
    if array.shape[-1:] != (2,):
        raise ValueError(f"{name} must have shape (..., 2); got shape {tuple(array.shape)}")
    return array


def checked_roughness(value: ArrayLike) -> Numbers:
    """alpha along tangent and bitangent in [0, 1], shape (..., 2); a number counts for both."""
    return spread_pair("roughness", checked("roughness", value))


def are_directions(components: Numbers) -> bool:
    """Whether all vectors of shape (3, ...) are unit and on or above the horizon."""
    x, y, z = components
    if not z.size:
        return True
    with np.errstate(over="ignore"):
        length = x * x + y * y + z * z
    unit = abs(length.min() - 1.0) <= UNIT_TOLERANCE and abs(length.max() - 1.0) <= UNIT_TOLERANCE
    return bool(unit and z.min() >= -ROUNDING)


def on_horizon(w: Numbers, axis: int = 0) -> Numbers:
    """Directions with their components on an axis; those below the horizon by a rounding, on it."""
    z = w.take(2, axis)
    if not z.size or z.min() >= 0.0:
        return w
    below = np.moveaxis(np.array(w), axis, 0)
    below[2] = np.where(z >= -ROUNDING, np.maximum(z, 0.0), z)
    return np.moveaxis(below, 0, axis)


def refuse_direction(name: str, w: Numbers) -> NoReturn:
    """Raise for the first direction that is below the horizon or else of the wrong length."""
    z = w[..., 2]
    if (z < -ROUNDING).any():
        _refuse(f"{name} must not point below the horizon (z >= 0)", z, ~(z < -ROUNDING), "z = ")
    with np.errstate(over="ignore"):
        length = np.sum(np.square(w, dtype=np.float64), axis=-1)
    unit = np.abs(length - 1.0) <= UNIT_TOLERANCE
    _refuse(f"{name} must be unit vectors to {UNIT_TOLERANCE}", length, unit, "squared length ")


def _array(name: str, value: ArrayLike, check: Callable[[Numbers], Numbers]) -> Numbers:
    """Argument as a float64 array that a check returns; another library's as it came."""
    if not library(value):
        return np.asarray(check(_real(name, value)), np.float64)
    if (values := host_values(value)) is not None:
        check(_real(name, values))
    return cast(Numbers, value)


def _real(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array; raise for complex numbers, text, ragged lists and masks."""
    if np.ma.isMaskedArray(value):
        raise ValueError(f"{name} must not be a masked array, whose mask would be lost; fill it")
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.empty(0, object)
    if not np.can_cast(array.dtype, np.float64, "same_kind"):
        raise ValueError(f"{name} must be real numbers; got {value!r}")
    return array.astype(np.float64) if array.dtype == np.bool_ else array


def _refuse(rule: str, array: Numbers, valid: Numbers, quantity: str = "") -> NoReturn:
    """Raise ValueError for the first element of `array` that is not valid."""
    index = tuple(int(i) for i in np.argwhere(~valid)[0])
    location = f" at index {index}" if index else ""
    raise ValueError(f"{rule}; got {quantity}{array[index]}{location}")
