# SPDX-License-Identifier: Apache-2.0
"""Tiling of large arrays into blocks that fit a cache."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mxeon.models.core.arrays import Array, Numbers

# Pairs per block: an array of them takes 256 KiB and stays in a second-level cache.
BLOCK = 2**15


def blocks(shape: tuple[int, ...], size: int = BLOCK) -> Iterator[tuple[slice, ...]]:
    """Indices that tile an array, each selecting at most about `size` elements.

    - `shape`: Shape of the array.
    - `size`: Elements per block.
    """
    # Take as many inner axes as fit into a block.
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
    """Part of `array` that a block of its leading axes selects, with the last axis first.

    `block` has one slice per axis but the last. An axis of length 1, which broadcasts, stays whole.
    """
    axes = zip(block, array.shape[:-1], strict=True)
    part = array[tuple(index if length > 1 else slice(None) for index, length in axes)]
    return channels_first(part)


def channels_first(array: Numbers) -> Array:
    """Array with its last axis first, float64 and contiguous."""
    return np.ascontiguousarray(np.moveaxis(array, -1, 0), dtype=np.float64)


def with_axes(array: Numbers, ndim: int) -> Numbers:
    """Array with leading axes of length 1, `ndim` axes in all.

    An axis but the last along which it was broadcast has length 1 again.
    """
    *strides, _ = array.strides
    narrow = array[tuple(slice(None if stride else 1) for stride in strides)]
    return narrow.reshape((1,) * (ndim - array.ndim) + narrow.shape)
