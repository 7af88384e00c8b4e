# SPDX-License-Identifier: Apache-2.0
"""Array of a document's nodes as the host that is judged computes them.

Patterns are not what the reference knows: where it has no function for a node, the value that comes
from it is drawn by the host, as an output of a document of its own, and the reference goes on from
there. A node inside a node's nodegraph gets its inputs as before: the nodegraph is copied with
another output, and the node around it with the copy as its definition.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

import MaterialX as mx
import numpy as np

from mxeon.conformance.samples import Array
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts.base import Host
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene

# Types that a generator draws as a color, and their components.
DRAWN = {"float": 1, "integer": 1, "vector2": 2, "color3": 3, "vector3": 3}
PATTERNS = (*DRAWN, "boolean", "color4", "vector4")  # of which a generator draws three components
LIT = ("BSDF", "EDF", "VDF", "surfaceshader", "material")  # types of what scatters or emits light
CLOSURES = (*LIT, "displacementshader", "volumeshader", "lightshader")
TARGETS = ("glsl", "essl", "vulkan", "wgsl")  # whose shaders of an output draw its value
NAME = "mxeon_value"
Elements: TypeAlias = Sequence[mx.Element]  # a node, after the nodes and nodegraphs around it
# Array of a node, by its type and the name of its output.
Measure: TypeAlias = Callable[[Elements, str, str], Array]


class HostValues:
    """Array of a shader's nodes at the pixels of a picture, as a host draws them; NotRun if it cannot."""

    def __init__(self, host: Host, shader: Shader, library: str, policy: Policy) -> None:
        self._host, self._shader = host, shader
        self.library, self._policy = library, policy
        self._pictures: dict[tuple[str, ...], Array] = {}

    def __call__(self, size: int, elements: Elements, kind: str, output: str = "") -> Array:
        """Array of a node in a picture, (size, size, components)."""
        key = (*(each.getNamePath() for each in elements), output, str(size))
        make = partial(value_document, self._shader.document, elements, kind, output)
        return self._drawn(key, make, elements[-1].getNamePath(), size)[..., : DRAWN[kind]]

    def emitted(self, size: int, output: mx.Output) -> Array:
        """Picture of a surface that emits the color of an output, (size, size, 3)."""
        make = partial(emission_document, self._shader.document, output)
        return self._drawn((output.getNamePath(), str(size)), make, output.getNamePath(), size)

    def _drawn(
        self,
        key: tuple[str, ...],
        make: Callable[[], tuple[mx.Document, str]],
        name: str,
        size: int,
    ) -> Array:
        """Picture of the element of a document to be made, on which no light falls; kept by a key."""
        if key in self._pictures:
            return self._pictures[key]
        if self._host.target not in TARGETS:
            raise NotRun(f"{self._host.name}: the value of {name!r} cannot be drawn here")
        document, path = make()
        try:
            [shader] = self._host.compile(document, path, library=self.library, policy=self._policy)
        except DocumentError as error:
            raise NotRun(f"reference: the value of {name!r} cannot be drawn; {error}") from None
        image = self._host.picture(shader, Scene(NAME, size=size))
        return self._pictures.setdefault(key, np.asarray(image, np.float64))


def value_document(
    document: mx.Document, elements: Elements, kind: str, output: str = ""
) -> tuple[mx.Document, str]:
    """A document with an output that shows a node's value, and the output's name path.

    Arguments as those of `HostValues`; the nodes are those of `document`.
    """
    copy = _without_closures(document)
    # From the inside out, define each node around the value anew: it has the value for its own.
    element = elements[-1]
    added: Callable[[mx.GraphElement], str] | None = None
    name = element.getName()
    for owner in reversed(elements[:-1]):
        if owner.isA(mx.NodeGraph):
            break
        graph = copy.addNodeGraph(copy.createValidChildName(f"NG_{NAME}"))
        graph.copyContentFrom(element.getParent())
        graph.setColorSpace(element.getParent().getActiveColorSpace())
        _drop_closures(graph)
        for each in graph.getOutputs():
            graph.removeChild(each.getName())
        name = added(graph) if added else name
        definition = _definition(copy, owner, kind)
        graph.setNodeDefString(definition.getName())
        _show(graph, "out", name, kind, output)
        element, added, output = owner, partial(_instance, owner, definition, kind), ""
    scope = copy.getDescendant(element.getParent().getNamePath()) or copy
    if scope.isA(mx.NodeGraph) and scope.getNodeDef():
        scope = _opened(copy, scope)
    if scope.isA(mx.NodeGraph):
        scope.setSourceUri("")  # outputs of graphs that a document includes are not drawn
    name = added(scope) if added else name
    shown = _show(scope, scope.createValidChildName(NAME), name, kind, output)
    return copy, shown.getNamePath()


def emission_document(document: mx.Document, output: mx.Output) -> tuple[mx.Document, str]:
    """A document with a surface that emits the color of an output, and the name path of its material."""
    copy = _without_closures(document)
    value = copy.addNode("convert", copy.createValidChildName(NAME), "color3")
    graph = output.getParent()
    if graph.isA(mx.NodeGraph) and graph.getNodeDef():
        graph = _opened(copy, graph)
    port = value.addInput("in", output.getType())
    for name in ("nodename", "output"):
        if graph.isA(mx.Document) and output.hasAttribute(name):
            port.setAttribute(name, output.getAttribute(name))
    if graph.isA(mx.NodeGraph):
        port.setNodeGraphString(graph.getName())
        port.setOutputString(output.getName())
    if output.getType() == "color3":
        value.setCategory("dot")
    light = copy.addNode("uniform_edf", copy.createValidChildName(NAME), "EDF")
    light.addInput("color", "color3").setConnectedNode(value)
    surface = copy.addNode("surface", copy.createValidChildName(NAME), "surfaceshader")
    surface.addInput("edf", "EDF").setConnectedNode(light)
    material = copy.addNode("surfacematerial", copy.createValidChildName(NAME), "material")
    material.addInput("surfaceshader", "surfaceshader").setConnectedNode(surface)
    return copy, material.getNamePath()


def _without_closures(document: mx.Document) -> mx.Document:
    """A copy of a document, without what scatters light."""
    copy = mx.createDocument()
    copy.copyContentFrom(document)
    copy.setSourceUri(document.getSourceUri())
    copy.setDataLibrary(document.getDataLibrary())
    for each in (*copy.getLooks(), *copy.getLookGroups()):  # which name materials
        copy.removeChild(each.getName())
    for scope in (copy, *copy.getNodeGraphs()):
        if not (scope.isA(mx.NodeGraph) and scope.getNodeDef()):
            _drop_closures(scope)
    return copy


def _drop_closures(scope: mx.GraphElement) -> None:
    """Remove the nodes and outputs of a scope that no value depends on."""
    for each in (*scope.getNodes(), *scope.getOutputs()):
        if each.getType() in CLOSURES:
            scope.removeChild(each.getName())


def _opened(document: mx.Document, graph: mx.NodeGraph) -> mx.NodeGraph:
    """A copy of a nodegraph that defines a node, with the defaults of the node as its own inputs."""
    copy = document.addNodeGraph(document.createValidChildName(f"NG_{NAME}"))
    copy.copyContentFrom(graph)
    copy.removeAttribute("nodedef")
    _drop_closures(copy)
    _add_inputs(copy, graph.getNodeDef().getActiveInputs())
    return copy


def _definition(document: mx.Document, node: mx.Node, kind: str) -> mx.NodeDef:
    """A new definition with the inputs of a node's own, and one output of another type."""
    name = document.createValidChildName(f"ND_{NAME}")
    definition = document.addNodeDef(name, kind, name.removeprefix("ND_"))
    _add_inputs(definition, node.getNodeDef().getActiveInputs())
    return definition


def _instance(owner: mx.Node, definition: mx.NodeDef, kind: str, scope: mx.GraphElement) -> str:
    """Name of a new node in a scope: of a definition, with the inputs of another node."""
    name = str(scope.createValidChildName(NAME))
    _add_inputs(scope.addNode(definition.getNodeString(), name, kind), owner.getInputs())
    return name


def _add_inputs(target: mx.InterfaceElement, ports: Sequence[mx.Input]) -> None:
    """Give an element copies of all inputs of other types than closures."""
    for port in ports:
        if port.getType() not in CLOSURES:
            target.addInput(port.getName(), port.getType()).copyContentFrom(port)


def _show(scope: mx.GraphElement, name: str, node: str, kind: str, output: str) -> mx.Output:
    shown = scope.addOutput(name, kind)
    shown.setNodeName(node)
    if output:
        shown.setOutputString(output)
    return shown
