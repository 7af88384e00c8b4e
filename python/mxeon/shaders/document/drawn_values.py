# SPDX-License-Identifier: Apache-2.0
"""Documents that draw a value of another document, as an output or as an emission.

A node inside a node's nodegraph gets its inputs as before: the nodegraph is copied with another output, and the
node around it with the copy as its definition.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

import MaterialX as mx

LIT = ("BSDF", "EDF", "VDF", "surfaceshader", "material")  # types of what scatters or emits light
CLOSURES = (*LIT, "displacementshader", "volumeshader", "lightshader")
NAME = "mxeon_value"
Elements: TypeAlias = Sequence[mx.Element]  # a node, after the nodes and nodegraphs around it


def value_document(
    document: mx.Document, elements: Elements, kind: str, output: str = ""
) -> tuple[mx.Document, str]:
    """A document with an output that shows a node's value, and the output's name path.

    `kind` is the type of the value, and `output` the name of a node's output; the elements are those of
    `document`.
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
