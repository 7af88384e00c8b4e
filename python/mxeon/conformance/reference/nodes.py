# SPDX-License-Identifier: Apache-2.0
"""Nodes of a document: BSDFs as rows of the models, those that combine them, and those that compute numbers.

A host draws the values of every other node that is no nodegraph of these: see `measured`.

A value is an array whose last axis holds its components; a number is () or (N, 1). What a function returns is
repeated over the components of the node's type, so that a number becomes a color.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import add, mul, pow, sub, truediv
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.reference.lobes import INNER_NODES, ShadingPoints, diffuse
from mxeon.conformance.samples import Array
from mxeon.errors import NotRun, OutsideModel
from mxeon.models.core import layering
from mxeon.models.core.layering import Bsdf
from mxeon.models.media import transmittance
from mxeon.models.nodes import NODES
from mxeon.models.nodes.media import METER
from mxeon.models.nodes.node import PbrNode
from mxeon.models.thin_film import FILM
from mxeon.shaders.document.values import Plain
from mxeon.shaders.nodes import DIFFUSE_NODES, EON, FLAG, OREN_NAYAR, value_text

MATRICES = (mx.Matrix33, mx.Matrix44)
DIFFUSE = {False: diffuse("qon", OREN_NAYAR), True: diffuse("eon", EON)}
ROWS = (*NODES, *INNER_NODES)
LOBES = {
    category: tuple(row for row in ROWS if row.category == category)
    for category in (*DIFFUSE_NODES, *(row.category for row in ROWS))
}

NOTHING = Bsdf(np.zeros(3), np.ones(3))  # a lobe that is not there

# Nodes that combine lobes: category -> inputs, and the function of them.
COMBINATIONS: dict[str, tuple[tuple[str, ...], Callable[..., Bsdf]]] = {
    "layer": (("top", "base"), layering.layer),
    "mix": (("fg", "bg", "mix"), layering.mix),
    "add": (("in1", "in2"), layering.add),
    "multiply": (("in1", "in2"), layering.multiply),
}


@dataclass(frozen=True, eq=False)
class ShownLobe:
    """A lobe of a picture that has a weight."""

    category: str  # of its node
    inputs: Mapping[str, Array]  # as `node_lobe` gets them


def node_lobe(
    node: mx.Node, inputs: Mapping[str, Array], points: ShadingPoints, layered: bool
) -> Bsdf:
    """Lobe of a node; raises NotRun if an input has a value that the models do not cover."""
    # A lobe without a weight scatters nothing.
    name = f"reference: node {node.getNamePath()!r}"
    weight = np.reshape(inputs.get("weight", np.ones(1)), (-1, 1))  # hair has none
    if (beyond := weight[~((weight >= 0.0) & (weight <= 1.0))]).size:
        raise OutsideModel(f"{name}: weight must lie in [0, 1]; got {beyond[0]:g}")
    if not weight.any():
        layerable = any(row.layerable for row in LOBES[node.getCategory()])
        return Bsdf(np.zeros(3), np.full(3, 1.0 if layerable else 0.0))
    row = _row(node, inputs)
    if row in INNER_NODES and not points.round:
        raise NotRun(f"reference: there is no model for this mode of node {node.getCategory()!r}")
    _assert_known(node, row, inputs)
    film = FILM if np.any(inputs.get(FILM[0], 0.0)) else ()
    arguments = {
        port: _where_shown(_shaped(node, port, inputs[port]), weight)
        for port in (*row.inputs, *film)
    }
    if row.name == "qon":
        # MaterialX keeps float32, in which pi / 2 is above pi / 2: that alone is lowered to it.
        rounded = np.float32(arguments["roughness"]) == np.float32(np.pi / 2.0)
        arguments["roughness"] = np.where(rounded, np.pi / 2.0, arguments["roughness"])
    tangent = inputs.get("tangent", inputs.get("curve_direction", points.tangent))
    lobe = points.lobe(inputs["normal"], tangent)
    try:
        values = lobe(row, arguments, layered)
    except ValueError as error:
        words = str(error).replace("rho must", "color must").replace("sigma must", "roughness must")
        raise OutsideModel(f"{name}: {words}") from None
    # What hides its base does so at any weight.
    left = 1.0 - weight * (1.0 - values.throughput) if row.layerable else values.throughput
    return Bsdf(values.value * weight, left)


def definition(node: mx.Node) -> mx.NodeDef:
    """Nodedef of a node; raises NotRun if no nodedef matches its inputs."""
    if definition := node.getNodeDef():
        return definition
    raise NotRun(f"reference: node {node.getNamePath()!r} has no definition")


def _row(node: mx.Node, inputs: Mapping[str, Array]) -> PbrNode:
    """Row of the model that a node with these inputs has."""
    category = node.getCategory()
    if category in DIFFUSE_NODES:
        return DIFFUSE[category == EON or bool(np.any(inputs[FLAG]))]
    for row in LOBES[category]:
        if all(value_text(inputs[port]) == value for port, value in row.fixed.items()):
            return row
    raise NotRun(f"reference: there is no model for this mode of node {category!r}")


def _assert_known(node: mx.Node, row: PbrNode, inputs: Mapping[str, Array]) -> None:
    """Raise NotRun if an input that the model does not have differs from its default."""
    frame = ("normal", "tangent", "curve_direction")
    known = {"weight", *frame, FLAG, *FILM, *row.inputs, *row.fixed}
    for port, value in inputs.items():
        default = definition(node).getActiveInput(port).getValue()
        if port not in known and not np.array_equal(value, np.asarray(plain(default))):
            raise NotRun(
                f"reference: there is no model for input {port!r} of node {node.getCategory()!r}"
            )


def _shaped(node: mx.Node, port: str, value: Array) -> Array:
    """Value of an input as (1,) or (N,) if it is a number, else with its components."""
    kind = definition(node).getActiveInput(port).getType()
    if kind in ("float", "boolean"):
        return np.reshape(np.asarray(value, np.float64), -1)
    array = np.atleast_2d(np.asarray(value, np.float64))
    if port == "roughness":  # OpenPBR stretches a lobe beyond 1, and shaders take 1
        array = np.clip(array, 0.0, 1.0)
    return np.broadcast_to(array, (len(array), WIDTHS[kind]))


def _where_shown(value: Array, weight: Array) -> Array:
    """Array of an input with another point's where its lobe has no weight: there it may be no number."""
    idle = weight[:, 0] == 0.0
    if len(value) != len(idle) or not idle.any():
        return value
    shown = value.copy()
    shown[idle] = value[int(idle.argmin())]
    return shown


def plain(value: Plain) -> Array | bool | str | None:
    """A MaterialX value as a bool, a string, an array or None; NotRun for a matrix."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, MATRICES):
        raise NotRun("reference: no node computes with a matrix here")
    return np.asarray(value if isinstance(value, (int, float)) else tuple(value), dtype=np.float64)


# --- nodes that compute numbers -------------------------------------------------------------------

# What a node or an input of a document has: numbers, a flag, a text, a lobe, outputs by name, or nothing.
Value: TypeAlias = Array | bool | str | Bsdf | Mapping[str, Array] | None
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


def _dot(in1: Array, in2: Array) -> Array:
    return np.asarray((in1 * in2).sum(axis=-1, keepdims=True), np.float64)


def _normalize(value: Array) -> Array:
    return value / np.sqrt(_dot(value, value))


def _combine(*values: Array) -> Array:
    parts = np.broadcast_arrays(*(np.atleast_1d(value) for value in values))
    return np.concatenate(parts, axis=-1)


def _rotate3d(value: Array, amount: Array, axis: Array) -> Array:
    """Vector turned by an angle in degrees, by Rodrigues' formula for row vectors."""
    angle, axis = np.radians(amount), _normalize(axis)
    along = axis * _dot(axis, value) * (1.0 - np.cos(angle))
    return np.asarray(value * np.cos(angle) + np.cross(value, axis) * np.sin(angle) + along)


def _normalmap(
    value: Array, scale: Array, normal: Array, tangent: Array, bitangent: Array
) -> Array:
    """Unit vector in world space of one in the surface's frame, written as a color."""
    x, y, z = np.moveaxis(2.0 * value - 1.0, -1, 0)[..., np.newaxis]
    scale = np.atleast_1d(scale)
    turned = tangent * x * scale[..., :1] + bitangent * y * scale[..., -1:] + normal * z
    black = _dot(value, value) == 0.0
    return _normalize(np.where(black, normal, turned))


def _when(compare: Callable[..., NDArray[np.bool_]]) -> Operation:
    """One of two values, by a comparison of two others."""

    def choose(value1: Array, value2: Array, in1: Array, in2: Array) -> Array:
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

# --- volumes --------------------------------------------------------------------------------------

# Nodes of a volume below a layer, by the light that passes them.
VOLUMES: dict[str, Operation] = {
    "absorption_vdf": (("absorption",), lambda a: transmittance(a, 0.0, METER)),
    "anisotropic_vdf": (("absorption", "scattering"), lambda a, s: transmittance(a, s, METER)),
}


def over_volume(top: Bsdf, medium: Array | None) -> Bsdf:
    """A layer over a volume, for light that is transmitted."""
    passed = 1.0 if medium is None else medium
    return Bsdf(top.value * passed, top.throughput * passed)
