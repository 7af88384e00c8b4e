# SPDX-License-Identifier: Apache-2.0
"""The nodes that a document's materials use, including nodes in nodegraphs and surface shaders."""

import pathlib
import warnings
from dataclasses import dataclass
from itertools import chain

import MaterialX as mx

from mxeon.errors import DocumentError, ImageError, MxeonError
from mxeon.io.images import open_image
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.document.references import files
from mxeon.shaders.inner_lobes import Path, Walk

CLOSURES = ("BSDF", "EDF", "VDF", "surfaceshader")
COMBINING = ("layer", "mix", "add", "multiply")
MODES = ("string", "boolean")  # types of inputs that select a mode of a node
NUMBERS = ("float", "color3", "vector2", "vector3")
FILM = "thinfilm_thickness"


@dataclass(frozen=True, order=True)
class ShownNode:
    """A node, and the mode in which a material uses the node."""

    category: str
    type: str
    # Name and type of each input in the node's definition. An input of a closure type is listed
    # only if the connected node may emit light. A second entry has the category of the connected
    # node, or "" if this node does not combine lobes.
    inputs: tuple[tuple[str, str], ...] = ()
    # Name and value of each constant input that selects a mode.
    modes: tuple[tuple[str, str], ...] = ()
    film: bool = False  # whether a thin film is possible
    # Name and value of each constant input that is a number, a color or a vector.
    values: tuple[tuple[str, tuple[float, ...]], ...] = ()

    def has(self, other: "ShownNode") -> bool:
        """Whether this node may be used in the mode that the inputs of `other` select."""
        return (
            (self.category, self.type) == (other.category, other.type)
            and set(other.inputs) <= set(self.inputs)
            and all(dict(self.modes).get(name, value) == value for name, value in other.modes)
        )


def document_nodes(policy: Policy, source: tuple[str, str]) -> tuple[ShownNode, ...] | MxeonError:
    """The nodes that a document's materials use, or the error that prevents reading the document.

    The argument `source` has the document's file and the name of a library.
    """
    file, library = source
    try:
        with warnings.catch_warnings(action="ignore"):  # these warnings are reported elsewhere
            document = read_document(file, library, policy=policy)
    except (MxeonError, OSError) as error:
        return (
            error if isinstance(error, MxeonError) else DocumentError(f"{file}: {error.strerror}")
        )
    if document.missing:
        return DocumentError(*document.missing)
    walk = Walk(document.renderables, values=True)
    images = {
        name
        for path in walk.shown
        for port in walk.elements[path].getInputs()
        if port.getType() == "filename" and (name := walk.value(path, port.getName()))
    }
    try:
        for image in chain.from_iterable(files(pathlib.Path(name)) for name in images):
            open_image(image)
    except ImageError as error:
        return DocumentError(f"{file}: {error}")
    return tuple(sorted({_shown(walk, path) for path in walk.shown}))


def node_of(text: str, category: str) -> ShownNode:
    """The first node of a category in a document, with only the inputs that the document sets."""
    document = mx.createDocument()
    mx.readFromXmlString(document, text)
    node = next(each for each in document.traverseTree() if each.getCategory() == category)
    ports = [
        (each.getName(), _kind(each.getConnectedNode()) or each.getType())
        for each in node.getInputs()
    ]
    modes = [(name, node.getInput(name).getValueString()) for name, kind in ports if kind in MODES]
    return ShownNode(category, node.getType(), tuple(ports), tuple(modes))


def _kind(source: mx.InterfaceElement | None) -> str:
    """Category of a node that combines lobes, "" for any other node."""
    return source.getCategory() if source and source.getCategory() in COMBINING else ""


def _shown(walk: Walk, path: Path) -> ShownNode:
    node = walk.elements[path]
    inputs = definition.getActiveInputs() if (definition := node.getNodeDef()) else ()
    ports = [(port.getName(), port.getType()) for port in inputs]
    sources = {name: walk.source(path, name) for name, kind in ports if kind in CLOSURES}
    lit = {name: each for name, each in sources.items() if each and walk.emits(each)}
    ports = [port for port in ports if port[0] in lit or port[0] not in sources]
    ports += [(name, _kind(walk.elements[each])) for name, each in lit.items()]
    values = ((name, walk.value(path, name)) for name, kind in ports if kind in MODES)
    known = tuple((name, value) for name, value in values if value is not None)
    thickness = walk.value(path, FILM) if (FILM, "float") in ports else "0"
    film = thickness is None or float(thickness or 0.0) > 0.0
    texts = ((name, walk.value(path, name)) for name, kind in ports if kind in NUMBERS)
    numbers = tuple((name, tuple(map(float, text.split(",")))) for name, text in texts if text)
    return ShownNode(node.getCategory(), node.getType(), tuple(ports), known, film, numbers)
