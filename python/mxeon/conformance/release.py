# SPDX-License-Identifier: Apache-2.0
"""Compare definitions, units, graphs and sources of a library with the installed MaterialX release.

Other checks judge nodes with a model. For everything else, the release is the reference. If the
source code or graph of a node differs from the release, the node must have the values of the
release.

A library that lacks nodes of the release is an older version and is not compared. A library with
additional nodes in MaterialX's own documents may be a newer version, so differences of that library
are permitted.
"""

from collections.abc import Collection, Hashable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, TypeAlias

import MaterialX as mx
import numpy as np

from mxeon.conformance import check, spec
from mxeon.conformance.results import NOT_RUN, Cause, Diagnosis, Kind, Quantity, Result, grouped
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

# Baselines identify results by the subject, so the string SUBJECT must not change.
RELEASE, SUBJECT = "release", "definitions, units, graphs and texts"
CLAIM = "Parts without a model are as MaterialX released them, or have the same values."
SAMPLES = 64  # number of samples of a node's inputs
MOST = 12  # maximum number of evaluated nodes
SIZE = 24  # width of the pictures that compare lobes
MATERIALS = 3  # number of random materials in pictures of lobes
# Compared attributes of ports. Ranges only guide editors, so only eonlib's ranges are compared.
ATTRIBUTES = ("type", "defaultgeomprop", "uniform", "unit", "unittype", "colorspace", "enum")
RANGE = ("uimin", "uimax")
COMPONENTS = {"float": 1, "integer": 1, "boolean": 1, "vector2": 2, "color3": 3, "vector3": 3}
JOINED = {"color4": "color3", "vector4": "vector3"}  # four-component type -> three-component type
NUMBERS = {*COMPONENTS, *JOINED}  # types for which values are compared
SHADED = {"BSDF", "EDF", "surfaceshader"}  # types for which pictures are compared
SHADERS = {"surfaceshader", "volumeshader", "displacementshader"}  # types of unconnected inputs
# Scenes with a light, with an uneven environment, and with transparency.
UNEVEN = Client(radiance=sky_map(), irradiance=sky_map())
LIT_SCENES = (SIDE, CLIENT), (FURNACE, UNEVEN), (SIDE, Client(alpha=True))
PICTURES = tuple(replace(scene, size=SIZE, client=client) for scene, client in LIT_SCENES)
LOBES = {"BSDF": "burley_diffuse_bsdf", "EDF": "uniform_edf"}  # lobes connected to inputs, by type
# For each type, a constant value of inputs. A tangent must not be parallel to the normal.
ZEROS = {"float": "0", "integer": "0", "boolean": "false"}
ZEROS |= {"vector2": "0, 0", "color3": "0, 0, 0", "vector3": "0, 0, 1"}
TANGENT = "1, 0, 0"
PROBE = "mxeon_probe"  # name of a node that computes the value of a port
MODELLED = {(each.node, isinstance(each, utilities.UtilitySpec)) for each in ALL}
Place: TypeAlias = tuple[mx.GraphElement, mx.PortElement]  # a graph and a port in that graph


class Subject(NamedTuple):
    """An output of a node in a library, or a port inside the node's graph."""

    definition: mx.NodeDef
    library: str
    kind: str  # type of the output or the port
    place: Place | None = None  # the port, or None for an output of the node
    output: str = ""  # name of the output if the node has several outputs


def released(library: str) -> mx.Document | None:
    """The installed release, or None if the library lacks nodes of the release."""
    own = {each.getName() for each in load_library(library).getNodeDefs()}
    for release in (released_graphs.installed(), load_library("stock")):
        if own.issuperset(each.getName() for each in release.getNodeDefs()):
            return release
    return None


def newer_nodes(document: mx.Document, release: mx.Document) -> tuple[str, ...]:
    """Nodes in MaterialX's own documents that the release lacks or has in another version."""
    files = {Path(each.getActiveSourceUri()).name for each in release.getNodeDefs()}
    versions = {each.getName(): each.getVersionString() for each in release.getNodeDefs()}
    return tuple(
        each.getNodeString()
        for each in document.getNodeDefs()
        if versions.get(each.getName()) != each.getVersionString()
        and (each.getName() in versions or Path(each.getActiveSourceUri()).name in files)
    )


def definition_facts(
    definition: mx.NodeDef, reference: mx.NodeDef, attributes: Sequence[str] = ATTRIBUTES
) -> dict[str, str]:
    """Attributes of a definition, and of each port that `reference` has."""
    name = reference.getName()
    facts = {
        f"category of {name}": definition.getNodeString(),
        f"bsdf of {name}": definition.getAttribute("bsdf"),
        f"version of {name}": f"{definition.getVersionString()} {definition.getDefaultVersion()}",
    }
    for each in (*reference.getActiveInputs(), *reference.getActiveOutputs()):
        port = definition.getActiveValueElement(each.getName())
        place = f"{each.getName()} of {name}"
        if port is None:
            facts[place] = "missing"
            continue
        facts[f"the default of {place}"] = port_text(port)
        for attribute in attributes:
            facts[f"{attribute} of {place}"] = normalized(port.getAttribute(attribute))
    return facts


def unit_facts(document: mx.Document, release: mx.Document) -> dict[str, str]:
    """Attributes that a document gives to the units and geometric properties of the release."""
    names = [each.getName() for each in (*release.getUnitDefs(), *release.getGeomPropDefs())]
    definitions = [own for own in map(document.getChild, names) if own]
    return {
        f"{name} of {each.getCategory()} {each.getName()}": normalized(each.getAttribute(name))
        for definition in definitions
        for each in (definition, *definition.getChildren())
        for name in each.getAttributeNames()
        if name != "doc"
    }


def normalized(text: str) -> str:
    """The string with shortened numbers and without "false", because flags are false by default."""
    words = text.replace("false", "").replace(",", " ").split()
    with suppress(ValueError):
        words = [f"{float(word):g}" for word in words]
    return " ".join(words)


class Terms:
    """Assigns integers to ports of graphs. Ports with the same integer have equal values."""

    def __init__(self) -> None:
        self._numbers: dict[object, int] = {}
        self._nodes: dict[tuple[int, str], int] = {}

    def port(self, place: Place) -> int:
        graph, port = place
        if node := graph.getNode(port.getNodeName()):
            output = port.getOutputString() if node.getType() == "multioutput" else ""
            return self._number((self._node(graph, node), output))
        attributes = (port.getAttribute(each) for each in ATTRIBUTES)
        return self._number((port_text(port), *attributes))

    def _node(self, graph: mx.GraphElement, node: mx.Node) -> int:
        key = id(graph), node.getName()
        if key not in self._nodes:
            self._nodes[key] = -1  # ends the recursion for nodes that depend on themselves
            ports = {name: self.port((graph, port)) for name, port in ports_of(node).items()}
            kind = node.getCategory(), node.getType(), node.getNodeDefString()
            self._nodes[key] = self._number((*kind, *sorted(ports.items())))
        return self._nodes[key]

    def _number(self, key: object) -> int:
        return self._numbers.setdefault(key, len(self._numbers))


def differing_ports(terms: Terms, own: Place, released: Place) -> Iterator[tuple[Place, Place]]:
    """Pairs of ports at which two graphs differ. The inputs of equal lobes are compared."""
    if terms.port(own) == terms.port(released):
        return
    nodes = [graph.getNode(port.getNodeName()) for graph, port in (own, released)]
    if released[1].getType() in CLOSURES and all(nodes):
        inputs, expected = (ports_of(node) for node in nodes)
        if nodes[0].getCategory() == nodes[1].getCategory() and inputs.keys() == expected.keys():
            for name, port in inputs.items():
                places = (own[0], port), (released[0], expected[name])
                yield from differing_ports(terms, *places)
            return
    yield own, released


class Comparison:
    """Compares a library with the release. A host evaluates nodes whose source code differs."""

    only: Collection[str] = ()  # categories of the nodes to compare; () for all

    def __init__(self, host: Host, library: str, release: mx.Document, image: str) -> None:
        self._host, self._library, self._release, self._image = host, library, release, image
        self._document = load_library(library)
        self._target = generators.GENERATORS[host.target].create().getTarget()
        self.unjudged: list[tuple[str, str]] = []

    def _requested(self, *definitions: mx.NodeDef) -> list[mx.NodeDef]:
        return [each for each in definitions if not self.only or each.getNodeString() in self.only]

    def definitions(self, changed: bool = False) -> list[Cause]:
        """Differences from the release in definitions, units and properties.

        Nodes that eonlib defines are also compared with eonlib's definitions. If `changed`, a
        difference is added as a negative control.
        """
        release, eonlib = self._release, load_library("eonlib").getNodeDefs()
        additional = (each for each in eonlib if release.getNodeDef(each.getName()) != each)
        rows: list[str] = []
        for number, reference in enumerate(self._requested(*release.getNodeDefs(), *additional)):
            name = reference.getName()
            own, released = (each.getNodeDef(name) for each in (self._document, release))
            if own is None or (number and own in (reference, released)):
                continue
            attributes = ATTRIBUTES if released == reference else (*ATTRIBUTES, *RANGE)
            facts = definition_facts(own, reference, attributes)
            expected = definition_facts(reference, reference, attributes)
            if changed and number == 0:
                facts[f"version of {name}"] = "1234"
            if released:  # omitted ranges count as equal, because the release also omits ranges
                for each in facts:
                    if each.startswith(RANGE) and not facts[each]:
                        facts[each] = expected[each]
            rows += differences(facts, expected)
        if not self.only:
            rows += differences(*(unit_facts(each, release) for each in (self._document, release)))
        triples = dict.fromkeys(zip(rows[::3], rows[1::3], rows[2::3], strict=True))
        return [Cause(Kind.DEFECT, RELEASE, ("", *each)) for each in triples]

    @cached_property
    def nodes(self) -> list[Cause]:
        """Causes for nodes whose values differ from the values of the release.

        If several nodes differ by the same change of code or share a graph, only the first node
        with different values is reported.
        """
        names = (each.getName() for each in self._requested(*self._release.getNodeDefs()))
        groups = grouped(names, self._change)
        groups.pop(None, None)
        causes: list[Cause] = []
        remaining = list(groups.values())
        for _ in range(MOST):
            if not remaining:
                break
            name, *others = remaining.pop(0)
            cause = None
            try:
                cause = self._evaluated(name)
            except NotRun as error:
                self.unjudged.append((f"{self._target} of {name}", str(error)))
            except (ShaderError, DocumentError) as error:
                cause = Cause(Kind.TEXT, text=f"{name}: {error}")
            if cause:
                causes.append(replace(cause, of=1 + len(others)))
            elif others:
                remaining.append(others)
        if remaining:
            unevaluated = ", ".join(chain.from_iterable(remaining))
            reason = f"not evaluated: the limit of {MOST} different changes was reached"
            self.unjudged.append((unevaluated, reason))
        return causes

    def _pair(self, name: str) -> tuple[mx.NodeDef, mx.NodeDef, mx.Element, mx.Element]:
        own, released = (each.getNodeDef(name) for each in (self._document, self._release))
        return own, released, *(each.getImplementation(self._target) for each in (own, released))

    def _change(self, name: str) -> Hashable:
        """A key that is equal for nodes with the same change of code, or None to skip a node."""
        own, released, code, released_code = self._pair(name)
        if released_code is None:
            return None
        graphs = [bool(each) and each.isA(mx.NodeGraph) for each in (code, released_code)]
        if all(graphs):
            names = code.getName(), released_code.getName()  # versions of a node may share a graph
            return None if code == released_code else names
        if (released.getNodeString(), released.getType() not in CLOSURES) in MODELLED:
            return None
        if code is None or any(graphs):
            return name
        ports, expected = (each.getActiveInputs() for each in (own, released))
        if [each.getName() for each in ports] != [each.getName() for each in expected]:
            return name
        sides = (code, search_path(self._library)), (released_code, search_path("stock"))
        if texts.all_texts(*sides[0]) == texts.all_texts(*sides[1]):
            return None
        lines, expected_lines = (set(texts.used_texts(*each)) for each in sides)
        return frozenset(lines ^ expected_lines) or None

    def _evaluated(self, name: str) -> Cause | None:
        """The cause to report if the values of a node differ from the release, otherwise None."""
        own, released, code, released_code = self._pair(name)
        node, place = released.getNodeString(), f"{self._target} of {name}"
        text = "the one that MaterialX released"
        if code is None:
            return Cause(Kind.DEFECT, RELEASE, (node, place, "missing", text))
        if code.isA(mx.NodeGraph) and released_code.isA(mx.NodeGraph):
            graphs = code, released_code
            rows = differences(*(dict(released_graphs.facts(each)) for each in graphs))
            error = self._graph_error(own, *graphs)
        else:
            rows = place, "another text", text
            error = self._text_error(own, released)
        if error <= self.tolerance.value:
            return None
        return Cause(Kind.DEFECT, RELEASE, (node, *rows), (error,))

    def _graph_error(
        self, definition: mx.NodeDef, graph: mx.NodeGraph, released: mx.NodeGraph
    ) -> float:
        """The largest difference between two graphs' values, at ports where the graphs differ."""
        node, terms, error = Subject(definition, self._library, definition.getType()), Terms(), 0.0
        for released_output in released.getOutputs():
            output = graph.getOutput(released_output.getName())
            if output is None:
                return np.inf
            for places in differing_ports(terms, (graph, output), (released, released_output)):
                kind, expected = (port.getType() for _, port in places)
                # The normal and the tangent of the surface are only defined in a picture.
                vectors = any(port.getAttribute("defaultgeomprop") for _, port in places)
                if expected in CLOSURES or vectors:
                    whole = node._replace(place=(released, released.getOutputs()[0]))
                    error = max(error, self._picture_error(node, whole))
                elif expected not in NUMBERS or kind != expected:
                    return np.inf
                else:
                    ports = (node._replace(kind=kind, place=place) for place in places)
                    error = max(error, self._value_error(*ports))
        return error

    def _text_error(self, own: mx.NodeDef, released: mx.NodeDef) -> float:
        """The largest difference between two nodes' values. Raise NotRun if this is impossible."""
        outputs, inputs = released.getActiveOutputs(), released.getActiveInputs()
        kinds, input_kinds = ({port.getType() for port in ports} for ports in (outputs, inputs))
        sides = (own, self._library), (released, "stock")
        if self._release is not hidden():
            if kinds <= NUMBERS:
                error = 0.0
                for output in outputs:
                    name = output.getName() if len(outputs) > 1 else ""
                    ports = (Subject(*each, output.getType(), output=name) for each in sides)
                    error = max(error, self._value_error(*ports))
                return error
            if kinds <= SHADED and input_kinds.isdisjoint(SHADERS):
                return self._picture_error(*(Subject(*each, released.getType()) for each in sides))
        raise NotRun("its code is not MaterialX's, and no check evaluates it")

    def _value_error(self, own: Subject, released: Subject) -> float:
        try:
            expected = self._values(released)
        except (DocumentError, ShaderError) as error:
            raise NotRun(f"the released node cannot be evaluated: {error}") from None
        return largest_error(self._values(own), expected)

    def _values(self, subject: Subject) -> Array:
        """Values of an output or a port, (SAMPLES, 3), or (SAMPLES, 6) for four components."""
        values = []
        for fourth in (False, True) if subject.kind in JOINED else (False,):
            document = mx.createDocument()
            node = instance(document, subject, self._image)
            kind, output = subject.kind, subject.output
            if fourth:
                node = connected("extract", "part", "float", node, "in", kind, output)
                node.setInputValue("index", 3)
                kind, output = "float", ""
            convert = "dot" if kind == "color3" else "convert"
            color = connected(convert, "color", "color3", node, "in", kind, output)
            edf = connected("uniform_edf", "lobe", "EDF", color, "color", "color3")
            up = np.tile([0.0, 0.0, 1.0], (SAMPLES, 1))
            shader = self._compiled(document, edf, subject.library)
            values.append(self._host.evaluate(shader, up, up, samples(subject.definition), GRAPH))
        return np.concatenate(values, axis=1).astype(np.float64)

    def _picture_error(self, *subjects: Subject) -> float:
        """The largest difference between the pictures of two subjects, or infinity if one fails."""
        shaders: list[generation.Shader] = []
        try:
            for each in subjects:
                document = mx.createDocument()
                node = instance(document, each, self._image)
                shaders.append(self._compiled(document, node, each.library, ("hwTransparency",)))
        except MxeonError:
            return np.inf
        rng, error = generator(), 0.0
        for _ in range(MATERIALS):
            values: dict[str, float | tuple[float, ...]] = {}
            for port in shaders[0].inputs:
                if port.type == "float":
                    values[port.path] = float(rng.random())
                elif port.type == "color3":
                    values[port.path] = tuple(map(float, rng.random(3)))
            varied = []
            for shader in shaders:
                ports = (replace(p, value=values.get(p.path, p.value)) for p in shader.inputs)
                varied.append(replace(shader, inputs=tuple(ports)))
            for scene in PICTURES:
                own, released = (self._host.picture(each, scene).reshape(-1, 3) for each in varied)
                if not np.isfinite(released).any():
                    raise NotRun("its picture has no finite pixel")
                error = max(error, largest_error(own, released))
        return error

    def _compiled(
        self, document: mx.Document, node: mx.Node, library: str, client: tuple[str, ...] = ()
    ) -> generation.Shader:
        if (kind := node.getType()) != "surfaceshader":
            node = connected("surface", "shading", "surfaceshader", node, kind.lower(), kind)
        connected("surfacematerial", "look", "material", node, "surfaceshader", "surfaceshader")
        policy = Policy(outside=True)
        [shader] = self._host.compile(document, library=library, policy=policy, client=client)
        return shader

    @cached_property
    def tolerance(self) -> Tolerance:
        """The tolerance for differences between graphs that are mathematically equal."""
        base, exponent = float32(np.linspace(0.01, 1.0, SAMPLES)), float32(np.full(SAMPLES, 2.0))
        power = float(spec.POWER.errors(self._host, base, exponent).max())
        engine = Term(8.0 * power, "the engine's pow(), eight times")
        terms = roundings(64, "of the terms of a graph"), engine
        return sum_of(*terms, quantity=Quantity.OUTPUT)


def samples(definition: mx.NodeDef) -> dict[str, Array]:
    """Random values of the inputs of a definition, by path.

    The first half of the samples is in [0, 1]. All inputs of every third sample are equal, because
    a graph may compare inputs.
    """
    rng, inputs = generator(), {}
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
                inputs[f"in_{name}/value"] = float32(values)
    return inputs


def connected(
    category: str,
    name: str,
    kind: str,
    source: mx.Node,
    port: str,
    port_kind: str,
    output: str = "",
) -> mx.Node:
    """A new node in the document of `source`. The node's input `port` is connected to `source`."""
    node = source.getDocument().addNode(category, name, kind)
    connection = node.addInput(port, port_kind)
    connection.setNodeName(source.getName())
    if output:
        connection.setOutputString(output)
    return node


def instance(document: mx.Document, subject: Subject, image: str) -> mx.Node:
    """A new node that computes an output or a port. Inputs are connected to constants and lobes."""
    definition, kind, place = subject.definition, subject.kind, subject.place
    category, name = definition.getNodeString(), definition.getName()
    omitted = ("VDF",) if kind in CLOSURES else CLOSURES
    ports = [each for each in definition.getActiveInputs() if each.getType() not in omitted]
    if place:
        category, name = PROBE, f"ND_{PROBE}"
        probe = document.addNodeDef(name, kind, category)
        for port in ports:
            probe.addInput(port.getName(), port.getType()).copyContentFrom(port)
        graph, source = document.addNodeGraph(f"NG_{PROBE}"), place[1]
        graph.copyContentFrom(place[0])
        for output in graph.getOutputs():
            graph.removeOutput(output.getName())
        for each in graph.getNodes():  # numeric outputs cannot depend on lobes
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
            is_tangent = inner == "vector3" and "tangent" in port.getName()
            value = TANGENT if is_tangent else ZEROS[inner]
            constant.addInput("value", inner).setValueString(value)
            if kind in JOINED:
                document.addNode("constant", f"{source}_4", "float").setInputValue("value", 0.0)
                pair = connected("combine2", f"{source}_both", kind, constant, "in1", inner)
                pair.addInput("in2", "float").setNodeName(f"{source}_4")
                source = pair.getName()
            node.addInput(port.getName(), kind).setNodeName(source)
        elif kind == "filename":
            node.setInputValue(port.getName(), image, "filename")
        elif kind in LOBES:
            lobe = document.addNode(LOBES[kind], source, kind)
            node.addInput(port.getName(), kind).setNodeName(lobe.getName())
    return node


def largest_error(values: Array, expected: Array) -> float:
    """The largest error, which is relative for values above 1.

    The error is infinite if only one of two values is finite. In the last half of the rows, which
    have inputs outside [0, 1], only finite values count, because equivalent graphs may return
    different values for roots of negative numbers.
    """
    with np.errstate(invalid="ignore"):
        error = np.abs(values - expected) / np.maximum(1.0, np.abs(expected))
    finite = np.isfinite(values), np.isfinite(expected)
    error[finite[0] != finite[1]] = np.inf
    error[(values == expected) | (np.isnan(values) & np.isnan(expected))] = 0.0
    half = len(error) // 2
    error[half:][~(finite[0] & finite[1])[half:]] = 0.0
    return float(error.max())


def check_release(
    host: Host, library: str, nodes: Collection[str] = ()
) -> tuple[tuple[Result, ...], tuple[tuple[str, str], ...]]:
    """The result of comparing a library with the installed release, and subjects without a verdict.

    If `nodes` are given, only their definitions, graphs and source code are compared.
    """
    release = released(library)
    if release is None:
        why = f"the library lacks nodes of MaterialX {mx.getVersionString()}, so it is for an older version"
        return (), ((f"{SUBJECT} of {library}", why),)
    place = Result(RELEASE, CLAIM, SUBJECT, host.name, library, NOT_RUN)
    with TemporaryDirectory() as folder:
        image = str(Path(folder, "image.exr"))  # an image with four different channels
        write_exr(image, generator().random((8, 8, 4), np.float32), {})
        comparison = Comparison(host, library, release, image)
        comparison.only = nodes

        def measure(wrong: bool) -> Measurement:
            causes = [*comparison.definitions(wrong), *([] if wrong else comparison.nodes)]
            return Measurement(float(len(causes)), {})

        def diagnose() -> Diagnosis:
            causes = [*comparison.nodes, *comparison.definitions()]
            if newer := newer_nodes(load_library(library), release):
                causes.append(Cause(Kind.DEFECT, "newer", newer))
            return Diagnosis(tuple(causes), permitted=bool(newer))

        variant = "the version of a node is 1234"
        result = check.judge(place, count_of(Quantity.DIFFERENCES), measure, variant, diagnose)
    return (result,), tuple(comparison.unjudged)
