# SPDX-License-Identifier: Apache-2.0
"""BSDF nodes of a document as rows of the models, and the nodes that combine them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import MaterialX as mx
import numpy as np

from mxeon.conformance.reference.lobes import INNER_NODES, diffuse
from mxeon.conformance.reference.operations import WIDTHS, Values
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.errors import NotRun, OutsideModel
from mxeon.models.core import layering
from mxeon.models.core.layering import Bsdf
from mxeon.models.nodes import NODES
from mxeon.models.nodes.node import PbrNode
from mxeon.models.thin_film.lobe import FILM
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
    inputs: Mapping[str, Values]  # as `node_lobe` gets them


def node_lobe(
    node: mx.Node, inputs: Mapping[str, Values], points: ShadingPoints, layered: bool
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
        words = str(error).replace("rho must", "color must")  # as MaterialX calls it
        raise OutsideModel(f"{name}: {words}") from None
    # What hides its base does so at any weight.
    left = 1.0 - weight * (1.0 - values.throughput) if row.layerable else values.throughput
    return Bsdf(values.value * weight, left)


def definition(node: mx.Node) -> mx.NodeDef:
    """Nodedef of a node; raises NotRun if no nodedef matches its inputs."""
    if definition := node.getNodeDef():
        return definition
    raise NotRun(f"reference: node {node.getNamePath()!r} has no definition")


def _row(node: mx.Node, inputs: Mapping[str, Values]) -> PbrNode:
    """Row of the model that a node with these inputs has."""
    category = node.getCategory()
    if category in DIFFUSE_NODES:
        return DIFFUSE[category == EON or bool(np.any(inputs[FLAG]))]
    for row in LOBES[category]:
        if all(value_text(inputs[port]) == value for port, value in row.fixed.items()):
            return row
    raise NotRun(f"reference: there is no model for this mode of node {category!r}")


def _assert_known(node: mx.Node, row: PbrNode, inputs: Mapping[str, Values]) -> None:
    """Raise NotRun if an input that the model does not have differs from its default."""
    frame = ("normal", "tangent", "curve_direction")
    known = {"weight", *frame, FLAG, *FILM, *row.inputs, *row.fixed}
    for port, value in inputs.items():
        default = definition(node).getActiveInput(port).getValue()
        if port not in known and not np.array_equal(value, np.asarray(plain(default))):
            raise NotRun(
                f"reference: there is no model for input {port!r} of node {node.getCategory()!r}"
            )


def _shaped(node: mx.Node, port: str, value: Values) -> Values:
    """Value of an input as (1,) or (N,) if it is a number, else with its components."""
    kind = definition(node).getActiveInput(port).getType()
    if kind in ("float", "boolean"):
        return np.reshape(np.asarray(value, np.float64), -1)
    array = np.atleast_2d(np.asarray(value, np.float64))
    if port == "roughness":  # OpenPBR stretches a lobe beyond 1, and shaders take 1
        array = np.clip(array, 0.0, 1.0)
    return np.broadcast_to(array, (len(array), WIDTHS[kind]))


def _where_shown(value: Values, weight: Values) -> Values:
    """Values of an input with another point's where its lobe has no weight: there it may be no number."""
    idle = weight[:, 0] == 0.0
    if len(value) != len(idle) or not idle.any():
        return value
    shown = value.copy()
    shown[idle] = value[int(idle.argmin())]
    return shown


def plain(value: Plain) -> Values | bool | str | None:
    """A MaterialX value as a bool, a string, an array or None; NotRun for a matrix."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, MATRICES):
        raise NotRun("reference: no node computes with a matrix here")
    return np.asarray(value if isinstance(value, (int, float)) else tuple(value), dtype=np.float64)
