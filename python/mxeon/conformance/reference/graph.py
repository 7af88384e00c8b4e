# SPDX-License-Identifier: Apache-2.0
"""Material graphs evaluated in NumPy, over all the points of a picture at once.

A graph may contain the lobes that have a model, with their combinations; emissions; images; the
operations of the standard library; and nodes that are nodegraphs of these, surface shaders among
them. Any other node is NotRun, with its name, unless it adds nothing: a lobe whose weight is 0
everywhere, or that a mix leaves out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property, partial
from operator import itemgetter
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.reference.images import lookup
from mxeon.conformance.reference.inner import VOLUMES, over_volume
from mxeon.conformance.reference.measured import CLOSURES, DRAWN, Measure
from mxeon.conformance.reference.nodes import (
    COMBINATIONS,
    LOBES,
    NOTHING,
    ShownLobe,
    combined,
    definition,
    node_lobe,
    plain,
)
from mxeon.conformance.reference.operations import OPERATIONS, Operation, Value, Values, fitted
from mxeon.conformance.reference.pbr_operations import UTILITIES, emissions
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.conformance.reference.walk import evaluated
from mxeon.errors import NotRun
from mxeon.io.srgb import srgb_decoded
from mxeon.models.core.layering import Bsdf
from mxeon.shaders.document.graphs import reachable

Path: TypeAlias = tuple[str, ...]  # see Graph
Step: TypeAlias = tuple[Callable[..., Value], tuple[Path, ...]]

# Where nothing is connected: black, and for a lobe zero, which hides nothing.
UNCONNECTED: dict[str, Value] = {
    "BSDF": NOTHING,
    "EDF": np.zeros(3),
    "surfaceshader": np.zeros(3),
    "VDF": None,
}
NUMBERS = ("float", "boolean", "integer")
DISTANCE = "distance"  # type of units
# A surface with its opacity and what it emits, or its lobes alone.
SURFACES: dict[bool, Operation] = {
    True: (("bsdf", "edf", "opacity"), lambda bsdf, edf, opacity: (bsdf.value + edf) * opacity),
    False: (("bsdf",), lambda bsdf: bsdf.value),
}
# Operations in which hosts differ: jumps and ties, and the arc functions of drivers. They are measured.
HOSTS_OWN = ("round", "floor", "ceil", "modulo", "asin", "acos")
# A surface that only emits.
UNLIT: Operation = (
    ("emission", "emission_color", "opacity"),
    lambda emission, color, opacity: emission * color * opacity,
)
# The same for light that is transmitted alone.
TRANSMITTED: dict[str, Operation] = {
    "surface": (("bsdf", "opacity"), lambda bsdf, opacity: bsdf.value * opacity),
    "surface_unlit": ((), lambda: np.zeros(3)),
}


class Graph:
    """A document's graph at the points of a picture.

    Parameters
    ----------
    document : MaterialX.Document
    points : ShadingPoints
    inputs : mapping of str to array
        Inputs of the surface shader, or of lobes where the document has none, that take the place
        of the document's.
    emits : bool
        Whether emission and opacity count.
    measure : callable or None
        Values of nodes, where one comes from a node without a function; see
        `mxeon.conformance.reference.measured`. None where such a node is NotRun.

    Attributes
    ----------
    measured : dict of str to None
        Names of the inputs whose values were measured, each behind the name of its node.
    lobes : list of ShownLobe
        Those that were evaluated.

    Notes
    -----
    A path names a node within the nodes and nodegraphs around it: a tuple of name paths, the
    outermost first.
    """

    def __init__(
        self,
        document: mx.Document,
        points: ShadingPoints,
        inputs: Mapping[str, ArrayLike] | None = None,
        emits: bool = True,
        measure: Measure | None = None,
    ) -> None:
        # Keep what is asked for.
        self._document = document
        self._points = points
        self._inputs = inputs or {}
        self._emits = emits
        self._measure = measure
        self.measured: dict[str, None] = {}
        self.lobes: list[ShownLobe] = []
        # Prepare what is found on the way.
        self._shader: Path | None = None  # the surface shader that is a nodegraph
        self._tops: list[Path] = []  # of layers: their throughputs are needed
        self._hiding: set[Path] = set()  # and those of what they are made of
        self._elements: dict[Path, mx.Element] = {(): document}
        self._steps: dict[Path, Step] = {}

    def element(self, name_path: str) -> Values:
        """Values of the renderable element at a name path, (N, 3).

        Raises
        ------
        NotRun
            If the graph holds a node that is none of the above.
        """
        element = self._document.getDescendant(name_path)
        graph = element.getParent()
        around = self._inner((), graph) if graph.isA(mx.NodeGraph) else ()
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # of values that another node leaves out
            if element.isA(mx.Output):
                path = self._connected(around, element)
            else:
                path = self._inner(around, element)
            self._parts([path])
            self._hiding.update(self._parts(self._tops))
            return np.asarray(fitted("color3", self._evaluate(path)), np.float64)

    def _parts(self, roots: Iterable[Path]) -> dict[Path, tuple[Path, ...]]:
        return reachable(roots, lambda path: self._step(path)[1])

    def _evaluate(self, root: Path) -> Value:
        return evaluated(root, self._parts([root]), lambda path: self._step(path)[0])

    def _step(self, path: Path) -> Step:
        """Function that computes the value at a path, and the paths of its arguments."""
        if path not in self._steps:
            self._steps[path] = self._node_step(path)
        return self._steps[path]

    def _node_step(self, path: Path) -> Step:
        node = self._elements[path]
        category, kind = node.getCategory(), node.getType()
        # Lobes, and what combines them.
        if category in LOBES:
            return self._lobe(path, node)
        if kind == "BSDF" and category in COMBINATIONS:
            return self._combination(path, node)
        # Numbers, colors and surfaces.
        if category == "image":
            return lookup(node, self._points.texcoord, self._linear), ()
        if category in self._operations and not (self._measure and category in HOSTS_OWN):
            ports, operation = self._operations[category]
            return partial(_computed, kind, operation), self._sources(path, ports)
        # A nodegraph that defines the node, or nothing of what has no weight.
        if kind == "surfaceshader" and self._shader is None:
            self._shader = path
        if inner := self._inside(path, node):
            return _same, (inner,)
        if kind == "BSDF" and not self._weighs(path, node):
            return lambda: NOTHING, ()
        raise NotRun(f"reference: there is no model for node {category!r}")

    @cached_property
    def _operations(self) -> dict[str, Operation]:
        """Nodes that compute numbers or colors, some of them by the points."""
        surfaces: dict[str, Operation] = {
            "surface": SURFACES[self._emits],
            "surface_unlit": UNLIT,
            "surfacematerial": (("surfaceshader",), _same),
        }
        if self._points.behind:
            surfaces |= TRANSMITTED
        return {**OPERATIONS, **UTILITIES, **VOLUMES, **emissions(self._points), **surfaces}

    def _inside(self, path: Path, node: mx.Node, output: str = "") -> Path | None:
        """Path of what an output of a node has in its nodegraph; None if that is none."""
        graph = node.getImplementation()
        outputs: Sequence[mx.Output] = (
            graph.getOutputs() if graph and graph.isA(mx.NodeGraph) else ()
        )
        named = [each for each in outputs if each.getName() == output] or outputs
        if len(named) != 1 or not named[0].getConnectedNode():
            return None
        return self._connected(path, named[0])

    def _weighs(self, path: Path, node: mx.Node) -> bool:
        """Whether a lobe without a model has a weight that is not 0 everywhere."""
        if not definition(node).getActiveInput("weight"):
            return True
        return bool(np.any(np.asarray(self._evaluate(self._source(path, "weight")))))

    def _lobe(self, path: Path, node: mx.Node) -> Step:
        names = tuple(port.getName() for port in definition(node).getActiveInputs())

        def lobe(*values: Values) -> Bsdf:
            inputs = dict(zip(names, values, strict=True))
            if np.any(inputs.get("weight", 1.0)):
                self.lobes.append(ShownLobe(node.getCategory(), inputs))
            return node_lobe(node, inputs, self._points, path in self._hiding)

        return lobe, self._sources(path, names)

    def _combination(self, path: Path, node: mx.Node) -> Step:
        """Step of a node that combines lobes; a mix leaves out what has no share."""
        category = node.getCategory()
        ports, operation = COMBINATIONS[category]
        # A mix leaves out what has no share.
        if category == "mix":
            share = self._evaluate(self._source(path, "mix"))
            for port, none in (("bg", 0.0), ("fg", 1.0)):
                if np.all(share == none):
                    return _same, self._sources(path, (port,))
        # A layer asks its top for a throughput; a volume below must be empty.
        if category == "layer":
            self._tops.append(self._source(path, "top"))
            if definition(node).getActiveInput("base").getType() != "BSDF":
                if self._points.behind:
                    return over_volume, self._sources(path, ports)
                if not self._points.round:
                    self._assert_empty(path)
                return _same, self._sources(path, ("top",))
        return partial(combined, node.getNamePath(), operation), self._sources(path, ports)

    def _assert_empty(self, path: Path) -> None:
        """Raise NotRun if the volume below a layer absorbs or scatters anything."""
        base = self._source(path, "base")
        volume = self._elements.get(base)
        for name in ("absorption", "scattering") if volume else ():
            if definition(volume).getActiveInput(name) is None:
                continue
            if np.any(np.asarray(self._evaluate(self._source(base, name)))):
                raise NotRun("reference: there is no model for a layer over a volume")

    def _sources(self, path: Path, names: tuple[str, ...]) -> tuple[Path, ...]:
        return tuple(self._source(path, name) for name in names)

    def _source(self, path: Path, name: str) -> Path:
        """Path of an input's value: of the node connected to it, or of a constant."""
        # Follow the interfaces around the node outwards.
        owner = path
        while not self._is_given(path, name):
            port = self._port(path, name)
            if not port.hasInterfaceName():
                break
            path, name = path[:-1], port.getInterfaceName()
        else:
            return self._constant(path, name, self._given(path, name))
        # Take what is connected, or else the value.
        if port.getConnectedNode():
            shown = f"{port.getParent().getName()}.{name}" if self._lights(owner, path) else ""
            return self._connected(path[:-1], port, shown)
        return self._constant(path, name, self._value(path, name, port))

    def _lights(self, path: Path, outer: Path) -> bool:
        """Whether a node, or one around it up to another path, scatters light or combines what does."""
        ends = range(len(outer), len(path) + 1)
        nodes = (self._elements.get(path[:end]) for end in ends)
        return any(node is not None and node.getType() in CLOSURES for node in nodes)

    def _is_given(self, path: Path, name: str) -> bool:
        """Whether one of the inputs that were handed in takes the place of a node's."""
        if name not in self._inputs:
            return False
        if self._shader is not None:
            return path == self._shader
        element = self._elements.get(path)
        return element is not None and element.getCategory() in LOBES

    def _given(self, path: Path, name: str) -> Values:
        """Value that was handed in, (N, 1) if it is one number for each point."""
        number = self._port(path, name).getType() in NUMBERS
        value = np.asarray(self._inputs[name])
        return np.reshape(value, (-1, 1)) if number else value

    def _connected(self, around: Path, port: mx.PortElement, shown: str = "") -> Path:
        """Path of what an input or output within another path is connected to.

        Where a value comes from a node without a function, and is an input that has a name as
        `shown`, all of it is measured.
        """
        # Find the node, inside this path or in a graph of the document.
        node, source = port.getConnectedNode(), port
        graph, scope = node.getParent(), port.getParent()
        if not port.getNodeName():
            source = port.getConnectedOutput()
        if port.isA(mx.Input):
            scope = scope.getParent()
        if graph.getNamePath() != scope.getNamePath():
            around = self._inner((), graph)
        path, output = self._inner(around, node), source.getOutputString()
        # Measure what cannot be computed.
        kind = port.getType()
        if not (shown and self._measure and kind in DRAWN):
            return self._output(path, output)
        try:
            found = self._output(path, output)
            self._parts([found])
        except NotRun:
            self.measured[shown] = None
            return self._measurement(path, kind, output)
        return found

    def _output(self, path: Path, output: str) -> Path:
        """Path of an output of a node: of several outputs, the one of that name."""
        node = self._elements[path]
        if node.getType() != "multioutput":
            return path
        if node.getCategory() in UTILITIES:
            part = (*path, f".{output}")
            self._steps[part] = itemgetter(output), (path,)
            return part
        if inner := self._inside(path, node, output):
            return inner
        raise NotRun(f"reference: there is no model for node {node.getCategory()!r}")

    def _measurement(self, path: Path, kind: str, output: str) -> Path:
        """Path of a node's value as the host has it."""
        assert self._measure is not None
        elements = [self._elements[path[:end]] for end in range(1, len(path) + 1)]
        part = (*path, f"={output}")
        self._steps[part] = partial(self._measure, elements, kind, output), ()
        return part

    def _value(self, path: Path, name: str, port: mx.Input) -> Value:
        """Value of an input without a connection, in the document's color space."""
        # A vector of the surface, if the definition says so.
        element = self._elements[path]
        nodedef = element.getNodeDef() if element.isA(mx.Node) else None
        declared = nodedef.getActiveInput(name) if nodedef else port
        if declared and declared.hasDefaultGeomPropString():  # nothing else sets it
            return self._points.geometry(declared.getDefaultGeomPropString())
        # The value that is written, or else the default.
        value = port.getValue()
        if value is None and declared:  # a connection that MaterialX ignores
            value = declared.getValue()
        if port.getType() in UNCONNECTED:
            return UNCONNECTED[port.getType()]
        constant = plain(value)
        if isinstance(constant, np.ndarray):
            if port.getType() == "color3":
                return self._linear(port, constant)
            if port.hasUnit():
                return constant * self._meters(port)
        return constant

    def _meters(self, port: mx.Input) -> float:
        """Factor from the unit of an input, a length, to that of shaders, which is a meter."""
        library = self._document.getDataLibrary() or self._document
        definition = library.getUnitTypeDef(DISTANCE)
        scales = mx.LinearUnitConverter.create(definition).getUnitScale() if definition else {}
        return float(scales.get(port.getUnit(), 1.0))

    def _port(self, path: Path, name: str) -> mx.Input:
        """Input of a node, or else of its nodedef."""
        element = self._elements.get(path)
        nodedef = element.getNodeDef() if element and path else None
        port = element and element.getInput(name)
        port = port or (nodedef and nodedef.getActiveInput(name))
        if not port:
            raise NotRun(f"reference: node {'/'.join(path[-1:])!r} has no input {name!r}")
        return port

    def _inner(self, around: Path, element: mx.Element) -> Path:
        """Path of an element within another path."""
        path = (*around, element.getNamePath())
        self._elements[path] = element
        return path

    def _constant(self, path: Path, name: str, value: Value) -> Path:
        """Path of a value that has no parts."""
        constant = (*path, f":{name}")
        self._steps[constant] = (lambda: value), ()
        return constant

    def _linear(self, element: mx.Element, value: Values) -> Values:
        """Color in the document's linear space, as the generators' color management has it."""
        space = element.getActiveColorSpace()
        if not self._document.getColorSpace():  # no color management
            return value
        if space in ("", "none", self._document.getColorSpace()):
            return value
        if space != "srgb_texture":
            raise NotRun(f"reference: there is no transform for color space {space!r}")
        return srgb_decoded(value)


def _same(value: Value) -> Value:
    return value


def _computed(kind: str, operation: Callable[..., Value], *values: Value) -> Value:
    return fitted(kind, operation(*values))
