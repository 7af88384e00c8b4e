# SPDX-License-Identifier: Apache-2.0
"""The graphs of surface shaders, and the MaterialX releases that contain them."""

import sys
from collections.abc import Container, Iterator, Mapping
from functools import cache
from hashlib import sha256
from pathlib import Path

import MaterialX as mx

from mxeon.errors import NotRun
from mxeon.shaders.library import load_library

PARTS = 3  # maximum differences reported between two graphs
# Digests of released graphs, and the versions with each graph.
RELEASES: Mapping[str, tuple[str, ...]] = {
    "14ecabb97635dfa0": ("1.39.3", "1.39.4"),  # open_pbr_surface
    "1e645305e1b7dc2b": ("1.39.5",),
    "5568198babe96c17": ("1.39.3", "1.39.4", "1.39.5"),  # standard_surface
    "1ccbee1d778c54c1": ("1.39.3",),  # gltf_pbr
    "0a827f2dffe0f4cb": ("1.39.4",),
    "0e6d434bddbb16ac": ("1.39.5",),
    "df5c716ed323783b": ("1.39.3", "1.39.4"),  # UsdPreviewSurface
    "482ef66253eae29d": ("1.39.5",),
}


@cache
def hidden() -> mx.Document | None:
    """The data libraries of the MaterialX that is installed, where a custom build hides it."""
    known = [path for each in sys.path if (path := Path(each, "MaterialX", "libraries")).is_dir()]
    if not known or known[-1].samefile(Path(mx.__file__).with_name("libraries")):
        return None
    document = mx.createDocument()
    path = mx.FileSearchPath(str(known[-1].parent))
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), path, document)
    return document


def installed() -> mx.Document:
    """The data libraries of the MaterialX that is installed, which a custom build only hides."""
    return hidden() or load_library("stock")


def said(node: mx.Node, known: Container[str]) -> dict[str, str]:
    """The defaults of a surface shader, and the nodes and connections of its graph and nested graphs.

    Graphs of nodes in the categories `known` are not expanded.
    """
    ports, graph = node.getNodeDef().getActiveInputs(), node.getImplementation()
    if not (graph and graph.isA(mx.NodeGraph)):
        raise NotRun(f"reference: the library has no graph of {node.getCategory()}")
    defaults = {f"the default of {each.getName()}": port_text(each) for each in ports}
    return defaults | dict(_inside(graph, known, {graph.getName()}))


def facts(graph: mx.NodeGraph) -> Iterator[tuple[str, str]]:
    """The nodes, inputs and outputs of a graph."""
    for node in graph.getNodes():
        name = node.getName()
        yield f"node {name}", node.getCategory()
        yield from ((f"{each.getName()} of {name}", port_text(each)) for each in node.getInputs())
    for each in graph.getOutputs():
        yield f"output {each.getName()} of {graph.getName()}", port_text(each)


def ports_of(node: mx.Node) -> dict[str, mx.Input]:
    """The inputs of a node by name, completed from its definition."""
    definition = node.getNodeDef()
    ports = definition.getActiveInputs() if definition else ()
    return {each.getName(): each for each in (*ports, *node.getInputs())}


def _inside(
    graph: mx.NodeGraph, known: Container[str], seen: set[str]
) -> Iterator[tuple[str, str]]:
    yield from facts(graph)
    for node in graph.getNodes():
        inner = None if node.getCategory() in known else node.getImplementation()
        if inner and inner.isA(mx.NodeGraph) and inner.getName() not in seen:
            seen.add(inner.getName())
            yield from _inside(inner, known, seen)


def port_text(port: mx.PortElement) -> str:
    """The connection of an input or output, otherwise its value."""
    if node := port.getNodeName():
        return " ".join(filter(None, (node, port.getOutputString())))
    if port.isA(mx.Input) and port.hasInterfaceName():
        return f"the input {port.getInterfaceName()}"
    value: str = port.getValueString()
    try:
        return ", ".join(f"{float(each):.7g}" for each in value.split(","))
    except ValueError:
        return value


def digest(parts: Mapping[str, str]) -> str:
    return sha256(repr(sorted(parts.items())).encode()).hexdigest()[:16]


def differences(own: Mapping[str, str], right: Mapping[str, str]) -> tuple[str, ...]:
    """The differences between two graphs, three texts each: the name and both values."""
    return tuple(
        text
        for name in {**right, **own}
        if own.get(name) != right.get(name)
        for text in (name, own.get(name, "missing"), right.get(name, "missing"))
    )
