# SPDX-License-Identifier: Apache-2.0
"""Copies of documents, each of which shows one value as an output or as emitted light.

A node may lie in the nodegraph that implements another node. To show an inner node, MaterialX first
replaces the outer node by the nodes of the nodegraph, which keep their inputs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import MaterialX as mx

LIT = ("BSDF", "EDF", "VDF", "surfaceshader", "material")  # types that scatter or emit light
CLOSURES = (*LIT, "displacementshader", "volumeshader", "lightshader")
NAME = "mxeon_value"
Elements: TypeAlias = Sequence[mx.Element]  # enclosing nodes and nodegraphs, and then the node


def value_document(
    document: mx.Document, elements: Elements, kind: str, output: str = ""
) -> tuple[mx.Document, str]:
    """A document with an output that shows a node's value, and the output's name path.

    The node is the last of `elements`, and `kind` is the type of the value. `output` is the name of
    the node's output, or "" for a node with a single output.
    """
    copy = _copied(document)
    outermost, *inner = (each for each in elements if not each.isA(mx.NodeGraph))
    scope = copy.getDescendant(outermost.getParent().getNamePath()) or copy
    if scope.isA(mx.NodeGraph) and scope.getNodeDef():
        scope = _without_nodedef(copy, scope)
    name = outermost.getName()
    for element in inner:
        # The nodes of the nodegraph replace the outer node. The replacements have new names, but
        # the same order.
        before = {each.getName() for each in scope.getNodes()}
        index = [each.getName() for each in element.getParent().getNodes()].index(element.getName())
        scope.flattenSubgraphs(filter=lambda node, name=name: bool(node.getName() == name))
        name = [each.getName() for each in scope.getNodes() if each.getName() not in before][index]
    _drop_closures(copy)
    if scope.isA(mx.NodeGraph):
        scope.setSourceUri("")  # otherwise, MaterialX skips the output of an included graph
    shown = scope.addOutput(scope.createValidChildName(NAME), kind)
    shown.setNodeName(name)
    if output:
        shown.setOutputString(output)
    return copy, shown.getNamePath()


def emission_document(document: mx.Document, output: mx.Output) -> tuple[mx.Document, str]:
    """A document with a surface that emits an output's color, and the name path of its material."""
    copy = _copied(document)
    value = copy.addNode("convert", copy.createValidChildName(NAME), "color3")
    graph = output.getParent()
    if graph.isA(mx.NodeGraph) and graph.getNodeDef():
        graph = _without_nodedef(copy, graph)
    _drop_closures(copy)
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


def _copied(document: mx.Document) -> mx.Document:
    """A copy of a document in which values inside nodegraphs have explicit color spaces."""
    copy = mx.createDocument()
    copy.copyContentFrom(document)
    copy.setSourceUri(document.getSourceUri())
    copy.setDataLibrary(document.getDataLibrary())
    for each in (*copy.getLooks(), *copy.getLookGroups()):  # looks refer to removed materials
        copy.removeChild(each.getName())
    for graph in _own_graphs(copy):
        for node in graph.getNodes() if graph.hasColorSpace() else ():
            for port in node.getInputs():
                port.setColorSpace(port.getActiveColorSpace())
    return copy


def _own_graphs(document: mx.Document) -> list[mx.NodeGraph]:
    """The document's own nodegraphs. `getNodeGraphs` also returns the data library's nodegraphs."""
    return [each for each in document.getChildren() if each.isA(mx.NodeGraph)]


def _drop_closures(document: mx.Document) -> None:
    """Remove nodes and outputs of closure types, except in graphs that define nodes."""
    for scope in (document, *_own_graphs(document)):
        if scope.isA(mx.NodeGraph) and scope.getNodeDef():
            continue
        for each in (*scope.getNodes(), *scope.getOutputs()):
            if each.getType() in CLOSURES:
                scope.removeChild(each.getName())


def _without_nodedef(document: mx.Document, graph: mx.NodeGraph) -> mx.NodeGraph:
    """A copy, with the nodedef's defaults, of a nodegraph that implements a node."""
    copy = document.addNodeGraph(document.createValidChildName(f"NG_{NAME}"))
    copy.copyContentFrom(graph)
    copy.removeAttribute("nodedef")
    for port in graph.getNodeDef().getActiveInputs():
        copy.addInput(port.getName(), port.getType()).copyContentFrom(port)
    return copy
