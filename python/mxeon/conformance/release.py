# SPDX-License-Identifier: Apache-2.0
"""Comparison of a library with the installed MaterialX release: definitions, units, graphs and texts of nodes.

Nodes with a model are judged by their model. For everything else the release is the reference: nodes that are
written differently are evaluated for the same inputs and must have the same values. A library that lacks nodes of
the release is an older version and is not compared. A library with additional nodes in MaterialX's own
documents may be a newer version, so its differences are permitted.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

import MaterialX as mx
import numpy as np

from mxeon.conformance.check import judge
from mxeon.conformance.reference.nodes import OPERATIONS
from mxeon.conformance.results import NOT_RUN, Cause, Diagnosis, Kind, Result
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, float32, generator
from mxeon.conformance.spec import POWER
from mxeon.conformance.specs import ALL
from mxeon.conformance.specs.utilities import UtilitySpec
from mxeon.conformance.tolerance import Measurement, Term, Tolerance, count_of, roundings, sum_of
from mxeon.errors import DocumentError, MxeonError, NotRun, ShaderError
from mxeon.hosts.base import Host
from mxeon.hosts.calls import GRAPH
from mxeon.io.images import write_exr
from mxeon.shaders import texts
from mxeon.shaders.document.drawn_values import CLOSURES
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import Shader
from mxeon.shaders.generators import GENERATORS
from mxeon.shaders.library import load_library
from mxeon.shaders.library_tree import search_path
from mxeon.shaders.released_graphs import (
    RELEASES,
    differences,
    digest,
    facts,
    hidden,
    installed,
    port_text,
    ports_of,
    said,
)
from mxeon.shaders.scene import FURNACE, SIDE, Client

RELEASE, SUBJECT = "release", "definitions, units, graphs and texts"
CLAIM = "What has no model is as MaterialX released it, or has the same values."
ROWS = 64  # samples of the inputs
MOST = 12  # maximum number of evaluated nodes
SIZE, MATERIALS = 24, 3  # size and number of pictures for differently arranged lobes
# Compared attributes of inputs and outputs; ranges only guide editors.
ATTRIBUTES = ("type", "defaultgeomprop", "uniform", "unit", "unittype", "colorspace", "enum")
COMPONENTS = {"float": 1, "integer": 1, "boolean": 1, "vector2": 2, "color3": 3, "vector3": 3}
# Nodes that append a fourth component to three, and the type of the three.
JOINED = {
    "color4": ("ND_combine2_color4CF", "color3"),
    "vector4": ("ND_combine2_vector4VF", "vector3"),
}
SHADED = ("BSDF", "EDF", "surfaceshader")  # types that are compared by pictures
SHADERS = ("surfaceshader", "volumeshader", "displacementshader")  # types that stay unconnected
ALPHA = ("hwTransparency",)  # option that adds an alpha to shaders
PICTURES = tuple(
    replace(each, size=SIZE) for each in (SIDE, FURNACE, replace(SIDE, client=Client(alpha=True)))
)
LOBES = {"BSDF": "burley_diffuse_bsdf", "EDF": "uniform_edf"}  # sources for inputs, by type
ZEROS = {
    "float": "0",
    "integer": "0",
    "boolean": "false",
    "vector2": "0, 0",
    "color3": "0, 0, 0",
    "vector3": "0, 0, 1",
}
PROBE = "mxeon_probe"
MODELLED = {(each.node, isinstance(each, UtilitySpec)) for each in ALL}
Place: TypeAlias = tuple[mx.GraphElement, mx.PortElement]  # a graph and one of its ports
# A definition in a library, its output's name and type, and optionally a port in its graph instead.
Subject: TypeAlias = (
    "tuple[mx.NodeDef, str, tuple[str, str]] | tuple[mx.NodeDef, str, tuple[str, str], Place]"
)

# A definition, its library, and optionally a port in its graph.
Side: TypeAlias = "tuple[mx.NodeDef, str] | tuple[mx.NodeDef, str, Place]"


def released(library: str) -> mx.Document | None:
    """The installed release, or None if the library lacks some of its nodes."""
    own = {each.getName() for each in load_library(library).getNodeDefs()}
    for release in (installed(), load_library("stock")):
        if own.issuperset(each.getName() for each in release.getNodeDefs()):
            return release
    return None


def newer(document: mx.Document, release: mx.Document) -> tuple[str, ...]:
    """Nodes that the release lacks, in documents with the names of MaterialX's own."""
    known = {Path(each.getActiveSourceUri()).name: None for each in release.getNodeDefs()}
    return tuple(
        each.getNodeString()
        for each in document.getNodeDefs()
        if not release.getNodeDef(each.getName()) and Path(each.getActiveSourceUri()).name in known
    )


def definition_facts(
    document: mx.Document, release: mx.Document, names: list[str]
) -> dict[str, str]:
    """A document's version of a release's definitions (some of them), units and geometric properties."""
    found: dict[str, str] = {}
    for name in names:
        own, right = document.getNodeDef(name), release.getNodeDef(name)
        found[f"category of {name}"] = own.getNodeString()
        found[f"version of {name}"] = f"{own.getVersionString()} {own.getDefaultVersion()}"
        for each in (*right.getActiveInputs(), *right.getActiveOutputs()):
            port, place = own.getActiveValueElement(each.getName()), f"{each.getName()} of {name}"
            if port is None:
                found[place] = "missing"
                continue
            found[f"the default of {place}"] = port_text(port)
            found |= {f"{fact} of {place}": port.getAttribute(fact) for fact in ATTRIBUTES}
    for right in (*release.getUnitDefs(), *release.getGeomPropDefs()):
        own = document.getChild(right.getName())
        for element in (own, *own.getChildren()) if own else ():
            place = f"{element.getCategory()} {element.getName()}"
            found |= {
                f"{fact} of {place}": one_spelling(element.getAttribute(fact))
                for fact in element.getAttributeNames()
                if fact != "doc"
            }
    return found


def one_spelling(text: str) -> str:
    """A number as it is shortest, and any other text as it is."""
    with suppress(ValueError):
        return repr(float(text))
    return text


def versions(document: mx.Document, name: str) -> tuple[str, ...]:
    """The releases with the graph and the defaults of a surface shader; empty for an unknown graph."""
    definition = document.getNodeDef(name)
    graph = definition.getImplementation()
    if definition.getType() != "surfaceshader" or not (graph and graph.isA(mx.NodeGraph)):
        return ()
    scratch = mx.createDocument()
    scratch.setDataLibrary(document)
    return RELEASES.get(digest(said(scratch.addNodeInstance(definition), OPERATIONS)), ())


class Terms:
    """Numbers the terms of graphs; terms with the same number have the same value."""

    def __init__(self) -> None:
        self._numbers: dict[object, int] = {}
        self._nodes: dict[tuple[int, str], int] = {}

    def port(self, place: Place) -> int:
        graph, port = place
        if node := graph.getNode(port.getNodeName()):
            output = port.getOutputString() * (node.getType() == "multioutput")
            return self._number((self._node(graph, node), output))
        attributes = (port.getAttribute(fact) for fact in ATTRIBUTES)
        return self._number((port_text(port), *attributes))

    def _node(self, graph: mx.GraphElement, node: mx.Node) -> int:
        key = id(graph), node.getName()
        if key not in self._nodes:
            self._nodes[key] = -1  # marks nodes that depend on themselves
            ports = {name: self.port((graph, port)) for name, port in ports_of(node).items()}
            kind = node.getCategory(), node.getType(), node.getNodeDefString()
            self._nodes[key] = self._number((*kind, *sorted(ports.items())))
        return self._nodes[key]

    def _number(self, key: object) -> int:
        return self._numbers.setdefault(key, len(self._numbers))


def apart(terms: Terms, own: Place, right: Place) -> Iterator[tuple[Place, Place]]:
    """Ports of two graphs with different terms: inputs of equal lobes, or different lobes."""
    if terms.port(own) == terms.port(right):
        return
    nodes = [graph.getNode(port.getNodeName()) for graph, port in (own, right)]
    if right[1].getType() in CLOSURES and all(nodes):
        inputs, others = (ports_of(node) for node in nodes)
        if nodes[0].getCategory() == nodes[1].getCategory() and inputs.keys() == others.keys():
            for name, port in inputs.items():
                yield from apart(terms, (own[0], port), (right[0], others[name]))
            return
    yield own, right


class Comparison:
    """Compares a library with the release, on a host that evaluates its texts."""

    def __init__(self, host: Host, library: str, release: mx.Document) -> None:
        self._host, self._library, self._release = host, library, release
        self._document = load_library(library)
        self._target = GENERATORS[host.target].create().getTarget()
        self.unjudged: list[tuple[str, str]] = []

    def definitions(self, changed: bool = False) -> list[Cause]:
        """Differences of definitions, units and properties; `changed` changes a default as a control."""
        first, *others = self._release.getNodeDefs()
        names = [
            each.getName()
            for each in others
            if self._document.getNodeDef(each.getName()) != each
            and not versions(self._document, each.getName())
        ]
        own, right = (
            definition_facts(each, self._release, [first.getName(), *names])
            for each in (self._document, self._release)
        )
        if changed:
            own[f"version of {first.getName()}"] = "1234"
        return [
            Cause(Kind.DEFECT, RELEASE, ("", *row))
            for row in zip(*[iter(differences(own, right))] * 3, strict=True)
        ]

    @cached_property
    def nodes(self) -> list[Cause]:
        """Nodes whose graph or text has different values than the released one.

        If several nodes differ in the same text, only the first with different values is reported.
        """
        groups: dict[object, list[str]] = {}
        for right in self._release.getNodeDefs():
            if change := self._change(right.getName()):
                groups.setdefault(change, []).append(right.getName())
        found: list[Cause] = []
        left = list(groups.values())
        for _ in range(MOST):
            if not left:
                break
            name, *others = left.pop(0)
            try:
                causes = list(self._evaluated(name))
            except (NotRun, ShaderError, DocumentError) as error:
                causes = []
                if isinstance(error, NotRun):
                    self.unjudged.append((f"{self._target} of {name}", str(error)))
                else:
                    causes = [Cause(Kind.TEXT, text=f"{name}: {error}")]
            if causes:
                found += [replace(each, of=1 + len(others)) for each in causes]
            elif others:
                left.append(others)
        if left:
            names = ", ".join(name for group in left for name in group)
            reason = f"written differently, and {MOST} others with other changes were evaluated"
            self.unjudged.append((names, reason))
        return found

    def _change(self, name: str) -> object:
        """The difference of a node that no model judges, or None."""
        own, right = (each.getNodeDef(name) for each in (self._document, self._release))
        ours, theirs = (each.getImplementation(self._target) for each in (own, right))
        if theirs is None or (ours is not None and ours == theirs and ours.isA(mx.NodeGraph)):
            return None
        graphs = [bool(each) and each.isA(mx.NodeGraph) for each in (ours, theirs)]
        if all(graphs):
            if other := versions(self._document, name):
                reason = f"the graph of MaterialX {' and '.join(other)}"
                self.unjudged.append((right.getNodeString(), reason))
            return None if other else name
        if (right.getNodeString(), right.getType() not in CLOSURES) in MODELLED:
            return None
        if ours is None or any(graphs):
            return name
        sides = (ours, search_path(self._library)), (theirs, search_path("stock"))
        orders = ([port.getName() for port in each.getActiveInputs()] for each in (own, right))
        if next(orders) != next(orders):
            return name
        if texts.whole(*sides[0]) == texts.whole(*sides[1]):
            return None
        one, two = (set(texts.said(*each)) for each in sides)
        return frozenset(one ^ two) or None

    def _evaluated(self, name: str) -> Iterator[Cause]:
        own, right = (each.getNodeDef(name) for each in (self._document, self._release))
        ours, theirs = (each.getImplementation(self._target) for each in (own, right))
        if ours is not None and ours.isA(mx.NodeGraph) and theirs.isA(mx.NodeGraph):
            return self._graph(own, ours, theirs)
        return self._text(own, right)

    def _graph(
        self, definition: mx.NodeDef, ours: mx.NodeGraph, theirs: mx.NodeGraph
    ) -> Iterator[Cause]:
        """The places where the values of two graphs differ."""
        terms, error = Terms(), 0.0
        for output in theirs.getOutputs():
            other = ours.getOutput(output.getName())
            if other is None:
                error = np.inf
                continue
            for one, two in apart(terms, (ours, other), (theirs, output)):
                if two[1].getType() in CLOSURES:
                    place = theirs, theirs.getOutputs()[0]
                    sides = (definition, self._library), (definition, self._library, place)
                    error = max(error, self._drawn(*sides))
                else:
                    error = max(error, self._apart(definition, one, two))
        if error > self.tolerance.value:
            rows = differences(dict(facts(ours)), dict(facts(theirs)))
            yield Cause(Kind.DEFECT, RELEASE, (definition.getNodeString(), *rows), (error,))

    def _text(self, own: mx.NodeDef, right: mx.NodeDef) -> Iterator[Cause]:
        """Whether the values of nodes with different texts differ."""
        name, kinds = right.getName(), {each.getType() for each in right.getActiveOutputs()}
        rows = f"{self._target} of {name}", "another text", "the one that MaterialX released"
        if own.getImplementation(self._target) is None:
            yield Cause(Kind.DEFECT, RELEASE, (own.getNodeString(), rows[0], "missing", rows[2]))
            return
        numbers, drawn = (
            kinds <= {*COMPONENTS, *JOINED},
            kinds <= {*SHADED}
            and not any(port.getType() in SHADERS for port in right.getActiveInputs()),
        )
        if not (numbers or drawn) or self._release is hidden():
            self.unjudged.append((rows[0], "its text is not MaterialX's, and nothing evaluates it"))
            return
        error = self._drawn((own, self._library), (right, "stock")) if drawn else 0.0
        for output in right.getActiveOutputs() if numbers else ():
            port = (output.getName() if len(right.getActiveOutputs()) > 1 else "", output.getType())
            sides = (own, self._library, port), (right, "stock", port)
            error = max(error, self._distance(*sides))
        if error > self.tolerance.value:
            yield Cause(Kind.DEFECT, RELEASE, (right.getNodeString(), *rows), (error,))

    def _apart(self, definition: mx.NodeDef, own: Place, right: Place) -> float:
        """The largest difference between the values of two graph ports; infinity for text."""
        kind = right[1].getType()
        if kind not in (*COMPONENTS, *JOINED) or own[1].getType() != kind:
            return np.inf
        sides = ((definition, self._library, ("", kind), place) for place in (own, right))
        return self._distance(*sides)

    def _distance(self, own: Subject, right: Subject) -> float:
        """The largest difference between two subjects' values; NotRun if the released one does not compile."""
        try:
            expected = self._values(*right)
        except (DocumentError, ShaderError) as error:
            raise NotRun(f"the released one cannot be evaluated: {error}") from None
        return distance(self._values(*own), expected)

    def _values(
        self,
        definition: mx.NodeDef,
        library: str,
        output: tuple[str, str],
        place: Place | None = None,
    ) -> Array:
        """Values of an output of a node, or of a port in its graph, (ROWS, 3) or (ROWS, 6)."""
        name, kind = output
        parts = [("convert", ""), ("extract", "3")] if kind in JOINED else [("convert", "")]
        found = []
        with TemporaryDirectory() as folder:
            for category, index in parts:
                document = mx.createDocument()
                node = instance(document, definition, self._image(folder), kind, place)
                part = node
                if index:
                    part = document.addNode(category, "part", "float")
                    part.setInputValue("index", int(index))
                    part.addInput("in", kind).setNodeName(node.getName())
                    name, kind = "", "float"
                color = document.addNode("convert", "color", "color3")
                port = color.addInput("in", kind)
                port.setNodeName(part.getName())
                if name:
                    port.setOutputString(name)
                if kind == "color3":
                    color.setCategory("dot")
                edf = document.addNode("uniform_edf", "lobe", "EDF")
                edf.addInput("color", "color3").setNodeName("color")
                finish(document, edf)
                policy = Policy(outside=True)
                [shader] = self._host.compile(document, library=library, policy=policy)
                up = np.tile([0.0, 0.0, 1.0], (ROWS, 1))
                inputs = samples(definition)
                found.append(self._host.evaluate(shader, up, up, inputs, GRAPH))
        return np.concatenate(found, axis=1).astype(np.float64)

    def _drawn(self, *sides: Side) -> float:
        """The largest difference between pictures of a node, alpha included; infinity without pictures."""
        kind = sides[0][0].getType()
        if kind not in SHADED:
            return np.inf
        error = 0.0
        with TemporaryDirectory() as folder, suppress(MxeonError):
            shaders: list[Shader] = []
            for definition, library, *place in sides:
                document = mx.createDocument()
                finish(document, instance(document, definition, self._image(folder), kind, *place))
                policy = Policy(outside=True)
                shaders += self._host.compile(
                    document, library=library, policy=policy, client=ALPHA
                )
            rng = generator()
            for _ in range(MATERIALS):
                drawn = {
                    port.path: rng.random(COMPONENTS[port.type])
                    for port in shaders[0].inputs
                    if port.type in ("float", "color3")
                }
                for scene in PICTURES:
                    pictures = (
                        self._host.picture(
                            replace(
                                shader,
                                inputs=tuple(
                                    replace(
                                        port,
                                        value=tuple(map(float, drawn[port.path]))
                                        if port.type == "color3"
                                        else float(drawn[port.path][0]),
                                    )
                                    if port.path in drawn
                                    else port
                                    for port in shader.inputs
                                ),
                            ),
                            scene,
                        )
                        for shader in shaders
                    )
                    error = max(error, distance(*(each.reshape(-1, 3) for each in pictures)))
            return error
        return np.inf

    def _image(self, folder: str) -> str:
        """An image file with four different channels."""
        path = str(Path(folder, "image.exr"))
        pixels = generator().random((8, 8, 4), np.float32)
        write_exr(path, pixels, {})
        return path

    @cached_property
    def tolerance(self) -> Tolerance:
        """The largest difference between the values of one graph that is written in two ways."""
        base, exponent = float32(np.linspace(0.01, 1.0, ROWS)), float32(np.full(ROWS, 2.0))
        power = float(POWER.errors(self._host, base, exponent).max())
        return sum_of(
            roundings(64, "of the terms of a graph"),
            Term(8.0 * power, "the engine's pow(), eight times"),
            quantity=Quantity.OUTPUT,
        )


def samples(definition: mx.NodeDef) -> dict[str, Array]:
    """Values of the nodes that feed a definition's inputs, by path; half of them in [0, 1]."""
    rng, found = generator(), {}
    for port in definition.getActiveInputs():
        kind = JOINED.get(port.getType(), ("", port.getType()))[1]
        for name, each in ((port.getName(), kind), (f"{port.getName()}_4", "float")):
            if each in COMPONENTS:
                values = rng.random((ROWS, COMPONENTS[each]))
                values[ROWS // 2 :] = 4.0 * values[ROWS // 2 :] - 1.5
                if each in ("integer", "boolean"):
                    values = np.floor(values * 2.0).clip(0.0)
                found[f"in_{name}/value"] = float32(values)
    return found


def instance(
    document: mx.Document,
    definition: mx.NodeDef,
    image: str,
    kind: str,
    place: Place | None = None,
) -> mx.Node:
    """A node of a definition, or of a port in its graph, with a separate node for each input."""
    category, name = definition.getNodeString(), definition.getName()
    left_out = ("VDF",) if kind in CLOSURES else CLOSURES
    ports = [each for each in definition.getActiveInputs() if each.getType() not in left_out]
    if place:
        category, name = PROBE, f"ND_{PROBE}"
        probe = document.addNodeDef(name, kind, category)
        for port in ports:
            probe.addInput(port.getName(), port.getType()).copyContentFrom(port)
        graph, source = document.addNodeGraph(f"NG_{PROBE}"), place[1]
        graph.copyContentFrom(place[0])
        for output in graph.getOutputs():
            graph.removeOutput(output.getName())
        for each in graph.getNodes():  # numbers do not depend on lobes
            if each.getType() in CLOSURES and kind not in CLOSURES:
                graph.removeNode(each.getName())
        graph.setNodeDefString(name)
        result = graph.addOutput("out", kind)
        if source.isA(mx.Output):
            result.copyContentFrom(source)
        else:
            graph.addNode("dot", PROBE, kind).addInput("in", kind).copyContentFrom(source)
            result.setNodeName(PROBE)
    single = place or len(definition.getActiveOutputs()) == 1
    node = document.addNode(category, "node", kind if single else "multioutput")
    node.setNodeDefString(name)
    for port in ports:
        kind, source = port.getType(), f"in_{port.getName()}"
        joined, inner = JOINED.get(kind, ("", kind))
        if inner in COMPONENTS:
            constant = document.addNode("constant", source, inner)
            constant.addInput("value", inner).setValueString(ZEROS[inner])
            if joined:
                fourth = document.addNode("constant", f"{source}_4", "float")
                fourth.setInputValue("value", 0.0)
                pair = document.addNode("combine2", f"{source}_both", kind)
                pair.addInput("in1", inner).setNodeName(source)
                pair.addInput("in2", "float").setNodeName(f"{source}_4")
                source = pair.getName()
            node.addInput(port.getName(), kind).setNodeName(source)
        elif kind == "filename":
            node.setInputValue(port.getName(), image, "filename")
        elif kind in LOBES:
            lobe = document.addNode(LOBES[kind], source, kind)
            node.addInput(port.getName(), kind).setNodeName(lobe.getName())
    return node


def finish(document: mx.Document, node: mx.Node) -> None:
    """Complete a node to a material."""
    if node.getType() != "surfaceshader":
        surface = document.addNode("surface", "shading", "surfaceshader")
        surface.addInput(node.getType().lower(), node.getType()).setNodeName(node.getName())
        node = surface
    material = document.addNode("surfacematerial", "look", "material")
    material.addInput("surfaceshader", "surfaceshader").setNodeName(node.getName())


def distance(own: Array, right: Array) -> float:
    """The largest difference, relative above 1, infinite if only one value is finite.

    For inputs outside [0, 1], the last half, only finite values count: graphs that agree in [0, 1] may differ for the
    root of a negative number.
    """
    with np.errstate(invalid="ignore"):
        error = np.abs(own - right) / np.maximum(1.0, np.abs(right))
    finite = np.isfinite(own), np.isfinite(right)
    error[finite[0] != finite[1]] = np.inf
    error[(own == right) | (np.isnan(own) & np.isnan(right))] = 0.0
    half = len(error) // 2
    error[half:][~(finite[0] & finite[1])[half:]] = 0.0
    return float(error.max())


def check_release(
    host: Host, library: str
) -> tuple[tuple[Result, ...], tuple[tuple[str, str], ...]]:
    """The result of comparing a library with the installed release, and the parts that are not judged."""
    release = released(library)
    if release is None:
        why = f"the library lacks nodes of MaterialX {mx.getVersionString()}: it is an older one"
        return (), ((f"{SUBJECT} of {library}", why),)
    comparison = Comparison(host, library, release)
    place = Result(RELEASE, CLAIM, SUBJECT, host.name, library, NOT_RUN)

    def measure(wrong: bool) -> Measurement:
        causes = [*comparison.definitions(wrong), *([] if wrong else comparison.nodes)]
        return Measurement(float(len(causes)), {})

    def diagnose() -> Diagnosis:
        causes = [*comparison.nodes, *comparison.definitions()]
        if more := newer(load_library(library), release):
            causes.append(Cause(Kind.DEFECT, "newer", more))
        return Diagnosis(tuple(causes), permitted=bool(more))

    variant = "the version of a node is 1234"
    result = judge(place, count_of(Quantity.DIFFERENCES), measure, variant, diagnose)
    return (result,), tuple(comparison.unjudged)
