# SPDX-License-Identifier: Apache-2.0
"""Inputs of a model in a call: bound to its parameters, checked, and laid out in rows of pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mxeon.models.core.arguments import checked, refuse_ambiguous, spread_pair
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.nodes.parameters import Parameter


@dataclass(frozen=True)
class Rows:
    """Vectors and inputs of a call in rows.

    Attributes
    ----------
    lead : tuple of int
        Shape of the pairs.
    vectors : list of ndarray, shape (N, K)
        Directions or random numbers.
    inputs : dict of str to ndarray
        (N,), (N, 2) or (N, C) by parameter; 1 in place of N where all pairs have the same.
    colored : bool
        Whether a color has an axis of channels.
    """

    lead: tuple[int, ...]
    vectors: list[Array]
    inputs: dict[str, Array]
    colored: bool

    def shaped(self, values: Array, last: tuple[int, ...] = ()) -> Array:
        """Values of the rows, (N, *last) or fewer, in the shape of the pairs."""
        count = int(np.prod(self.lead))
        return np.broadcast_to(values, (count, *last)).reshape((*self.lead, *last))[()]


def bound_inputs(
    parameters: Sequence[Parameter], inputs: Sequence[ArrayLike], named: Mapping[str, ArrayLike]
) -> dict[str, ArrayLike]:
    """A value for each parameter, by name: one of the call's, or its default.

    Raises
    ------
    TypeError
        If an input is unknown or has two values; lists the names.
    """
    # Take inputs by their place.
    names = [each.name for each in parameters]
    others = {each.quantity: each.name for each in parameters}
    known = f"inputs are {', '.join(names)}"
    if len(inputs) > len(names):
        raise TypeError(f"{known}; got {len(inputs)} of them")
    values = dict(zip(names, inputs, strict=False))
    # Take inputs by their names.
    for word, value in named.items():
        name = others.get(word, word)
        if name not in names or name in values:
            raise TypeError(f"{known}; got {word!r}{' twice' if name in names else ''}")
        values[name] = value
    return {each.name: values.get(each.name, each.default) for each in parameters}


def rows(
    parameters: Sequence[Parameter],
    vectors: Mapping[str, ArrayLike],
    values: Mapping[str, ArrayLike],
) -> Rows:
    """Vectors (..., K) and a value for each parameter in rows.

    Raises
    ------
    ValueError
        If a value leaves its range, or its shape fits nothing or two things; says what to do.
    """
    # Check ranges and last axes.
    directions = {name: np.asarray(value, np.float64) for name, value in vectors.items()}
    lead = _lead(directions, {})
    arrays, colored = {}, False
    for each in parameters:
        array = np.asarray(checked(each.name, values[each.name], each.quantity), np.float64)
        if each.channels == 3:
            refuse_ambiguous(each.name, array, lead)
            colored = colored or array.ndim > 0
            array = np.atleast_1d(array)
        arrays[each.name] = spread_pair(each.name, array) if each.channels == 2 else array
    # Lay out all pairs in one row; what is the same for all of them stays one.
    channels = {each.name: each.channels for each in parameters}
    lead = _lead(directions, {n: (a, channels[n]) for n, a in arrays.items()})
    laid = {name: _laid(a, lead, bool(channels[name])) for name, a in arrays.items()}
    return Rows(
        lead, [_laid(v, lead, True, whole=True) for v in directions.values()], laid, colored
    )


def _lead(
    directions: Mapping[str, Array], arrays: Mapping[str, tuple[Array, int]]
) -> tuple[int, ...]:
    """Shape to which all broadcast but their last axes."""
    shapes = {name: array.shape[:-1] for name, array in directions.items()}
    shapes |= {n: a.shape[:-1] if channels else a.shape for n, (a, channels) in arrays.items()}
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items() if shape)
        raise ValueError(f"shapes must broadcast, last axes apart; got {listed}") from None


def _laid(array: Array, lead: tuple[int, ...], last: bool, whole: bool = False) -> Array:
    """An array as (N, last) or (N,), or as (1, last) or (1,) where it is one for all pairs."""
    tail = array.shape[-1:] if last else ()
    own = array.shape[:-1] if last else array.shape
    if not whole and int(np.prod(own)) == 1:
        return array.reshape(1, *tail)
    return np.broadcast_to(array, (*lead, *tail)).reshape(-1, *tail)
