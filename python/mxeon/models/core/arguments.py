# SPDX-License-Identifier: Apache-2.0
"""Checks of arguments (ranges, shapes, directions, choices). Arrays are divided into blocks.

Directions point away from the surface, in a local frame whose normal is +z.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NoReturn, cast

import numpy as np

from mxeon.models.core.arrays import (
    Array,
    ArrayLike,
    Numbers,
    array_namespace,
    host_values,
    library,
)
from mxeon.names import NONE, unknown

_LARGEST = float(np.finfo(np.float64).max)

# Smallest and largest valid value of each range, and the notation of the range in messages.
_BELOW_ONE, _ABOVE_ZERO = float(np.nextafter(1.0, 0.0)), float(np.nextafter(0.0, 1.0))
_SHARE = (0.0, 1.0, "[0, 1]")
_POSITIVE = (0.0, 1e50, "[0, 1e50]")  # fourth powers fit into float64
_WIDTH = (1e-12, 1e12, "[1e-12, 1e12]")  # arguments of exp and squares fit into float64
_LENGTH = (1e-150, 1e150, "[1e-150, 1e150]")  # products and quotients fit into float64

# A value outside a range in CLOSED by less than a rounding of float32 is clamped.
CLOSED = ("[0, 1]", "[0.01, 1]", "[1, 4]", "[-1, 1]", "[0, pi/2]")
ROUNDING = 2.0**-23
# Tolerance of the squared length of a direction. Directions rounded to float32 are accepted.
UNIT_TOLERANCE = 1e-6
BLOCK = 2**15  # direction pairs per block, since an array of 256 KiB fits into the L2 cache


class Ranges(dict[str, tuple[float, float, str]]):
    """Valid ranges of quantities, by the name of the quantity."""

    def __missing__(self, name: str) -> tuple[float, float, str]:
        raise LookupError(f"{name!r} must have a range in {__name__}: add its row to RANGES")


RANGES = Ranges(
    (name, ends)
    for names, ends in (
        ("mu mu_o mu_i", _SHARE),
        ("rho color color0 color82 color90 tint tint_R tint_TT tint_TRT edge_color", _SHARE),
        ("roughness alpha anisotropy glossiness longitudinal azimuthal", _SHARE),
        ("azimuthal_roughness cuticle_angle amount opacity melanin_redness", _SHARE),
        ("reflectance transmittance", _SHARE),
        ("u reflectivity melanin_concentration", (0.0, _BELOW_ONE, "[0, 1)")),
        ("eumelanin_color pheomelanin_color hair_color", (_ABOVE_ZERO, 1.0, "(0, 1]")),
        ("exponent ior extinction absorption scattering absorption_coefficient", _POSITIVE),
        ("radiance base emission scattered light distance", _POSITIVE),
        ("scale_tt scale_trt", _POSITIVE),
        ("coat_alpha", (0.01, 1.0, "[0.01, 1]")),
        ("coat_ior", (1.0, 4.0, "[1, 4]")),
        ("thinfilm_ior film_ior", (1.0, 1e50, "[1, 1e50]")),
        ("thinfilm_thickness thickness", (0.0, 1e9, "[0, 1e9]")),  # unit: nm
        ("temperature", (1.0, 1e9, "[1, 1e9]")),
        ("variance scale roughness_R roughness_TT roughness_TRT", _WIDTH),
        ("radius reach", _LENGTH),
        ("weight x", (0.0, _LARGEST, "[0, inf)")),
        ("albedo phi", (-_LARGEST, _LARGEST, "(-inf, inf)")),
        ("cos_theta", (-1.0, 1.0, "[-1, 1]")),
        ("g", (-_BELOW_ONE, _BELOW_ONE, "(-1, 1)")),
        ("inner_angle outer_angle", (0.0, 360.0, "[0, 360]")),
        ("sigma", (0.0, 0.5 * np.pi, "[0, pi/2]")),
    )
    for name in names.split()
)


def spread_pair(name: str, array: Numbers) -> Numbers:
    """Array of pairs, shape (..., 2). A number or a last axis of length 1 is repeated."""
    array = with_axis(array)
    if array.shape[-1] == 1:
        return array_namespace(array).broadcast_to(array, (*array.shape[:-1], 2))
    if array.shape[-1] != 2:
        raise ValueError(
            f"{name} must be a number or have shape (..., 2); got shape {tuple(array.shape)}: "
            f"write {name}[..., np.newaxis] for a number for each direction"
        )
    return array


def with_axis(array: Numbers) -> Numbers:
    """Array with at least one axis; a number gets shape (1,)."""
    return array if array.ndim else array[np.newaxis]


def refuse_ambiguous(name: str, color: Numbers, lead: tuple[int, ...]) -> None:
    """Raise ValueError if N numbers could be one color or a value for each of N directions."""
    if color.shape == lead and color.ndim == 1 and color.shape[0] not in (1, 3):
        count = color.shape[0]
        raise ValueError(
            f"{name} of shape ({count},) with {count} directions is ambiguous: write "
            f"{name}[:, np.newaxis] for a number for each direction, {name}[np.newaxis] for a "
            f"color of {count} channels"
        )


def lead_shape(vectors: Mapping[str, Numbers], numbers: Mapping[str, Numbers]) -> tuple[int, ...]:
    """Shape to which all arguments broadcast, without the last axis (C) of `vectors`."""
    leads = {name: tuple(array.shape[:-1]) for name, array in vectors.items()}
    leads |= {name: tuple(array.shape) for name, array in numbers.items()}
    try:
        return np.broadcast_shapes(*leads.values())
    except ValueError:
        counts = (
            f"{name} has {' x '.join(map(str, lead))} {'rows' if name in vectors else 'values'}"
            for name, lead in leads.items()
            if set(lead) - {1}
        )
        raise ValueError(f"{', '.join(counts)}; give equal counts, or one") from None


def broadcastable(vectors: Mapping[str, Numbers], numbers: Mapping[str, Numbers]) -> list[Array]:
    """All vectors, followed by all numbers. Raises ValueError if the shapes do not broadcast."""
    lead_shape(vectors, numbers)
    return [*vectors.values(), *numbers.values()]


def channel_count(colors: Mapping[str, Numbers]) -> int:
    """Number of channels to which colors of shape (..., C) broadcast."""
    counts = [int(color.shape[-1]) for color in colors.values()]
    largest = max(counts)
    if any(count not in (1, largest) for count in counts):
        raise ValueError(
            f"{', '.join(colors)} must have equal numbers of channels; got {', '.join(map(str, counts))}"
        )
    return largest


def blocks(shape: tuple[int, ...], size: int = BLOCK) -> Iterator[tuple[slice, ...]]:
    """Slices that divide an array into blocks of at most about `size` elements."""
    # The elements of all axes from `axis` to the last fit into one block.
    axis, inner = len(shape), 1
    while axis > 0 and inner * shape[axis - 1] <= size:
        axis -= 1
        inner *= shape[axis]
    whole = (slice(None),) * (len(shape) - axis)
    if axis == 0:
        yield whole
        return
    step = max(1, size // inner)
    for outer in np.ndindex(shape[: axis - 1]):
        for start in range(0, shape[axis - 1], step):
            yield (*(slice(i, i + 1) for i in outer), slice(start, start + step), *whole)


def tile(array: Numbers, block: tuple[slice, ...]) -> Array:
    """A block of an array, with the last axis moved to the front. Axes of length 1 are kept."""
    axes = zip(block, array.shape[:-1], strict=True)
    part = array[tuple(index if length > 1 else slice(None) for index, length in axes)]
    return channels_first(part)


def channels_first(array: Numbers) -> Array:
    """Array with its last axis first, float64 and contiguous."""
    return np.ascontiguousarray(np.moveaxis(array, -1, 0), dtype=np.float64)


def with_axes(array: Numbers, ndim: int) -> Numbers:
    """Array with `ndim` axes. Missing axes, and broadcast axes except the last, have length 1."""
    *strides, _ = array.strides
    narrow = array[tuple(slice(None if stride else 1) for stride in strides)]
    return narrow.reshape((1,) * (ndim - array.ndim) + narrow.shape)


def checked(name: str, value: ArrayLike, quantity: str = "") -> Numbers:
    """Argument as an array of real numbers in the range of `quantity`."""

    def in_range(array: Numbers) -> Numbers:
        low, high, interval = RANGES[quantity or name]
        # The comparison uses float64, because the ends of a range may be infinite as half floats.
        if not array.size or (float(array.min()) >= low and float(array.max()) <= high):
            return array
        beyond = ROUNDING if interval in CLOSED else 0.0
        wide = np.asarray(array, np.float64)
        valid = (wide >= low - beyond) & (wide <= high + beyond)
        if not valid.all():
            _refuse(f"{name} must lie in {interval}", array, valid)
        return np.where(valid, np.clip(array, low, high), array)

    return _array(name, value, in_range)


def checked_real(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of real numbers, without a check of the range."""
    return _array(name, value, lambda array: array)


def checked_all(values: Mapping[str, ArrayLike]) -> dict[str, Numbers]:
    """Arguments as arrays. Values must lie in the argument's range."""
    return {name: checked(name, value) for name, value in values.items()}


def checked_vectors(values: Mapping[str, ArrayLike]) -> dict[str, Numbers]:
    """Arguments as arrays with at least one axis. Values must lie in the argument's range."""
    return {name: with_axis(value) for name, value in checked_all(values).items()}


def checked_numbers(**values: ArrayLike) -> list[Array]:
    """Arguments as float64 arrays that broadcast. Values must lie in the argument's range."""
    return broadcastable({}, checked_all(values))


def checked_color(name: str, value: ArrayLike) -> Numbers:
    """Argument as a color of at least one channel. Values must lie in the argument's range."""
    color = with_axis(checked(name, value))
    if not color.shape[-1]:
        raise ValueError(f"{name} must have at least one channel; got shape {tuple(color.shape)}")
    return color


def checked_rgb(name: str, value: ArrayLike) -> Numbers:
    """Argument as an RGB color in the argument's range. A single channel is repeated."""
    color = checked_color(name, value)
    if color.shape[-1] not in (1, 3):
        raise ValueError(f"{name} must have 1 or 3 channels; got shape {tuple(color.shape)}")
    return array_namespace(color).broadcast_to(color, (*color.shape[:-1], 3))


def checked_colors(
    colors: Mapping[str, ArrayLike], **numbers: ArrayLike
) -> tuple[list[Array], list[Array]]:
    """Checked colors (..., C) and numbers (..., 1) as float64 arrays that broadcast."""
    vectors = {name: checked_color(name, value) for name, value in colors.items()}
    values = broadcastable(vectors, checked_all(numbers))
    channel_count(vectors)
    return values[: len(colors)], [value[..., np.newaxis] for value in values[len(colors) :]]


def checked_switch(name: str, value: bool) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False; got {value!r}")
    return bool(value)


def checked_choice(
    name: str,
    value: str,
    known: Iterable[str],
    titles: Mapping[str, str] = NONE,
    listing: str = "",
) -> str:
    """Argument that must be one of the names in `known`. Raises ValueError for any other name."""
    if message := unknown(name, value, known, titles, listing):
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
    """Argument as unit vectors on or below the horizon, (..., 3)."""

    def below(array: Numbers) -> Numbers:
        z = array[..., 2]
        if (z > ROUNDING).any():
            _refuse(f"{name} must not point above the horizon (z <= 0)", z, ~(z > ROUNDING), "z = ")
        return -on_horizon(-checked_sphere(name, array), -1)

    return _array(name, checked_triples(name, value), below)


def checked_sphere(name: str, value: ArrayLike) -> Numbers:
    """Argument as unit vectors on either side of the surface, (..., 3)."""

    def unit(array: Numbers) -> Numbers:
        checked_directions(name, np.concatenate([array[..., :2], np.abs(array[..., 2:])], axis=-1))
        return array

    return _array(name, checked_triples(name, value), unit)


def checked_triples(name: str, value: ArrayLike) -> Numbers:
    """Argument as vectors of any length, (..., 3)."""
    return _with_components(name, checked_real(name, value), 3)


def checked_pairs(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 2). Values must lie in the argument's range."""
    return _with_components(name, checked(name, value), 2)


def _with_components(name: str, array: Numbers, count: int) -> Numbers:
    if array.shape[-1:] != (count,):
        raise ValueError(f"{name} must have shape (..., {count}); got shape {tuple(array.shape)}")
    return array


def checked_roughness(value: ArrayLike) -> Numbers:
    """alpha along tangent and bitangent in [0, 1], shape (..., 2). A single number is repeated."""
    return spread_pair("roughness", checked("roughness", value))


def are_directions(components: Numbers) -> bool:
    """Whether all vectors of shape (3, ...) are unit vectors on or above the horizon."""
    x, y, z = components
    if not z.size:
        return True
    with np.errstate(over="ignore"):
        length = x * x + y * y + z * z
    unit = abs(length.min() - 1.0) <= UNIT_TOLERANCE and abs(length.max() - 1.0) <= UNIT_TOLERANCE
    return bool(unit and z.min() >= -ROUNDING)


def on_horizon(w: Numbers, axis: int = 0) -> Numbers:
    """Directions with components on `axis`. A z that is negative only by rounding is set to 0."""
    z = w.take(2, axis)
    if not z.size or z.min() >= 0.0:
        return w
    below = np.moveaxis(np.array(w), axis, 0)
    below[2] = np.where(z >= -ROUNDING, np.maximum(z, 0.0), z)
    return np.moveaxis(below, 0, axis)


def refuse_direction(name: str, w: Numbers) -> NoReturn:
    """Raise ValueError for the first direction that is below the horizon or not a unit vector."""
    z = w[..., 2]
    if (z < -ROUNDING).any():
        _refuse(f"{name} must not point below the horizon (z >= 0)", z, ~(z < -ROUNDING), "z = ")
    with np.errstate(over="ignore"):
        length = np.sum(np.square(w, dtype=np.float64), axis=-1)
    unit = np.abs(length - 1.0) <= UNIT_TOLERANCE
    _refuse(f"{name} must be unit vectors within {UNIT_TOLERANCE}", length, unit, "squared length ")


def _array(name: str, value: ArrayLike, check: Callable[[Numbers], Numbers]) -> Numbers:
    """Argument as a checked float64 array. An array of another library is returned unchanged."""
    if not library(value):
        return np.asarray(check(_real(name, value)), np.float64)
    if (values := host_values(value)) is not None:
        check(_real(name, values))
    return cast(Numbers, value)


def _real(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array. Raises ValueError for complex numbers, text, ragged or masked arrays."""
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
    index = tuple(int(i) for i in np.argwhere(~valid)[0])
    location = f" at index {index}" if valid.size > 1 else ""
    raise ValueError(f"{rule}; got {quantity}{array[index]}{location}")
