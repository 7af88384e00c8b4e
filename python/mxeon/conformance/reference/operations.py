# SPDX-License-Identifier: Apache-2.0
"""Nodes that the surface shaders of MaterialX compute numbers with, by category.

A host draws the values of every other node that is no nodegraph of these: see `measured`.

A value is an array whose last axis holds its components; a number is () or (N, 1). What a function
returns is repeated over the components of the node's type, so that a number becomes a color.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import add, mul, pow, sub, truediv
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.models.core.layering import Bsdf

Values: TypeAlias = NDArray[np.float64]
# What a node or an input of a document has: numbers, a flag, a text, a lobe, outputs by name, or nothing.
Value: TypeAlias = Values | bool | str | Bsdf | Mapping[str, Values] | None
Operation: TypeAlias = tuple[tuple[str, ...], Callable[..., Value]]  # its inputs, the function

# Types of several components, and how many.
WIDTHS = {"vector2": 2, "color3": 3, "vector3": 3, "color4": 4, "vector4": 4}


def fitted(kind: str, value: Value) -> Value:
    """Value with the components of a type: a number once for each, what is missing 0 or opaque."""
    width = WIDTHS.get(kind, 1)
    if width == 1 or value is None or isinstance(value, str):
        return value
    array = np.atleast_1d(np.asarray(value, np.float64))
    have = array.shape[-1]
    if have == 1:
        return np.repeat(array, width, axis=-1)
    if have < width:
        rest = np.full((*array.shape[:-1], width - have), 1.0 if kind == "color4" else 0.0)
        return np.concatenate([array, rest], axis=-1)
    return array[..., :width]


def same(value: Value) -> Value:
    """The value of a node that passes its input on."""
    return value


def _dot(in1: Values, in2: Values) -> Values:
    return np.asarray((in1 * in2).sum(axis=-1, keepdims=True), np.float64)


def _normalize(value: Values) -> Values:
    return value / np.sqrt(_dot(value, value))


def _combine(*values: Values) -> Values:
    parts = np.broadcast_arrays(*(np.atleast_1d(value) for value in values))
    return np.concatenate(parts, axis=-1)


def _rotate3d(value: Values, amount: Values, axis: Values) -> Values:
    """Vector turned by an angle in degrees, by Rodrigues' formula for row vectors."""
    angle, axis = np.radians(amount), _normalize(axis)
    along = axis * _dot(axis, value) * (1.0 - np.cos(angle))
    return np.asarray(value * np.cos(angle) + np.cross(value, axis) * np.sin(angle) + along)


def _normalmap(
    value: Values, scale: Values, normal: Values, tangent: Values, bitangent: Values
) -> Values:
    """Unit vector in world space of one in the surface's frame, written as a color."""
    x, y, z = np.moveaxis(2.0 * value - 1.0, -1, 0)[..., np.newaxis]
    scale = np.atleast_1d(scale)
    turned = tangent * x * scale[..., :1] + bitangent * y * scale[..., -1:] + normal * z
    black = _dot(value, value) == 0.0
    return _normalize(np.where(black, normal, turned))


def _when(compare: Callable[..., NDArray[np.bool_]]) -> Operation:
    """One of two values, by a comparison of two others."""

    def choose(value1: Values, value2: Values, in1: Values, in2: Values) -> Values:
        return np.where(compare(value1, value2), in1, in2)

    return ("value1", "value2", "in1", "in2"), choose


ONE, TWO = ("in",), ("in1", "in2")

# Category -> its inputs, and the function of them.
OPERATIONS: dict[str, Operation] = {
    "constant": (("value",), same),
    "convert": (ONE, lambda value: np.asarray(value, np.float64)),
    "dot": (ONE, same),
    "add": (TWO, add),
    "subtract": (TWO, sub),
    "multiply": (TWO, mul),
    "divide": (TWO, truediv),
    "power": (TWO, pow),
    "min": (TWO, np.minimum),
    "max": (TWO, np.maximum),
    "clamp": (("in", "low", "high"), lambda x, low, high: np.minimum(np.maximum(x, low), high)),
    "invert": (("amount", "in"), sub),
    "absval": (ONE, np.abs),
    "sign": (ONE, np.sign),
    "sqrt": (ONE, np.sqrt),
    "ln": (ONE, np.log),
    "normalize": (ONE, _normalize),
    "rotate3d": (("in", "amount", "axis"), _rotate3d),
    "normalmap": (("in", "scale", "normal", "tangent", "bitangent"), _normalmap),
    "combine2": (TWO, _combine),
    "combine3": (("in1", "in2", "in3"), _combine),
    "extract": (
        ("in", "index"),
        lambda value, index: np.take(value, [int(np.ravel(index)[0])], axis=-1),
    ),
    "luminance": (("in", "lumacoeffs"), lambda value, weights: _dot(value[..., :3], weights)),
    "mix": (("fg", "bg", "mix"), lambda fg, bg, mix: fg * mix + bg * (1.0 - mix)),
    "ifgreater": _when(np.greater),
    "ifgreatereq": _when(np.greater_equal),
    "ifequal": _when(np.equal),
}
