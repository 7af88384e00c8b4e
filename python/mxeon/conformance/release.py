# SPDX-License-Identifier: Apache-2.0
"""Compares definitions, units, graphs and texts of a library with the installed MaterialX release.

Nodes with a model are judged by their model. For everything else, the release is the reference:
nodes written differently are evaluated for the same inputs and must have the same values. A library
that lacks nodes of the release is an older version and is not compared. A library with additional
nodes in MaterialX's own documents may be a newer version, so its differences are permitted.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, TypeAlias

import MaterialX as mx
import numpy as np

from mxeon.conformance import check, spec
from mxeon.conformance.results import NOT_RUN, Cause, Diagnosis, Kind, Quantity, Result
from mxeon.conformance.samples import Array, float32, generator, sky_map
from mxeon.conformance.specs import ALL, utilities
from mxeon.conformance.tolerance import Measurement, Term, Tolerance, count_of, roundings, sum_of
from mxeon.errors import DocumentError, MxeonError, NotRun, ShaderError
from mxeon.hosts.base import Host
from mxeon.hosts.calls import GRAPH
from mxeon.io.images import write_exr
from mxeon.shaders import generation, generators, released_graphs, texts
from mxeon.shaders.document.drawn_values import CLOSURES
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.library import load_library
from mxeon.shaders.library_tree import search_path
from mxeon.shaders.released_graphs import differences, hidden, port_text, ports_of
from mxeon.shaders.scene import CLIENT, FURNACE, SIDE, Client

RELEASE, SUBJECT = "release", "definitions, units, graphs and texts"
CLAIM = "What has no model is as MaterialX released it, or has the same values."
SAMPLES = 64  # number of samples of a node's inputs
MOST = 12  # maximum number of evaluated nodes
SIZE, PICTURED = 24, 3  # size and number of pictures that compare rearranged lobes
# Compared attributes of ports. Ranges, which only guide editors, are compared for eonlib's nodes.
ATTRIBUTES = ("type", "defaultgeomprop", "uniform", "unit", "unittype", "colorspace", "enum")
RANGE = ("uimin", "uimax")
COMPONENTS = {"float": 1, "integer": 1, "boolean": 1, "vector2": 2, "color3": 3, "vector3": 3}
JOINED = {"color4": "color3", "vector4": "vector3"}  # four-component type -> three-component type
NUMBERS = (*COMPONENTS, *JOINED)  # types that are compared by values
SHADED = ("BSDF", "EDF", "surfaceshader")  # types that are compared by pictures
SHADERS = ("surfaceshader", "volumeshader", "displacementshader")  # inputs left unconnected
ALPHA = ("hwTransparency",)  # option that adds an alpha to shaders
# Scenes with a light, with an uneven environment, and with alpha.
UNEVEN = Client(radiance=sky_map(), irradiance=sky_map())
LIT_SCENES = (SIDE, CLIENT), (FURNACE, UNEVEN), (SIDE, Client(alpha=True))
PICTURES = tuple(replace(scene, size=SIZE, client=client) for scene, client in LIT_SCENES)
LOBES = {"BSDF": "burley_diffuse_bsdf", "EDF": "uniform_edf"}  # lobes connected to inputs, by type
# Constant values of inputs by type; a tangent must not be along the normal.
ZEROS = {"float": "0", "integer": "0", "boolean": "false"}
ZEROS |= {"vector2": "0, 0", "color3": "0, 0, 0", "vector3": "0, 0, 1"}
TANGENT = "1, 0, 0"
PROBE = "mxeon_probe"
MODELLED = {(each.node, isinstance(each, utilities.UtilitySpec)) for each in ALL}
Place: TypeAlias = tuple[mx.GraphElement, mx.PortElement]  # a graph and one of its ports


class Subject(NamedTuple):
    """An output of a library's node, or a graph's port that replaces it and keeps its inputs."""

    definition: mx.NodeDef
    library: str
    kind: str  # type of the output
    place: Place | None = None
    output: str = ""  # name of the output, if there are several


def released(library: str) -> mx.Document | None:
    """The installed release, or None if the library lacks some of its nodes."""
    own = {each.getName() for each in load_library(library).getNodeDefs()}
    for release in (released_graphs.installed(), load_library("stock")):
        if own.issuperset(each.getName() for each in release.getNodeDefs()):
            return release
    return None


def newer(document: mx.Document, release: mx.Document) -> tuple[str, ...]:
    """Nodes in MaterialX's own documents that the release lacks, or has in another version."""
    known = {Path(each.getActiveSourceUri()).name for each in release.getNodeDefs()}
    found = []
    for each in document.getNodeDefs():
        right, own = release.getNodeDef(each.getName()), Path(each.getActiveSourceUri()).name
        if right.getVersionString() != each.getVersionString() if right else own in known:
            found.append(each.getNodeString())
    return tuple(found)


def definition_facts(
    own: mx.NodeDef, right: mx.NodeDef, attributes: Sequence[str] = ATTRIBUTES
) -> dict[str, str]:
    name = right.getName()
    found = {
        f"category of {name}": own.getNodeString(),
        f"bsdf of {name}": own.getAttribute("bsdf"),
        f"version of {name}": f"{own.getVersionString()} {own.getDefaultVersion()}",
    }
    for each in (*right.getActiveInputs(), *right.getActiveOutputs()):
        port, place = own.getActiveValueElement(each.getName()), f"{each.getName()} of {name}"
        if port is None:
            found[place] = "missing"
            continue
        found[f"the default of {place}"] = port_text(port)
        for fact in attributes:
            found[f"{fact} of {place}"] = one_spelling(port.getAttribute(fact))
    return found


def unit_facts(document: mx.Document, release: mx.Document) -> dict[str, str]:
    names = [each.getName() for each in (*release.getUnitDefs(), *release.getGeomPropDefs())]
    return {
        f"{fact} of {element.getCategory()} {element.getName()}": one_spelling(
            element.getAttribute(fact)
        )
        for own in filter(None, map(document.getChild, names))
        for element in (own, *own.getChildren())
        for fact in element.getAttributeNames()
        if fact != "doc"
    }


def one_spelling(text: str) -> str:
    """Text with numbers in their shortest form, and without "false", an omitted flag's value."""
    words = text.replace("false", "").replace(",", " ").split()
    with suppress(ValueError):
        words = [f"{float(word):g}" for word in words]
    return " ".join(words)


class Terms:
    """Assigns numbers to the terms of graphs; terms with equal numbers have equal values."""

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
            self._nodes[key] = -1  # ends the recursion of nodes that depend on themselves
            ports = {name: self.port((graph, port)) for name, port in ports_of(node).items()}
            kind = node.getCategory(), node.getType(), node.getNodeDefString()
            self._nodes[key] = self._number((*kind, *sorted(ports.items())))
        return self._nodes[key]

    def _number(self, key: object) -> int:
        return self._numbers.setdefault(key, len(self._numbers))


def apart(terms: Terms, own: Place, right: Place) -> Iterator[tuple[Place, Place]]:
    """Pairs of ports at which two graphs differ: inputs of equal lobes, or different lobes."""
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

    def __init__(self, host: Host, library: str, release: mx.Document, image: str) -> None:
        self._host, self._library, self._release, self._image = host, library, release, image
        self._document = load_library(library)
        self._target = generators.GENERATORS[host.target].create().getTarget()
        self.unjudged: list[tuple[str, str]] = []

    def definitions(self, changed: bool = False) -> list[Cause]:
        """Differences of definitions, units and properties; `changed` adds one, as a control.

        Nodes that eonlib defines are also compared with eonlib's definitions.
        """
        defined, release = load_library("eonlib").getNodeDefs(), self._release
        ours = (each for each in defined if release.getNodeDef(each.getName()) != each)
        rows: list[str] = []
        for number, right in enumerate((*self._release.getNodeDefs(), *ours)):
            name = right.getName()
            own, released = (each.getNodeDef(name) for each in (self._document, self._release))
            if own is None or (number and own in (right, released)):
                continue
            attributes = ATTRIBUTES if released == right else (*ATTRIBUTES, *RANGE)
            found, expected = (definition_facts(each, right, attributes) for each in (own, right))
            if changed and number == 0:
                found[f"version of {name}"] = "1234"
            # An omitted range is no difference, because the release omits some of its own.
            omitted = (each for each in found if each.startswith(RANGE) and not found[each])
            left_out = {each: expected[each] for each in omitted} if released else {}
            rows += differences(found | left_out, expected)
        rows += differences(*(unit_facts(each, release) for each in (self._document, release)))
        apart = dict.fromkeys(zip(*[iter(rows)] * 3, strict=True))
        return [Cause(Kind.DEFECT, RELEASE, ("", *row)) for row in apart]

    @cached_property
    def nodes(self) -> list[Cause]:
        """Causes for nodes whose values differ from those of the released graph or text.

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
            cause = None
            try:
                cause = self._evaluated(name)
            except NotRun as error:
                self.unjudged.append((f"{self._target} of {name}", str(error)))
            except (ShaderError, DocumentError) as error:
                cause = Cause(Kind.TEXT, text=f"{name}: {error}")
            if cause:
                found.append(replace(cause, of=1 + len(others)))
            elif others:
                left.append(others)
        if left:
            names = ", ".join(name for group in left for name in group)
            reason = f"written differently, and {MOST} others with other changes were evaluated"
            self.unjudged.append((names, reason))
        return found

    def _pair(self, name: str) -> tuple[mx.NodeDef, mx.NodeDef, mx.Element, mx.Element]:
        own, right = (each.getNodeDef(name) for each in (self._document, self._release))
        return own, right, *(each.getImplementation(self._target) for each in (own, right))

    def _change(self, name: str) -> object:
        """A key for how a node differs from the release; None if it is equal or has a model."""
        own, right, ours, theirs = self._pair(name)
        if theirs is None or (ours is not None and ours == theirs and ours.isA(mx.NodeGraph)):
            return None
        graphs = [bool(each) and each.isA(mx.NodeGraph) for each in (ours, theirs)]
        if all(graphs):
            return name
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

    def _evaluated(self, name: str) -> Cause | None:
        """The cause to report if a node's values differ from the release's, otherwise None."""
        own, right, ours, theirs = self._pair(name)
        node = right.getNodeString()
        if ours is not None and ours.isA(mx.NodeGraph) and theirs.isA(mx.NodeGraph):
            rows = differences(
                dict(released_graphs.facts(ours)), dict(released_graphs.facts(theirs))
            )
            error = self._graphs_apart(own, ours, theirs)
        else:
            rows = f"{self._target} of {name}", "another text", "the one that MaterialX released"
            if ours is None:
                return Cause(Kind.DEFECT, RELEASE, (node, rows[0], "missing", rows[2]))
            error = self._texts_apart(own, right)
        if error <= self.tolerance.value:
            return None
        return Cause(Kind.DEFECT, RELEASE, (node, *rows), (error,))

    def _graphs_apart(
        self, definition: mx.NodeDef, ours: mx.NodeGraph, theirs: mx.NodeGraph
    ) -> float:
        """The largest difference between two graphs' values, at ports whose terms differ."""
        node, terms, error = Subject(definition, self._library, definition.getType()), Terms(), 0.0
        for output in theirs.getOutputs():
            other = ours.getOutput(output.getName())
            if other is None:
                return np.inf
            for one, two in apart(terms, (ours, other), (theirs, output)):
                kind = two[1].getType()
                # The surface's own vectors are only known in a picture.
                vectors = any(port.getAttribute("defaultgeomprop") for _, port in (one, two))
                if kind in CLOSURES or vectors:
                    place = theirs, theirs.getOutputs()[0]
                    error = max(error, self._pictures_apart(node, node._replace(place=place)))
                elif kind not in NUMBERS or one[1].getType() != kind:
                    return np.inf
                else:
                    ports = (node._replace(kind=kind, place=place) for place in (one, two))
                    error = max(error, self._values_apart(*ports))
        return error

    def _texts_apart(self, own: mx.NodeDef, right: mx.NodeDef) -> float:
        """The largest difference between two texts' values; NotRun if nothing evaluates them."""
        outputs = right.getActiveOutputs()
        kinds, inputs = ({p.getType() for p in each} for each in (outputs, right.getActiveInputs()))
        sides = (own, self._library), (right, "stock")
        if kinds <= {*NUMBERS} and self._release is not hidden():
            error = 0.0
            for output in outputs:
                kind, name = output.getType(), output.getName() * (len(outputs) > 1)
                ports = (Subject(*each, kind, output=name) for each in sides)
                error = max(error, self._values_apart(*ports))
            return error
        if kinds <= {*SHADED} and inputs.isdisjoint(SHADERS) and self._release is not hidden():
            return self._pictures_apart(*(Subject(*each, right.getType()) for each in sides))
        raise NotRun("its text is not MaterialX's, and nothing evaluates it")

    def _values_apart(self, own: Subject, right: Subject) -> float:
        """The largest difference of two subjects' values; NotRun if `right` does not compile."""
        try:
            expected = self._values(right)
        except (DocumentError, ShaderError) as error:
            raise NotRun(f"the released one cannot be evaluated: {error}") from None
        return distance(self._values(own), expected)

    def _values(self, subject: Subject) -> Array:
        """Values of a subject, (SAMPLES, 3), or (SAMPLES, 6) with a fourth component."""
        found = []
        for index in ("", "3") if subject.kind in JOINED else ("",):
            document = mx.createDocument()
            node = instance(document, subject, self._image)
            kind, output = subject.kind, subject.output
            if index:
                part = document.addNode("extract", "part", "float")
                part.setInputValue("index", int(index))
                part.addInput("in", kind).setNodeName(node.getName())
                node, kind, output = part, "float", ""
            color = document.addNode("dot" if kind == "color3" else "convert", "color", "color3")
            port = color.addInput("in", kind)
            port.setNodeName(node.getName())
            if output:
                port.setOutputString(output)
            edf = document.addNode("uniform_edf", "lobe", "EDF")
            edf.addInput("color", "color3").setNodeName("color")
            up = np.tile([0.0, 0.0, 1.0], (SAMPLES, 1))
            shader = self._compiled(document, edf, subject.library)
            found.append(self._host.evaluate(shader, up, up, samples(subject.definition), GRAPH))
        return np.concatenate(found, axis=1).astype(np.float64)

    def _pictures_apart(self, *subjects: Subject) -> float:
        """The largest difference between pictures, alpha included; infinity without a picture."""
        shaders: list[generation.Shader] = []
        try:
            for each in subjects:
                document = mx.createDocument()
                node = instance(document, each, self._image)
                shaders.append(self._compiled(document, node, each.library, client=ALPHA))
        except MxeonError:
            return np.inf
        rng, error = generator(), 0.0
        for _ in range(PICTURED):
            drawn: dict[str, float | tuple[float, ...]] = {}
            for port in shaders[0].inputs:
                if port.type == "float":
                    drawn[port.path] = float(rng.random())
                elif port.type == "color3":
                    drawn[port.path] = tuple(map(float, rng.random(3)))
            varied = []
            for shader in shaders:
                ports = (replace(p, value=drawn.get(p.path, p.value)) for p in shader.inputs)
                varied.append(replace(shader, inputs=tuple(ports)))
            for scene in PICTURES:
                own, right = (self._host.picture(each, scene).reshape(-1, 3) for each in varied)
                if not np.isfinite(right).any():
                    raise NotRun("its picture has no finite pixel")
                error = max(error, distance(own, right))
        return error

    def _compiled(
        self, document: mx.Document, node: mx.Node, library: str, client: tuple[str, ...] = ()
    ) -> generation.Shader:
        """Shader of a node, completed to a material."""
        if node.getType() != "surfaceshader":
            surface = document.addNode("surface", "shading", "surfaceshader")
            surface.addInput(node.getType().lower(), node.getType()).setNodeName(node.getName())
            node = surface
        material = document.addNode("surfacematerial", "look", "material")
        material.addInput("surfaceshader", "surfaceshader").setNodeName(node.getName())
        policy = Policy(outside=True)
        [shader] = self._host.compile(document, library=library, policy=policy, client=client)
        return shader

    @cached_property
    def tolerance(self) -> Tolerance:
        """The tolerance for the values of one graph that is written in two ways."""
        base, exponent = float32(np.linspace(0.01, 1.0, SAMPLES)), float32(np.full(SAMPLES, 2.0))
        power = float(spec.POWER.errors(self._host, base, exponent).max())
        engine = Term(8.0 * power, "the engine's pow(), eight times")
        terms = roundings(64, "of the terms of a graph"), engine
        return sum_of(*terms, quantity=Quantity.OUTPUT)


def samples(definition: mx.NodeDef) -> dict[str, Array]:
    """Values of a definition's inputs, by the paths of their sources; the first half is in [0, 1].

    In every third row, all inputs are equal, since a graph may compare them.
    """
    rng, found = generator(), {}
    equal = rng.random((SAMPLES, 1))
    for port in definition.getActiveInputs():
        kind = JOINED.get(port.getType(), port.getType())
        for name, each in ((port.getName(), kind), (f"{port.getName()}_4", "float")):
            if each in COMPONENTS:
                values = rng.random((SAMPLES, COMPONENTS[each]))
                values[SAMPLES // 2 :] = 4.0 * values[SAMPLES // 2 :] - 1.5
                values[::3] = equal[::3]
                if each in ("integer", "boolean"):
                    values = np.floor(values * 2.0).clip(0.0)
                found[f"in_{name}/value"] = float32(values)
    return found


def instance(document: mx.Document, subject: Subject, image: str) -> mx.Node:
    """A node that computes a subject, with a separate node connected to each input."""
    definition, kind, place = subject.definition, subject.kind, subject.place
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
        for each in graph.getNodes():  # numbers cannot depend on lobes
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
        inner = JOINED.get(kind, kind)
        if inner in COMPONENTS:
            constant = document.addNode("constant", source, inner)
            along = inner == "vector3" and "tangent" in port.getName()
            value = TANGENT if along else ZEROS[inner]
            constant.addInput("value", inner).setValueString(value)
            if kind in JOINED:
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


def distance(own: Array, right: Array) -> float:
    """The largest difference: relative for values above 1, infinite if only one value is finite.

    In the last half of the rows, with inputs outside [0, 1], only finite values count: graphs that
    agree in [0, 1] may differ for the root of a negative number.
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
    """The result of comparing a library with the installed release, and the parts not judged."""
    release = released(library)
    if release is None:
        why = f"the library lacks nodes of MaterialX {mx.getVersionString()}: it is an older one"
        return (), ((f"{SUBJECT} of {library}", why),)
    place = Result(RELEASE, CLAIM, SUBJECT, host.name, library, NOT_RUN)
    with TemporaryDirectory() as folder:
        image = str(Path(folder, "image.exr"))  # image with four different channels
        write_exr(image, generator().random((8, 8, 4), np.float32), {})
        comparison = Comparison(host, library, release, image)

        def measure(wrong: bool) -> Measurement:
            causes = [*comparison.definitions(wrong), *([] if wrong else comparison.nodes)]
            return Measurement(float(len(causes)), {})

        def diagnose() -> Diagnosis:
            causes = [*comparison.nodes, *comparison.definitions()]
            if more := newer(load_library(library), release):
                causes.append(Cause(Kind.DEFECT, "newer", more))
            return Diagnosis(tuple(causes), permitted=bool(more))

        variant = "the version of a node is 1234"
        result = check.judge(place, count_of(Quantity.DIFFERENCES), measure, variant, diagnose)
    return (result,), tuple(comparison.unjudged)
