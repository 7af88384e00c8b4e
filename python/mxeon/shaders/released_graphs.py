# SPDX-License-Identifier: Apache-2.0
"""Compares the nodegraphs of the installed MaterialX with the nodegraphs of a custom build."""

import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import MaterialX as mx

from mxeon.shaders.library import load_library


@cache
def hidden() -> mx.Document | None:
    """The libraries of the installed MaterialX; None unless a custom build replaces MaterialX."""
    known = [path for each in sys.path if (path := Path(each, "MaterialX", "libraries")).is_dir()]
    if not known or known[-1].samefile(Path(mx.__file__).with_name("libraries")):
        return None
    document = mx.createDocument()
    path = mx.FileSearchPath(str(known[-1].parent))
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), path, document)
    return document


def installed() -> mx.Document:
    """The data libraries of the installed MaterialX, even if a custom build replaces MaterialX."""
    return hidden() or load_library("stock")


def facts(graph: mx.NodeGraph) -> Iterator[tuple[str, str]]:
    """The nodes, inputs and outputs of a graph."""
    for node in graph.getNodes():
        name = node.getName()
        yield f"node {name}", node.getCategory()
        yield from ((f"{each.getName()} of {name}", port_text(each)) for each in node.getInputs())
    for each in graph.getOutputs():
        yield f"output {each.getName()} of {graph.getName()}", port_text(each)


def ports_of(node: mx.Node) -> dict[str, mx.Input]:
    """A node's inputs, keyed by name, including inputs that only the node's definition has."""
    definition = node.getNodeDef()
    ports = definition.getActiveInputs() if definition else ()
    return {each.getName(): each for each in (*ports, *node.getInputs())}


def port_text(port: mx.PortElement) -> str:
    """Text of the connection of an input or output, or of the value if nothing is connected."""
    if node := port.getNodeName():
        return " ".join(filter(None, (node, port.getOutputString())))
    if port.isA(mx.Input) and port.hasInterfaceName():
        return f"the input {port.getInterfaceName()}"
    value: str = port.getValueString()
    try:
        return ", ".join(f"{float(each):.7g}" for each in value.split(","))
    except ValueError:
        return value


def differences(own: Mapping[str, str], right: Mapping[str, str]) -> tuple[str, ...]:
    """For each difference between two graphs, the name and the values in both graphs."""
    return tuple(
        text
        for name in {**right, **own}
        if own.get(name) != right.get(name)
        for text in (name, own.get(name, "missing"), right.get(name, "missing"))
    )
