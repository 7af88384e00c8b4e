# SPDX-License-Identifier: Apache-2.0
"""Names and inputs of MaterialX's BSDF nodes, and XML of materials with one BSDF node."""

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

# Nodes of eonlib that compute EON's parameter rho from an albedo.
INVERSIONS = ("eon_rho_from_albedo_normal", "eon_rho_from_albedo_avg")

FLAG = "energy_compensation"  # input of OREN_NAYAR that selects EON (true) or QON (false)
INPUT_TYPES = {
    "weight": "float",
    "color": "color3",
    "roughness": "float",
    "normal": "vector3",
    FLAG: "boolean",
}

# BSDF nodes of pbrlib that are not rough diffuse. MaterialX's definitions list the inputs.
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


FRAME_INPUTS = ("normal", "tangent", "curve_direction")  # directions at the surface


@cache
def input_types(category: str) -> Mapping[str, str]:
    """The types of a BSDF node's inputs, keyed by input name; empty for unknown nodes."""
    if category not in BSDF_NODES:
        return INPUT_TYPES if category in DIFFUSE_NODES else {}
    # The import is local because mxeon.shaders.library imports MaterialX.
    from mxeon.shaders.library import load_library

    [definition] = load_library("stock").getMatchingNodeDefs(category)
    return {each.getName(): each.getType() for each in definition.getActiveInputs()}


@cache
def types_of(name: str) -> frozenset[str]:
    """The types of all BSDF inputs that have this name.

    >>> sorted(types_of("roughness"))
    ['float', 'vector2']
    """
    tables = map(input_types, (*DIFFUSE_NODES, *BSDF_NODES))
    return frozenset(kinds[name] for kinds in tables if name in kinds)


def value_text(value: ArrayLike) -> str:
    """The text of a value in MaterialX's notation.

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
    """XML of an input that is connected to a node, or to a named output of a node."""
    port = f' output="{output}"' if output else ""
    return f'    <input name="{name}" type="{kind}" nodename="{node}"{port} />\n'


def node_text(category: str, kind: str, name: str, inputs: str = "") -> str:
    """XML of a node. `inputs` is the XML of the node's inputs."""
    return f'  <{category} name="{name}" type="{kind}">\n{inputs}  </{category}>\n'


def vector_text(name: str, value: ArrayLike) -> str:
    """XML of a constant vector node."""
    return node_text("constant", "vector3", name, input_text("value", "vector3", value))


# XML of a surface whose BSDF is the node `lobe`.
SURFACE = node_text("surface", "surfaceshader", "shading", connection_text("bsdf", "BSDF", "lobe"))


def with_images(text: str, inputs: Mapping[str, str], file: str) -> "mx.Document":
    """A document in which the inputs listed in `inputs` read an image.

    The keys of `inputs` are paths of the form `node/input`, and the values are types. The texture
    coordinate of each image is the constant value of a new node, `node_input_place`.
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
    """XML of a BSDF node. `types` has the types of the inputs, and is needed for unknown nodes.

    MaterialX ignores constant normals and tangents, so separate nodes supply normals and tangents.
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
    """XML of a document with one material, whose surface shader is the node `shading`."""
    return DOCUMENT.format(nodes=nodes, name=name)


def material_text(
    category: str,
    inputs: Mapping[str, ArrayLike] | None = None,
    name: str = "look",
    types: Mapping[str, str] | None = None,
) -> str:
    """XML of a document whose material has one BSDF node. See `lobe_text` for the arguments."""
    return document_text(lobe_text(category, inputs or {}, types=types) + SURFACE, name)


# Inputs that are connected to the nodes in Node.sources, in the same order.
PORTS = {
    "layer": ("top", "base"),
    "mix": ("fg", "bg"),
    "add": ("in1", "in2"),
    "multiply": ("in1",),
    "generalized_schlick_edf": ("base",),
}


class Node(NamedTuple):
    """A node with its category, its type, the nodes that supply inputs, and XML of other inputs."""

    category: str
    kind: str
    sources: tuple[str, ...] = ()
    text: str = ""


def network_text(
    nodes: Mapping[str, Node], inputs: Iterable[tuple[str, str, ArrayLike]] = ()
) -> str:
    """XML of named nodes with additional inputs. Each input has a path, a type and a value.

    A path has the form `node/input`. A path without a node names an input of the last node.
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
