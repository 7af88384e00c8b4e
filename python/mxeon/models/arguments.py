# SPDX-License-Identifier: Apache-2.0
"""Validation of arguments: ranges, directions and shapes.

Directions leave the surface, in a local frame with the normal +z.
"""

from collections.abc import Mapping
from typing import NoReturn

import numpy as np

from mxeon.models.arrays import ArrayLike, Numbers
from mxeon.models.tiling import blocks, channels_first

_LARGEST = float(np.finfo(np.float64).max)

# Closed ranges of the quantities, by name: least, largest, as printed.
RANGES = {
    "mu": (0.0, 1.0, "[0, 1]"),
    "rho": (0.0, 1.0, "[0, 1]"),
    "roughness": (0.0, 1.0, "[0, 1]"),
    "sigma": (0.0, 0.5 * np.pi, "[0, pi/2]"),
    "color": (0.0, 1.0, "[0, 1]"),
    "amount": (0.0, 1.0, "[0, 1]"),
    "weight": (0.0, _LARGEST, "[0, inf)"),
    "albedo": (-_LARGEST, _LARGEST, "(-inf, inf)"),
    "mu_o": (0.0, 1.0, "[0, 1]"),
    "mu_i": (0.0, 1.0, "[0, 1]"),
    "alpha": (0.0, 1.0, "[0, 1]"),
    "tint": (0.0, 1.0, "[0, 1]"),
    "color0": (0.0, 1.0, "[0, 1]"),
    "color82": (0.0, 1.0, "[0, 1]"),
    "color90": (0.0, 1.0, "[0, 1]"),
    "exponent": (0.0, 1e50, "[0, 1e50]"),  # these three end where a fourth power still fits
    "ior": (0.0, 1e50, "[0, 1e50]"),
    "extinction": (0.0, 1e50, "[0, 1e50]"),
    "radiance": (0.0, 1e50, "[0, 1e50]"),
    "intensity": (0.0, 1e50, "[0, 1e50]"),
    "exposure": (-1000.0, 1000.0, "[-1000, 1000]"),
    "opacity": (0.0, 1.0, "[0, 1]"),
    "inner_angle": (0.0, 360.0, "[0, 360]"),
    "outer_angle": (0.0, 360.0, "[0, 360]"),
    "absorption": (0.0, 1e50, "[0, 1e50]"),
    "scattering": (0.0, 1e50, "[0, 1e50]"),
    "distance": (0.0, 1e50, "[0, 1e50]"),
    "cos_theta": (-1.0, 1.0, "[-1, 1]"),
    "g": (-float(np.nextafter(1.0, 0.0)), float(np.nextafter(1.0, 0.0)), "(-1, 1)"),
    "anisotropy": (0.0, 1.0, "[0, 1]"),
    "glossiness": (0.0, 1.0, "[0, 1]"),
    "reflectivity": (0.0, float(np.nextafter(1.0, 0.0)), "[0, 1)"),
    "edge_color": (0.0, 1.0, "[0, 1]"),
    "temperature": (1.0, 1e9, "[1, 1e9]"),
    "wavelength": (1.0, 1e9, "[1, 1e9]"),
    "longitudinal": (0.0, 1.0, "[0, 1]"),
    "azimuthal": (0.0, 1.0, "[0, 1]"),
    "scale_tt": (0.0, 1e50, "[0, 1e50]"),
    "scale_trt": (0.0, 1e50, "[0, 1e50]"),
    "melanin_concentration": (0.0, float(np.nextafter(1.0, 0.0)), "[0, 1)"),
    "melanin_redness": (0.0, 1.0, "[0, 1]"),
    "eumelanin_color": (float(np.nextafter(0.0, 1.0)), 1.0, "(0, 1]"),
    "pheomelanin_color": (float(np.nextafter(0.0, 1.0)), 1.0, "(0, 1]"),
    "hair_color": (float(np.nextafter(0.0, 1.0)), 1.0, "(0, 1]"),
    "azimuthal_roughness": (0.0, 1.0, "[0, 1]"),
    "thinfilm_thickness": (0.0, 1e9, "[0, 1e9]"),  # nm
    "thinfilm_ior": (1.0, 1e50, "[1, 1e50]"),
    **dict.fromkeys(("tint_R", "tint_TT", "tint_TRT"), (0.0, 1.0, "[0, 1]")),
    "variance": (1e-12, 1e12, "[1e-12, 1e12]"),  # where exponents and squares still fit
    "scale": (1e-12, 1e12, "[1e-12, 1e12]"),
    **dict.fromkeys(
        ("roughness_R", "roughness_TT", "roughness_TRT"), (1e-12, 1e12, "[1e-12, 1e12]")
    ),
    "cuticle_angle": (0.0, 1.0, "[0, 1]"),
    "absorption_coefficient": (0.0, 1e50, "[0, 1e50]"),
    "x": (0.0, _LARGEST, "[0, inf)"),
    "theta": (-0.5 * np.pi, 0.5 * np.pi, "[-pi/2, pi/2]"),
    "phi": (-_LARGEST, _LARGEST, "(-inf, inf)"),
    "reflectance": (0.0, 1.0, "[0, 1]"),
    "transmittance": (0.0, 1.0, "[0, 1]"),
    "single_scatter": (0.0, 1.0, "[0, 1]"),
    "scatter_anisotropy": (-1.0, 1.0, "[-1, 1]"),
    "separation": (float(np.nextafter(0.0, 1.0)), _LARGEST, "(0, inf)"),
    "radius": (float(np.nextafter(0.0, 1.0)), _LARGEST, "(0, inf)"),
    "u": (0.0, float(np.nextafter(1.0, 0.0)), "[0, 1)"),
}

# Largest error of the squared length of a direction: directions rounded to float32 pass.
UNIT_TOLERANCE = 1e-6


def checked(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of real numbers inside the range that its name has in `RANGES`.

    Parameters
    ----------
    name : str
        A key of `RANGES`.
    value : array_like
        The caller's argument.

    Returns
    -------
    ndarray
        `value`, in the precision in which it came.

    Raises
    ------
    ValueError
        If an element is no real number or leaves the range; names it, and NaN leaves every range.
        A masked array is refused, for the result could not keep its mask.

    Examples
    --------
    >>> checked("roughness", [0.5, 1.2])
    Traceback (most recent call last):
    ...
    ValueError: roughness must lie in [0, 1]; got 1.2 at index (1,)
    """
    array = _real(name, value)
    low, high, interval = RANGES[name]
    if array.size and not (array.min() >= low and array.max() <= high):
        _refuse(f"{name} must lie in {interval}", array, (array >= low) & (array <= high))
    return array


def checked_directions(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of unit vectors on or above the horizon.

    Parameters
    ----------
    name : str
        Name of the argument in the error message.
    value : array_like, shape (..., 3)
        The caller's argument.

    Returns
    -------
    ndarray, shape (..., 3)
        `value`, in the precision in which it came.

    Raises
    ------
    ValueError
        If the last axis is not 3, a squared length differs from 1 by more than `UNIT_TOLERANCE`,
        or a direction points below the horizon; names the first such element.

    Examples
    --------
    >>> checked_directions("wo", [0.0, 0.6, -0.8])
    Traceback (most recent call last):
    ...
    ValueError: wo must not point below the horizon (z >= 0); got z = -0.8
    """
    array = checked_triples(name, value)
    for block in blocks(array.shape[:-1]):
        if not are_directions(channels_first(array[block])):
            refuse_direction(name, array)
    return array


def checked_transmitted(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 3), none of whose directions points above the horizon."""
    array = checked_triples(name, value)
    z = array[..., 2]
    if (z > 0.0).any():
        _refuse(f"{name} must not point above the horizon (z <= 0)", z, ~(z > 0.0), "z = ")
    return array


def checked_sphere(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 3) of unit vectors, on either side of the surface."""
    array = checked_triples(name, value)
    mirrored = np.concatenate([array[..., :2], np.abs(array[..., 2:])], axis=-1)
    if not are_directions(np.moveaxis(mirrored, -1, 0)):
        refuse_direction(name, mirrored)
    """Argument of shape (..., 3), of unit vectors on either side of the horizon."""
    array = checked_triples(name, value)
    checked_directions(name, array * np.where(array[..., 2:] < 0.0, [1.0, 1.0, -1.0], 1.0))
    return array


def checked_triples(name: str, value: ArrayLike) -> Numbers:
    """Argument as an array of shape (..., 3), whose lengths are not looked at."""
    array = _real(name, value)
    if array.shape[-1:] != (3,):
        raise ValueError(f"{name} must have shape (..., 3); got shape {array.shape}")
    return array


def checked_pairs(name: str, value: ArrayLike) -> Numbers:
    """Argument of shape (..., 2) inside the range that its name has in `RANGES`."""
    array = checked(name, value)
    if array.shape[-1:] != (2,):
        raise ValueError(f"{name} must have shape (..., 2); got shape {array.shape}")
    return array


def are_directions(components: Numbers) -> bool:
    """Whether all vectors of shape (3, ...) are unit and on or above the horizon."""
    x, y, z = components
    if not z.size:
        return True
    with np.errstate(over="ignore"):
        length = x * x + y * y + z * z
    unit = abs(length.min() - 1.0) <= UNIT_TOLERANCE and abs(length.max() - 1.0) <= UNIT_TOLERANCE
    return bool(unit and z.min() >= 0.0)


def refuse_direction(name: str, w: Numbers) -> NoReturn:
    """Raise for the first direction that is below the horizon or else of the wrong length."""
    z = w[..., 2]
    if (z < 0.0).any():
        _refuse(f"{name} must not point below the horizon (z >= 0)", z, ~(z < 0.0), "z = ")
    with np.errstate(over="ignore"):
        length = np.sum(np.square(w, dtype=np.float64), axis=-1)
    unit = np.abs(length - 1.0) <= UNIT_TOLERANCE
    _refuse(f"{name} must be unit vectors to {UNIT_TOLERANCE}", length, unit, "squared length ")


def lead_shape(vectors: Mapping[str, Numbers], numbers: Mapping[str, Numbers]) -> tuple[int, ...]:
    """Shape to which arguments broadcast, the last axis of `vectors` apart.

    Parameters
    ----------
    vectors : dict of str to ndarray
        Directions, random numbers or colors by name: shapes (..., C).
    numbers : dict of str to ndarray
        The others: shapes (...).

    Returns
    -------
    tuple of int

    Raises
    ------
    ValueError
        If they do not broadcast; names them and their shapes.

    Examples
    --------
    >>> lead_shape({"wo": np.zeros((4, 3))}, {"roughness": np.zeros(5)})
    Traceback (most recent call last):
    ...
    ValueError: wo, roughness must broadcast (last axis of wo apart); got shapes (4, 3), (5,)
    """
    arrays = [*vectors.values(), *numbers.values()]
    leads = [array.shape[:-1] for array in vectors.values()]
    leads += [array.shape for array in numbers.values()]
    try:
        return np.broadcast_shapes(*leads)
    except ValueError:
        names = ", ".join([*vectors, *numbers])
        apart = f" (last axis of {', '.join(vectors)} apart)" if vectors else ""
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise ValueError(f"{names} must broadcast{apart}; got shapes {shapes}") from None


def channel_count(colors: Mapping[str, Numbers]) -> int:
    """Number of channels to which colors of shape (..., C) broadcast.

    Raises
    ------
    ValueError
        If they do not; names them and their numbers of channels.
    """
    counts = [int(color.shape[-1]) for color in colors.values()]
    largest = max(counts)
    if any(count not in (1, largest) for count in counts):
        raise ValueError(
            f"{', '.join(colors)} must have equal numbers of channels; got {', '.join(map(str, counts))}"
        )
    return largest


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
    return array


def _refuse(rule: str, array: Numbers, valid: Numbers, quantity: str = "") -> NoReturn:
    """Raise ValueError for the first element of `array` that is not valid."""
    index = tuple(int(i) for i in np.argwhere(~valid)[0])
    location = f" at index {index}" if index else ""
    raise ValueError(f"{rule}; got {quantity}{array[index]}{location}")
