# SPDX-License-Identifier: Apache-2.0
"""Shapes of checked arguments: what broadcasts, which last axis is meant, and what is ambiguous."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mxeon.models.core.arrays import Array, Numbers
from mxeon.models.core.namespaces import array_namespace


def spread_pair(name: str, array: Numbers) -> Numbers:
    """Array of pairs, shape (..., 2), of which a number, or a last axis of 1, counts for both."""
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
    """Array with at least one axis."""
    return array if array.ndim else array[np.newaxis]


def refuse_ambiguous(name: str, color: Numbers, lead: tuple[int, ...]) -> None:
    """Raise ValueError for a list of N numbers beside N directions, unless it is red, green and blue."""
    if color.shape == lead and color.ndim == 1 and color.shape[0] not in (1, 3):
        count = color.shape[0]
        raise ValueError(
            f"{name} of shape ({count},) beside {count} directions has two meanings: write "
            f"{name}[:, np.newaxis] for a number for each direction, {name}[np.newaxis] for a "
            f"color of {count} channels"
        )


def lead_shape(vectors: Mapping[str, Numbers], numbers: Mapping[str, Numbers]) -> tuple[int, ...]:
    """Shape to which arguments broadcast, the last axis of `vectors` apart.

    - `vectors`: Directions, random numbers or colors by name: shapes (..., C).
    - `numbers`: The others: shapes (...).
    """
    arrays = [*vectors.values(), *numbers.values()]
    leads = [tuple(array.shape[:-1]) for array in vectors.values()]
    leads += [tuple(array.shape) for array in numbers.values()]
    try:
        return np.broadcast_shapes(*leads)
    except ValueError:
        names = ", ".join([*vectors, *numbers])
        apart = f" (last axis of {', '.join(vectors)} apart)" if vectors else ""
        shapes = ", ".join(str(tuple(array.shape)) for array in arrays)
        raise ValueError(f"{names} must broadcast{apart}; got shapes {shapes}") from None


def broadcastable(vectors: Mapping[str, Numbers], numbers: Mapping[str, Numbers]) -> list[Array]:
    """Checked vectors and numbers, in this order, whose shapes broadcast."""
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
