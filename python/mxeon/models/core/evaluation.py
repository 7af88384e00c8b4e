# SPDX-License-Identifier: Apache-2.0
"""Evaluation of reflection formulas over broadcast arguments, in cache-sized blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from mxeon.models.core import arguments
from mxeon.models.core.arrays import NUMPY, Array, ArrayLike, Numbers, array_namespace


def evaluate(
    formula: Callable[..., Array],
    wo: ArrayLike,
    wi: ArrayLike,
    rho: ArrayLike,
    name: str = "rho",
    /,
    **parameter: ArrayLike,
) -> Array:
    """Values (..., C) of a reflection formula for arguments that broadcast, computed in blocks.

    - `formula`: `formula(wo, wi, rho, *parameter)` computes one block, (C, ...). All arguments are
      float64: directions (..., 3) with contiguous components, `rho` (C, ...) and the parameter
      (...). Axes of length 1 are not expanded, so arrays that depend only on the material stay
      small.
    - `rho` (..., C): N numbers with N directions are rejected as ambiguous, unless N is 1 or 3.
    - `name`: Name of `rho` in `RANGES` and in messages.
    - `**parameter` (...): At most one further argument, whose name is a key of `RANGES`.
    """
    pair = {"wo": arguments.checked_triples("wo", wo), "wi": arguments.checked_triples("wi", wi)}
    color, numbers = (
        arguments.with_axis(arguments.checked(name, rho)),
        arguments.checked_all(parameter),
    )
    arguments.refuse_ambiguous(name, color, arguments.lead_shape(pair | {name: color}, numbers))
    xp = array_namespace(*pair.values(), color, *numbers.values())
    if xp is not NUMPY:
        pair = {name: arguments.checked_directions(name, w) for name, w in pair.items()}

    # Directions in NumPy arrays are checked in each block, while the block is in the cache.
    def value(rho: Array, wo: Array, wi: Array, **rest: Array) -> Array:
        parts = {"wo": wo, "wi": wi}
        if xp is NUMPY:
            for name, w in parts.items():
                if not arguments.are_directions(w):
                    arguments.refuse_direction(name, pair[name])
            parts = {name: arguments.on_horizon(w) for name, w in parts.items()}
        order = (*range(1, wo.ndim), 0)  # moves components to the last axis
        last = (xp.permute_dims(w, order) for w in parts.values())
        return formula(*last, rho, *rest.values())

    return evaluate_material(value, pair | {"rho": color}, numbers, color.shape[-1])


def evaluate_material(
    formula: Callable[..., Array],
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    channels: int,
    size: int = arguments.BLOCK,
) -> Array:
    """Values (..., channels) of a formula for checked arguments that broadcast, computed in blocks.

    - `formula`: `formula(**given)` computes one block, (channels, ...). All arguments are float64:
      vectors (C, ...), with components on the first axis, and numbers (...). Axes of length 1 are
      not expanded.
    - `vectors`: Arguments with components, (..., C): directions, colors and pairs.
    - `numbers`: Arguments without components, (...).
    - `size`: Elements per block; choose fewer for formulas with many temporaries per element.
    """
    shape = arguments.lead_shape(vectors, numbers)
    if array_namespace(*vectors.values(), *numbers.values()) is not NUMPY:
        # Channels are the first axis of the formula's value and the last axis of the result. A
        # formula that is constant may return a NumPy array.
        axes, parts = len(shape), dict[str, Array]()
        for name, array in vectors.items():
            xp, wide = array_namespace(array), (1,) * (axes + 1 - array.ndim) + tuple(array.shape)
            parts[name] = xp.permute_dims(xp.reshape(array, wide), (axes, *range(axes)))
        values = formula(**parts, **numbers)
        xp = array_namespace(values)
        return xp.permute_dims(
            xp.broadcast_to(values, (channels, *shape)), (*range(1, axes + 1), 0)
        )
    columns = {**vectors, **{name: array[..., np.newaxis] for name, array in numbers.items()}}
    arrays = {name: arguments.with_axes(array, len(shape) + 1) for name, array in columns.items()}
    out = np.empty((*shape, channels))

    for block in arguments.blocks(shape, size):
        parts = {name: arguments.tile(array, block) for name, array in arrays.items()}
        values = formula(
            **{name: parts[name][0] if name in numbers else parts[name] for name in parts}
        )
        # Copying channel by channel takes a quarter of the time of one transposed copy.
        for channel, value in enumerate(np.broadcast_to(values, (channels, *values.shape[1:]))):
            out[block][..., channel] = value
    return out


def evaluate_number(
    formula: Callable[..., Array],
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    size: int = arguments.BLOCK,
) -> Array:
    """Values (...) of a formula without channels, computed in blocks."""
    values = evaluate_material(
        lambda **given: formula(**given)[np.newaxis], vectors, numbers, 1, size
    )
    return values[..., 0][()]
