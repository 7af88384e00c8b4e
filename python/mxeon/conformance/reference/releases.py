# SPDX-License-Identifier: Apache-2.0
"""Graphs of surface shaders: their values, what they say, and those that MaterialX released.

A document has the surface shader as its node SHADER.
"""

import sys
from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path

import MaterialX as mx
import numpy as np

from mxeon.conformance.reference.graph import Graph
from mxeon.conformance.reference.nodes import OPERATIONS, ShadingPoints, plain
from mxeon.conformance.samples import Array, Batch
from mxeon.errors import NotRun, OutsideModel
from mxeon.hosts.calls import NORMAL, TANGENT
from mxeon.shaders.library import load_library

SHADER = "shading"
PARTS = 3  # that are named where two graphs differ in more
# Digests of what the graphs of releases say, and the versions with each.
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
def installed() -> mx.Document:
    """The data libraries of the MaterialX that is installed, which a build of one's own only hides."""
    known = [path for each in sys.path if (path := Path(each, "MaterialX", "libraries")).is_dir()]
    if not known or known[-1].samefile(Path(mx.__file__).with_name("libraries")):
        return load_library("stock")
    document = mx.createDocument()
    path = mx.FileSearchPath(str(known[-1].parent))
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), path, document)
    return document


class Graphs:
    """The surface shader of a document, and that of the installed release or of its own."""

    def __init__(self, own: mx.Document, text: str) -> None:
        self.own, self._said = own, said(own)
        self._known = RELEASES.get(digest(self._said), ())
        self.right = own
        if mx.getVersionString() not in self._known:
            self.right = mx.createDocument()
            mx.readFromXmlString(self.right, text)
            self.right.setDataLibrary(installed())

    @cached_property
    def same(self) -> bool:
        """Whether both say the same, so that their values are equal."""
        return self._said == said(self.right)

    def values(self, batch: Batch, behind: bool, right: bool = False) -> Array:
        """What a surface shader scatters from a light, and emits, or transmits from an environment, (N, 3).

        An input that is NaN has the default of the definition. The result is NaN where a
        lobe gets inputs that it does not have.
        """
        document = self.right if right else self.own
        definition, inputs = document.getNode(SHADER).getNodeDef(), {}
        for name, given in batch.inputs.items():
            if port := definition.getActiveInput(name):
                frame = TANGENT if "tangent" in name else NORMAL
                default = frame if port.hasDefaultGeomPropString() else plain(port.getValue())
                if default is not None:
                    rows = np.reshape(given, (len(batch.wo), -1))
                    inputs[name] = np.where(np.isnan(rows), default, rows)
        normal, tangent = (np.broadcast_to(axis, batch.wo.shape) for axis in (NORMAL, TANGENT))
        wi = None if behind else batch.wi
        points = ShadingPoints(batch.wo, wi, 1.0, normal, tangent, round=True, behind=behind)
        try:
            found = Graph(document, points, inputs).element(SHADER)
        except (OutsideModel, ValueError):
            found = np.full(3, np.nan)
        return np.array(np.broadcast_to(found, batch.wo.shape))

    @property
    def difference(self) -> tuple[str, bool]:
        """Where the graph differs, and whether it is that of another release, or of another version of the node."""
        version, other = (
            each.getNode(SHADER).getNodeDef().getVersionString() for each in (self.own, self.right)
        )
        parts = differences(self._said, said(self.right))
        text = f"differs from the graph that is installed: {parts}"
        if self._known:
            text = f"the graph of MaterialX {' and '.join(self._known)}; it {text}"
        elif version != other:
            text = f"the graph of version {version} of the node; it {text}, of version {other}"
        return text, bool(self._known) or version != other


def said(document: mx.Document) -> dict[str, str]:
    """The defaults of a surface shader, and the nodes and connections of its graph and of those in it."""
    node = document.getNode(SHADER)
    ports, graph = node.getNodeDef().getActiveInputs(), node.getImplementation()
    if not (graph and graph.isA(mx.NodeGraph)):
        raise NotRun(f"reference: the library has no graph of {node.getCategory()}")
    defaults = {f"the default of {each.getName()}": _source(each) for each in ports}
    return defaults | dict(_inside(graph, {graph.getName()}))


def _inside(graph: mx.NodeGraph, known: set[str]) -> Iterator[tuple[str, str]]:
    for node in graph.getNodes():
        name = node.getName()
        yield f"node {name}", node.getCategory()
        yield from ((f"{each.getName()} of {name}", _source(each)) for each in node.getInputs())
        inner = None if node.getCategory() in OPERATIONS else node.getImplementation()
        if inner and inner.isA(mx.NodeGraph) and inner.getName() not in known:
            known.add(inner.getName())
            yield from _inside(inner, known)
    for each in graph.getOutputs():
        yield f"output {each.getName()} of {graph.getName()}", _source(each)


def _source(port: mx.PortElement) -> str:
    """What an input or output is connected to, or its value."""
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


def differences(own: Mapping[str, str], right: Mapping[str, str]) -> str:
    """The parts in which two graphs differ, in words."""
    found = [
        f"{name} is {own.get(name, 'missing')} instead of {right.get(name, 'missing')}"
        for name in {**right, **own}
        if own.get(name) != right.get(name)
    ]
    more = f", and {len(found) - PARTS} more differences" if len(found) > PARTS else ""
    return f"{', '.join(found[:PARTS])}{more}"
