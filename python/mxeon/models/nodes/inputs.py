# SPDX-License-Identifier: Apache-2.0
"""Inputs of a model in a call: bound to its parameters, checked, and laid out in rows of pairs."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from mxeon.models.core.arguments import checked
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import root
from mxeon.models.core.namespaces import any_array, array_namespace, library
from mxeon.models.core.shapes import refuse_ambiguous, spread_pair
from mxeon.models.nodes.parameters import WEIGHT, Parameter


@dataclass(frozen=True)
class Rows:
    """Vectors and inputs of a call in rows.

    - `inputs`: (N,), (N, 2) or (N, C) by parameter; 1 instead of N where all pairs have the same.
    """

    lead: tuple[int, ...]  # shape of the pairs
    vectors: list[Array]  # directions or random numbers
    inputs: dict[str, Array]
    colored: bool  # whether a color has an axis of channels
    weight: Array | None = None  # of the lobe, where the call has one

    def shaped(self, values: Array, last: tuple[int, ...] = ()) -> Array:
        """Values of the rows, (N, *last) or fewer, in the shape of the pairs."""
        xp, count = array_namespace(values), int(np.prod(self.lead))
        return xp.reshape(xp.broadcast_to(values, (count, *last)), (*self.lead, *last))[()]

    def colors(self, values: Array) -> Array:
        """Values of the rows, (N, C), times the weight; without channels where no color has any."""
        if self.weight is not None:
            values = values * self.weight[:, np.newaxis]
        values = self.shaped(values, tuple(values.shape[-1:]))
        return values if self.colored or values.shape[-1] != 1 else values[..., 0]


def bound_inputs(
    parameters: Sequence[Parameter], inputs: Sequence[ArrayLike], named: Mapping[str, ArrayLike]
) -> dict[str, ArrayLike]:
    """A value for each parameter, by name: one of the call's, or its default."""
    names = [each.name for each in parameters]
    others = {each.quantity: each.name for each in parameters}
    known = f"inputs are {', '.join(names)}"
    if len(inputs) > len(names):
        raise TypeError(f"{known}; got {len(inputs)} of them")
    values = dict(zip(names, inputs, strict=False))
    for word, value in named.items():
        name = others.get(word, word)
        if name not in names or name in values:
            raise TypeError(f"{known}; got {word!r}{' twice' if name in names else ''}")
        values[name] = value
    return {each.name: values.get(each.name, each.default) for each in parameters}


@any_array
def rows(
    parameters: Sequence[Parameter], vectors: Collection[str], /, **arguments: ArrayLike
) -> Rows:
    """Vectors (..., K) and a value for each parameter in rows, all by their names."""
    directions = {name: _floats(arguments[name]) for name in vectors}
    lead = _lead(directions, {})
    arrays, colored = {}, False
    for each in parameters:
        array = _floats(checked(each.name, arguments[each.name], each.quantity))
        if each.channels == 3:
            refuse_ambiguous(each.name, array, lead)
            colored = colored or array.ndim > 0
            array = array if array.ndim else array[np.newaxis]
        arrays[each.name] = spread_pair(each.name, array) if each.channels == 2 else array
    # Lay out all pairs in one row; what is the same for all of them stays one.
    channels = {each.name: each.channels for each in parameters}
    lead = _lead(directions, {n: (a, channels[n]) for n, a in arrays.items()})
    laid = {name: _laid(a, lead, bool(channels[name])) for name, a in arrays.items()}
    weight = laid.pop(WEIGHT.name, None)
    found = [_laid(v, lead, True, whole=True) for v in directions.values()]
    return Rows(lead, found, laid, colored, weight)


@any_array
def views(mu: ArrayLike, azimuth: ArrayLike) -> Array:
    """Directions with these cosines and azimuths, shape (..., 3)."""
    cosine, phi = _floats(checked("mu", mu)), _floats(checked("phi", azimuth))
    xp = array_namespace(cosine, phi)
    sine = root((1.0 - cosine) * (1.0 + cosine))
    x, y = sine * xp.cos(phi), sine * xp.sin(phi)
    return xp.stack([x, y, xp.broadcast_to(cosine, x.shape)], axis=-1)


def _floats(value: ArrayLike) -> Array:
    """Numbers in float64; another library's array as it is."""
    return cast(Array, value) if library(value) else np.asarray(value, np.float64)


def _lead(
    directions: Mapping[str, Array], arrays: Mapping[str, tuple[Array, int]]
) -> tuple[int, ...]:
    """Shape to which all broadcast but their last axes."""
    shapes = {name: tuple(array.shape[:-1]) for name, array in directions.items()}
    shapes |= {
        n: tuple(a.shape[:-1] if channels else a.shape) for n, (a, channels) in arrays.items()
    }
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items() if shape)
        raise ValueError(f"shapes must broadcast, last axes apart; got {listed}") from None


def _laid(array: Array, lead: tuple[int, ...], last: bool, whole: bool = False) -> Array:
    """An array as (N, last) or (N,), or as (1, last) or (1,) where it is one for all pairs."""
    xp = array_namespace(array)
    tail = tuple(array.shape[-1:]) if last else ()
    own = array.shape[:-1] if last else array.shape
    if not whole and int(np.prod(own)) == 1:
        return xp.reshape(array, (1, *tail))
    return xp.reshape(xp.broadcast_to(array, (*lead, *tail)), (-1, *tail))
