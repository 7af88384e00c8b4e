# SPDX-License-Identifier: Apache-2.0
"""The BSDF nodes, their inputs, and materials of one node as MaterialX text."""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    import MaterialX as mx

OREN_NAYAR = "oren_nayar_diffuse_bsdf"
EON = "eon_diffuse_bsdf"

# Categories of the rough diffuse nodes. eonlib's GLSL functions have the same names.
DIFFUSE_NODES = (OREN_NAYAR, EON)
NODEDEFS = tuple(f"ND_{category}" for category in DIFFUSE_NODES)

# eonlib's nodes that compute the reflectance for which EON has a given color.
INVERSIONS = ("eon_rho_from_albedo_normal", "eon_rho_from_albedo_avg")

FLAG = "energy_compensation"  # input of OREN_NAYAR: EON if true, QON if false
INPUT_TYPES = {
    "weight": "float",
    "color": "color3",
    "roughness": "float",
    "normal": "vector3",
    FLAG: "boolean",
}

# The other BSDF nodes of pbrlib. Their inputs are read from MaterialX's definitions.
BSDF_NODES = (
    "burley_diffuse_bsdf",
    "dielectric_bsdf",
    "conductor_bsdf",
    "generalized_schlick_bsdf",
    "subsurface_bsdf",
    "translucent_bsdf",
    "sheen_bsdf",
    "chiang_hair_bsdf",
)

DOCUMENT = """<?xml version="1.0"?>
<materialx version="1.39">
{nodes}  <surfacematerial name="{name}" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="shading" />
  </surfacematerial>
</materialx>
"""


FRAME_INPUTS = ("normal", "tangent", "curve_direction")  # vectors of the surface


@cache
def input_types(category: str) -> Mapping[str, str]:
    """Type of each input of a BSDF node, by name; empty for unknown nodes."""
    if category not in BSDF_NODES:
        return INPUT_TYPES if category in DIFFUSE_NODES else {}
    from mxeon.shaders.library import load_library  # imports MaterialX

    [definition] = load_library("stock").getMatchingNodeDefs(category)
    return {each.getName(): each.getType() for each in definition.getActiveInputs()}


@cache
def types_of(name: str) -> frozenset[str]:
    """Types of the inputs with this name in all nodes.

    >>> sorted(types_of("roughness"))
    ['float', 'vector2']
    """
    tables = map(input_types, (*DIFFUSE_NODES, *BSDF_NODES))
    return frozenset(kinds[name] for kinds in tables if name in kinds)


def value_text(value: ArrayLike) -> str:
    """A value as MaterialX writes it.

    >>> value_text(True), value_text(0.5), value_text((0.2, 0.5, 1))
    ('true', '0.5', '0.2, 0.5, 1.0')
    """
    if isinstance(value, str):
        return value
    if np.asarray(value).dtype == bool:
        return str(bool(value)).lower()
    return ", ".join(repr(float(each)) for each in np.ravel(value))


def input_text(name: str, kind: str, value: ArrayLike) -> str:
    """XML of an input with a value."""
    return f'    <input name="{name}" type="{kind}" value="{value_text(value)}" />\n'


def connection_text(name: str, kind: str, node: str, output: str = "") -> str:
    """XML of an input that is connected to a node or to one of its outputs."""
    port = f' output="{output}"' if output else ""
    return f'    <input name="{name}" type="{kind}" nodename="{node}"{port} />\n'


def node_text(category: str, kind: str, name: str, inputs: str = "") -> str:
    """XML of a node with the XML of its inputs."""
    return f'  <{category} name="{name}" type="{kind}">\n{inputs}  </{category}>\n'


def vector_text(name: str, value: ArrayLike) -> str:
    """XML of a constant vector node."""
    return node_text("constant", "vector3", name, input_text("value", "vector3", value))


# A surface with the BSDF node `lobe`.
SURFACE = node_text("surface", "surfaceshader", "shading", connection_text("bsdf", "BSDF", "lobe"))


def with_images(text: str, inputs: Mapping[str, str], file: str) -> "mx.Document":
    """A document in which the inputs at the paths `node/input` read an image.

    The values of `inputs` are types. The texture coordinate is the value of a node
    `node_input_place`.
    """
    import MaterialX as mx

    document = mx.createDocument()
    mx.readFromXmlString(document, text)
    for path, kind in inputs.items():
        node, port = path.split("/")
        image = document.addNode("image", f"{node}_{port}", kind)
        image.setInputValue("file", file, "filename")
        place = document.addNode("constant", f"{node}_{port}_place", "vector2")
        place.setInputValue("value", mx.Vector2(0.0, 0.0))
        image.setConnectedNode("texcoord", place)
        document.getNode(node).setConnectedNode(port, image)
    return document


def lobe_text(
    category: str,
    inputs: Mapping[str, ArrayLike],
    name: str = "lobe",
    types: Mapping[str, str] | None = None,
) -> str:
    """XML of a BSDF node; `types` gives the types of an unknown node's inputs.

    MaterialX ignores normals and tangents that are not connected, so they come from separate nodes.
    """
    kinds = input_types(category) if types is None else types
    text = constants = ""
    for each, value in inputs.items():
        if each in FRAME_INPUTS:
            source = f"{name}_{each}"
            constants += vector_text(source, value)
            text += connection_text(each, "vector3", source)
        else:
            text += input_text(each, kinds[each], value)
    return constants + node_text(category, "BSDF", name, text)


def document_text(nodes: str, name: str = "look") -> str:
    """XML of a document with one material and its surface shader, the node `shading`."""
    return DOCUMENT.format(nodes=nodes, name=name)


def material_text(
    category: str,
    inputs: Mapping[str, ArrayLike] | None = None,
    name: str = "look",
    types: Mapping[str, str] | None = None,
) -> str:
    """XML of a document with a material of one BSDF node; see `lobe_text`."""
    return document_text(lobe_text(category, inputs or {}, types=types) + SURFACE, name)


# Inputs that are connected to other nodes, in the order of Node.sources.
PORTS = {
    "layer": ("top", "base"),
    "mix": ("fg", "bg"),
    "add": ("in1", "in2"),
    "multiply": ("in1",),
    "generalized_schlick_edf": ("base",),
}


class Node(NamedTuple):
    """A node of a document: category, type, names of its source nodes, and XML of its inputs."""

    category: str
    kind: str
    sources: tuple[str, ...] = ()
    text: str = ""


def network_text(
    nodes: Mapping[str, Node], inputs: Iterable[tuple[str, str, ArrayLike]] = ()
) -> str:
    """XML of nodes by name, with inputs of path, type and value.

    A path is `node/input`; without a node, the input belongs to the last node.
    """
    texts = {name: each.text for name, each in nodes.items()}
    for path, kind, value in inputs:
        name, _, port = path.rpartition("/")
        texts[name or [*nodes][-1]] += input_text(port, kind, value)
    for name, (category, kind, sources, _) in nodes.items():
        ports = zip(PORTS.get(category, ()), sources, strict=False)
        texts[name] += "".join(connection_text(port, kind, source) for port, source in ports)
        texts[name] = node_text(category, kind, name, texts[name])
    return "".join(texts.values())
