# SPDX-License-Identifier: Apache-2.0
"""Arguments checked, cosines of a pair of directions, and evaluation in blocks that fit a cache.

Directions leave the surface, in a local frame with the normal +z.
"""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

# Closed ranges of the quantities of the house, by name: least, largest, as printed.
RANGES = {
    "mu": (0.0, 1.0, "[0, 1]"),
    "rho": (0.0, 1.0, "[0, 1]"),
    "roughness": (0.0, 1.0, "[0, 1]"),
    "sigma": (0.0, 0.5 * np.pi, "[0, pi/2]"),
    "color": (0.0, 1.0, "[0, 1]"),
    "u": (0.0, np.nextafter(1.0, 0.0), "[0, 1)"),
}

# Largest error of the squared length of a direction: directions rounded to float32 pass.
UNIT_TOLERANCE = 1e-6

# Pairs per block: an array of them takes 256 KiB and stays in a second-level cache.
BLOCK = 2**15

# Blocks at a time: NumPy computes without the interpreter's lock. Four need less than 64 MiB.
WORKERS = min(4, os.cpu_count() or 1)


def checked(name, value):
    """Argument as an array of real numbers inside the range that its name has in `RANGES`.

    Parameters
    ----------
    name : str
        A key of `RANGES`.
    value : array_like
        What the caller gave.

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


def checked_directions(name, value):
    """Argument as an array of unit vectors on or above the horizon.

    Parameters
    ----------
    name : str
        What the error message calls it.
    value : array_like, shape (..., 3)
        What the caller gave.

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
    array = _directions(name, value)
    for block in blocks(array.shape[:-1]):
        if not _are_directions(*_channels_first(array[block])):
            _refuse_direction(name, array)
    return array


def cosines(wo, wi):
    """Cosines with the normal, and the part of the pair's cosine that lies in the surface.

        s = dot(wo, wi) - mu_o mu_i = wo.x wi.x + wo.y wi.y

    Parameters
    ----------
    wo, wi : ndarray, shape (..., 3)
        Unit vectors on or above the horizon.

    Returns
    -------
    mu_o, mu_i : ndarray, shape (...)
        Cosines, dimensionless, in [0, 1]: z, but 1 where a rounded direction has z > 1.
    s : ndarray, shape (...)
        Dimensionless, in [-1, 1] up to rounding; signed, never clamped.

    References
    ----------
    [Portsmouth2025], below Eq. (3).

    Examples
    --------
    >>> mu_o, mu_i, s = cosines(np.array([0.6, 0.0, 0.8]), np.array([-0.8, 0.0, 0.6]))
    >>> [round(float(x), 12) for x in (mu_o, mu_i, s)]
    [0.8, 0.6, -0.48]
    """
    s = wo[..., 0] * wi[..., 0] + wo[..., 1] * wi[..., 1]
    return np.minimum(wo[..., 2], 1.0), np.minimum(wi[..., 2], 1.0), s


def blocks(shape):
    """Indices that tile an array, each selecting at most about `BLOCK` elements.

    Parameters
    ----------
    shape : tuple of int
        Shape of the array.

    Yields
    ------
    tuple of slice
        One slice per axis, so that no axis is lost.

    Examples
    --------
    >>> list(blocks((2, BLOCK)))
    [(slice(0, 1, None), slice(None, None, None)), (slice(1, 2, None), slice(None, None, None))]
    """
    axis, inner = len(shape), 1
    while axis > 0 and inner * shape[axis - 1] <= BLOCK:
        axis -= 1
        inner *= shape[axis]
    whole = (slice(None),) * (len(shape) - axis)
    if axis == 0:
        yield whole
        return
    step = max(1, BLOCK // inner)
    for outer in np.ndindex(shape[: axis - 1]):
        for start in range(0, shape[axis - 1], step):
            yield (*(slice(i, i + 1) for i in outer), slice(start, start + step), *whole)


def lead_shape(vectors, numbers):
    """Shape to which arguments broadcast, without the last axis of those that have one of their own.

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
    shapes = [array.shape[:-1] for array in vectors.values()]
    shapes += [array.shape for array in numbers.values()]
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        names = ", ".join([*vectors, *numbers])
        apart = f" (last axis of {', '.join(vectors)} apart)" if vectors else ""
        shown = ", ".join(str(array.shape) for array in arrays)
        raise ValueError(f"{names} must broadcast{apart}; got shapes {shown}") from None


def evaluate(formula, wo, wi, rho, **parameter):
    """Values of a reflection formula over broadcast arguments, block by block.

    Parameters
    ----------
    formula : callable
        `formula(wo, wi, rho, *parameter)` for one block: directions (..., 3) with contiguous
        components, `rho` (C, ...), the parameter (...), all float64; returns (C, ...). Axes of
        length 1 stay so, and with them everything that depends on the material alone stays small.
    wo, wi : array_like, shape (..., 3)
        Directions, unit vectors on or above the horizon.
    rho : array_like, shape (..., C)
        Reflectance per channel, dimensionless, in [0, 1]; a number is one channel.
    **parameter : array_like, shape (...)
        At most one, under a name of `RANGES`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Beyond it and the arguments, memory does not grow with the number of pairs.

    Raises
    ------
    ValueError
        If an argument is out of range, or the shapes do not broadcast.

    Examples
    --------
    >>> evaluate(lambda wo, wi, rho: rho * wi[..., 2], [0, 0, 1], [0.6, 0, 0.8], [0.5, 1.0])
    array([0.4, 0.8])
    """
    arguments = {"wo": _directions("wo", wo), "wi": _directions("wi", wi)}
    arguments["rho"] = np.atleast_1d(checked("rho", rho))
    numbers = {name: checked(name, value) for name, value in parameter.items()}
    shape = lead_shape(arguments, numbers)
    arguments |= {name: array[..., np.newaxis] for name, array in numbers.items()}
    arrays = {name: _with_axes(array, len(shape) + 1) for name, array in arguments.items()}
    out = np.empty(shape + arrays["rho"].shape[-1:])

    def fill(block):
        parts = {name: _channels_first(_part(array, block)) for name, array in arrays.items()}
        wo, wi, rho, *rest = parts.values()
        for name in ("wo", "wi"):
            if not _are_directions(*parts[name]):
                _refuse_direction(name, arguments[name])
        value = formula(np.moveaxis(wo, 0, -1), np.moveaxis(wi, 0, -1), rho, *(a[0] for a in rest))
        for channel, values in enumerate(value):
            out[block][..., channel] = values

    _for_each(fill, list(blocks(shape)))
    return out


def _real(name, value):
    """`value` as an array; complex numbers, text, ragged lists and masks are refused."""
    if np.ma.isMaskedArray(value):
        raise ValueError(f"{name} must not be a masked array, whose mask would be lost; fill it")
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.empty(0, object)
    if not np.can_cast(array.dtype, np.float64, "same_kind"):
        raise ValueError(f"{name} must be real numbers; got {value!r}")
    return array


def _directions(name, value):
    """`value` as an array of real triples."""
    array = _real(name, value)
    if array.shape[-1:] != (3,):
        raise ValueError(f"{name} must have shape (..., 3); got shape {array.shape}")
    return array


def _are_directions(x, y, z):
    """Whether all are unit vectors on or above the horizon."""
    if not z.size:
        return True
    with np.errstate(over="ignore"):
        length = x * x + y * y + z * z
    unit = abs(length.min() - 1.0) <= UNIT_TOLERANCE and abs(length.max() - 1.0) <= UNIT_TOLERANCE
    return unit and z.min() >= 0.0


def _refuse(rule, array, good, what=""):
    """Raise for the first element of `array` that is not good."""
    index = tuple(int(i) for i in np.argwhere(~good)[0])
    place = f" at index {index}" if index else ""
    raise ValueError(f"{rule}; got {what}{array[index]}{place}")


def _refuse_direction(name, w):
    """Raise for the first direction that is below the horizon or else of the wrong length."""
    z = w[..., 2]
    if (z < 0.0).any():
        _refuse(f"{name} must not point below the horizon (z >= 0)", z, ~(z < 0.0), "z = ")
    with np.errstate(over="ignore"):
        length = np.sum(np.square(w, dtype=np.float64), axis=-1)
    unit = np.abs(length - 1.0) <= UNIT_TOLERANCE
    _refuse(f"{name} must be unit vectors to {UNIT_TOLERANCE}", length, unit, "squared length ")


def _for_each(work, items):
    """Do `work` for every item, on several cores where there are several items."""
    if len(items) == 1:
        work(items[0])
        return
    with ThreadPoolExecutor(WORKERS) as pool:
        list(pool.map(work, items))


def _with_axes(array, ndim):
    """`array` with leading axes of length 1, `ndim` axes in all."""
    return array.reshape((1,) * (ndim - array.ndim) + array.shape)


def _part(array, block):
    """Part of `array` that a block of its leading axes selects; an axis of length 1 stays."""
    return array[
        tuple(s if n > 1 else slice(None) for s, n in zip(block, array.shape[:-1], strict=True))
    ]


def _channels_first(array):
    """`array` with its last axis first, float64 and contiguous."""
    return np.ascontiguousarray(np.moveaxis(array, -1, 0), dtype=np.float64)
