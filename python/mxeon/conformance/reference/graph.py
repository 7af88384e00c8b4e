# SPDX-License-Identifier: Apache-2.0
"""Evaluates material graphs in NumPy, for all points of a picture at once.

A graph may contain lobes with a model, nodes that combine lobes, emissions, images, operations that
surface shaders use, and nodes that MaterialX defines by nodegraphs of such nodes. Any other node
raises NotRun, unless a mix skips the node.

A path names a node inside nested nodegraphs. A step is a function and the paths of its arguments.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property, partial
from graphlib import TopologicalSorter
from math import prod
from operator import itemgetter
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.reference import nodes
from mxeon.conformance.reference.nodes import LOBES, ShadingPoints, Value, plain, same
from mxeon.conformance.samples import Array
from mxeon.errors import NotRun, OutsideModel
from mxeon.hosts.textures import texels_at
from mxeon.io.srgb import srgb_decoded
from mxeon.models.core.layering import Bsdf
from mxeon.models.nodes import emissions, utilities
from mxeon.shaders.document import drawn_values, graphs
from mxeon.shaders.document.values import color_spaces
from mxeon.shaders.inner_lobes import Nodes, Path

# Types that a generated shader can draw as a color, and the number of components of each type.
DRAWN = {"float": 1, "integer": 1, "vector2": 2, "color3": 3, "vector3": 3}
# A function that draws an output on a host. Arguments are nested elements, a type and a name.
Measure: TypeAlias = Callable[[drawn_values.Elements, str, str], Array]
Step: TypeAlias = tuple[Callable[..., Value], tuple[Path, ...]]

# Values of unconnected inputs by type.
UNCONNECTED: dict[str, Value] = {"BSDF": nodes.NOTHING, "VDF": None}
UNCONNECTED |= dict.fromkeys(("EDF", "surfaceshader"), np.zeros(3))
CHANNELS = {"float": 1, "color3": 3}  # number of channels of an image by the image node's type
UTILITIES = {row.category: row for row in utilities.UTILITIES}


class Graph(Nodes):
    """The graph of a document, evaluated at the points of a picture."""

    def __init__(
        self,
        document: mx.Document,
        points: ShadingPoints,
        inputs: Mapping[str, ArrayLike] | None = None,  # values that replace document values
        emits: bool = True,  # whether values include emission and opacity
        measure: Measure | None = None,  # values of unsupported nodes, or None to raise NotRun
    ) -> None:
        super().__init__()
        self._document, self._points, self._inputs = document, points, inputs or {}
        self._emits, self._measure = emits, measure
        self.measured: dict[str, None] = {}  # inputs with values from `measure`, as "node.input"
        self.lobes: list[nodes.ShownLobe] = []
        self._shader: Path | None = None  # surface shader, if defined by a nodegraph
        self._tops: list[Path] = []  # upper lobes of layers, whose throughputs are needed
        self._hiding: set[Path] = set()  # upper lobes of layers, and all sources of these lobes
        self._steps: dict[Path, Step] = {}

    def element(self, name_path: str) -> Array:
        """Value of the renderable element with the given name path, (N, 3).

        Raise NotRun if the graph contains an unsupported node.
        """
        # A node may select a finite value and ignore values that are not finite.
        with np.errstate(divide="ignore", invalid="ignore"):
            path = self._root(name_path)
            self._parts([path])
            self._hiding.update(self._parts(self._tops))
            return np.asarray(nodes.fitted("color3", self._evaluate(path)), np.float64)

    def patterns(self, name_path: str) -> Iterator[tuple[list[mx.Element], Array]]:
        """Drawable nodes on which an element depends, with their values, sources before users."""
        order = TopologicalSorter(self._parts([self._root(name_path)])).static_order()
        for path in [each for each in order if each in self.elements]:
            if self.elements[path].isA(mx.Node) and self.elements[path].getType() in DRAWN:
                yield self._along(path), np.asarray(self._evaluate(path))

    def _root(self, name_path: str) -> Path:
        element = self._document.getDescendant(name_path)
        graph = element.getParent()
        around = self.path((), graph) if graph.isA(mx.NodeGraph) else ()
        return (self._connected if element.isA(mx.Output) else self.path)(around, element)

    def _parts(self, roots: Iterable[Path]) -> dict[Path, tuple[Path, ...]]:
        return graphs.reachable(roots, lambda path: self._step(path)[1])

    def _evaluate(self, root: Path) -> Value:
        """Value at a path. Each node is evaluated once, without recursion."""
        parts = self._parts([root])
        uses = Counter(part for inner in parts.values() for part in inner)
        values: dict[Path, Value] = {}
        for key in TopologicalSorter(parts).static_order():
            values[key] = self._step(key)[0](*(values[part] for part in parts[key]))
            uses.subtract(parts[key])
            for part in set(parts[key]):
                if not uses[part]:
                    del values[part]
        return values[root]

    def _step(self, path: Path) -> Step:
        if path not in self._steps:
            self._steps[path] = self._node_step(path)
        return self._steps[path]

    def _node_step(self, path: Path) -> Step:
        node = self.elements[path]
        category, kind = node.getCategory(), node.getType()
        if category in LOBES:
            return self._lobe(path, node)
        if kind == "BSDF" and category in nodes.COMBINATIONS:
            return self._combination(path, node)
        if category == "image":
            value = self._image(node)
            return lambda: value, ()
        if category in self._operations:
            ports, operation = self._operations[category]
            sources = self._sources(path, ports)
            return partial(_applied, node, operation), sources
        if kind == "surfaceshader" and self._shader is None:
            self._shader = path
        return same, (self._inside(path, node),)

    @cached_property
    def _operations(self) -> dict[str, nodes.Operation]:
        """Input names and function of each node that computes numbers, colors or light."""
        known = nodes.OPERATIONS | nodes.VOLUMES | {"surfacematerial": (("surfaceshader",), same)}
        for row in emissions.EMISSIONS:
            ports = tuple("base" if name == emissions.BASE else name for name in row.inputs)
            known[row.category] = ports, partial(_radiance, row, ports, self._points)
        for utility in UTILITIES.values():
            known[utility.category] = tuple(utility.inputs), partial(_utility, utility)
        emits = self._emits and not self._points.behind

        def surface(bsdf: Bsdf, opacity: float | Array = 1.0, edf: float | Array = 0.0) -> Array:
            return np.asarray((bsdf.value + edf) * opacity, np.float64)

        ports = ("bsdf", "opacity", "edf")  # later ports are omitted unless requested
        known["surface"] = ports[: 1 + self._emits + emits], surface
        unlit = ("emission", "emission_color", "opacity")
        known["surface_unlit"] = unlit, lambda *values: prod(values) * (not self._points.behind)
        return known

    def _inside(self, path: Path, node: mx.Node, output: str = "") -> Path:
        """Path of the source of an output, inside the nodegraph that defines a node."""
        graph = node.getImplementation()
        outputs = graph.getOutputs() if graph and graph.isA(mx.NodeGraph) else []
        found = [each for each in outputs if each.getName() == output] or outputs
        if len(found) == 1 and found[0].getConnectedNode():
            return self._connected(path, found[0])
        raise NotRun(f"reference: there is no model for node {node.getCategory()!r}")

    def _lobe(self, path: Path, node: mx.Node) -> Step:
        names = tuple(port.getName() for port in node.getNodeDef().getActiveInputs())

        def lobe(*values: Array) -> Bsdf:
            inputs = dict(zip(names, values, strict=True))
            if np.any(inputs.get("weight", 1.0)):
                self.lobes.append(nodes.ShownLobe(node.getCategory(), inputs))
            return nodes.node_lobe(node, inputs, self._points, path in self._hiding)

        return lobe, self._sources(path, names)

    def _combination(self, path: Path, node: mx.Node) -> Step:
        category = node.getCategory()
        ports, operation = nodes.COMBINATIONS[category]
        if category == "mix":  # skip a lobe whose share is 0
            share = self._evaluate(self._source(path, "mix"))
            for port, none in (("bg", 0.0), ("fg", 1.0)):
                if np.all(share == none):
                    return same, self._sources(path, (port,))
        if category == "layer":
            self._tops.append(self._source(path, "top"))
            if node.getNodeDef().getActiveInput("base").getType() != "BSDF":
                if not self._points.behind:  # a volume attenuates only transmitted light
                    return same, self._sources(path, ("top",))

                def dimmed(top: Bsdf, medium: Array | None) -> Bsdf:
                    passed = 1.0 if medium is None else medium
                    return Bsdf(top.value * passed, top.throughput * passed)

                return dimmed, self._sources(path, ports)

        return partial(_applied, node, operation), self._sources(path, ports)

    def _sources(self, path: Path, names: tuple[str, ...]) -> tuple[Path, ...]:
        return tuple(self._source(path, name) for name in names)

    def _source(self, path: Path, name: str) -> Path:
        owner = path
        while (replaced := self._replaced(path, name)) is None:
            port = self._port(path, name)
            if not port.hasInterfaceName():
                break
            path, name = path[:-1], port.getInterfaceName()
        else:
            return self._constant(path, name, replaced)
        if not port.getConnectedNode():
            return self._constant(path, name, self._written(path, name, port))
        # Only inputs of lobes, and of nodes that contain lobes, may be drawn by the host.
        scatters = any(each.getType() in drawn_values.CLOSURES for each in self._along(owner, path))
        label = f"{port.getParent().getName()}.{name}" if scatters else ""
        return self._connected(path[:-1], port, label)

    def _replaced(self, path: Path, name: str) -> Array | None:
        """The caller's replacement for an input's value, (N, 1) for a number, or None."""
        lobe = path in self.elements and self.elements[path].getCategory() in LOBES
        if name not in self._inputs or not (path == self._shader if self._shader else lobe):
            return None
        value = np.asarray(self._inputs[name])
        is_number = self._port(path, name).getType() not in nodes.WIDTHS
        return np.reshape(value, (-1, 1)) if is_number else value

    def _connected(self, around: Path, port: mx.PortElement, label: str = "") -> Path:
        """Path of the source to which an input or output of the graph at `around` is connected.

        If the source needs an unsupported node and `label` is given, the host draws the value.
        """
        path, kind = self.upstream(around, port), port.getType()
        assert path
        output = (port if port.getNodeName() else port.getConnectedOutput()).getOutputString()
        if not (label and self._measure and kind in DRAWN):
            return self._output(path, output)
        try:
            found = self._output(path, output)
            self._parts([found])
        except NotRun:
            self.measured[label] = None
            part = (*path, f"={output}")
            self._steps[part] = partial(self._measure, self._along(path), kind, output), ()
            return part
        return found

    def _output(self, path: Path, output: str) -> Path:
        """Path of a node's output. The name `output` only matters if a node has several outputs."""
        node = self.elements[path]
        if node.getType() != "multioutput":
            return path
        if node.getCategory() in UTILITIES:
            part = (*path, f".{output}")
            self._steps[part] = itemgetter(output), (path,)
            return part
        return self._inside(path, node, output)

    def _constant(self, path: Path, name: str, value: Value) -> Path:
        constant = (*path, f":{name}")
        self._steps[constant] = (lambda: value), ()
        return constant

    def _along(self, path: Path, outer: Path = ()) -> list[mx.Element]:
        """Elements along a path, outermost first, starting at the depth of the path `outer`."""
        ends = range(max(len(outer), 1), len(path) + 1)
        return [self.elements[path[:end]] for end in ends if path[:end] in self.elements]

    def _port(self, path: Path, name: str) -> mx.Input:
        if port := self.port(path, name):
            return port
        raise NotRun(f"reference: node {'/'.join(path[-1:])!r} has no input {name!r}")

    def _written(self, path: Path, name: str, port: mx.Input) -> Value:
        """Value of an unconnected input, converted to the document's color space or to meters."""
        element = self.elements[path]
        nodedef = element.getNodeDef() if element.isA(mx.Node) else None
        declared = nodedef.getActiveInput(name) if nodedef else port
        if declared and declared.hasDefaultGeomPropString():  # use the default geometric property
            return self._points.geometry(declared.getDefaultGeomPropString())
        value = port.getValue()
        if value is None and declared:  # MaterialX ignores an unresolved connection
            value = declared.getValue()
        if port.getType() in UNCONNECTED:
            return UNCONNECTED[port.getType()]
        constant = plain(value)
        if not isinstance(constant, np.ndarray):
            return constant
        if port.getType() in ("color3", "color4"):
            return _linear(port, constant)
        if not port.hasUnit():
            return constant
        library = self._document.getDataLibrary() or self._document
        lengths = library.getUnitTypeDef("distance")
        scales = mx.LinearUnitConverter.create(lengths).getUnitScale() if lengths else {}
        return constant * float(scales.get(port.getUnit(), 1.0))

    def _image(self, node: mx.Node) -> Array:
        """Values of an image node at the texture coordinates of the points."""
        if self._points.texcoord is None or node.getInput("texcoord") is not None:
            raise NotRun("reference: images are supported only at the sphere's own coordinates")
        file = node.getInput("file")
        if not file or not file.getValueString():
            raise NotRun("reference: an image must have its own file name")
        if file.hasUnit():
            raise NotRun("reference: an image of lengths has no reference")
        channels = CHANNELS.get(node.getType(), 0)
        values = texels_at(file.getValueString(), self._points.texcoord.tobytes())
        if not 0 < channels <= values.shape[-1]:
            raise NotRun(
                f"reference: {file.getValueString()}: must be read as float, or as color3 from an "
                f"image of 3 channels; got {node.getType()} from {values.shape[-1]}"
            )
        read = values[:, :channels]
        return _linear(file, read) if channels == 3 else read


def _applied(node: mx.Node, operation: Callable[..., Value], *values: Value) -> Value:
    """Value of a node's operation. Raise OutsideModel for invalid inputs."""
    try:
        return nodes.fitted(node.getType(), operation(*values))
    except ValueError as error:
        raise OutsideModel(f"reference: node {node.getNamePath()!r}: {error}") from None


def _rows(names: Iterable[str], values: Iterable[Array], count: int = 1) -> dict[str, Array]:
    """Inputs of a model, as numbers (N,) and colors (N, 3), with at least `count` rows."""
    columns = [np.atleast_2d(np.asarray(value, np.float64)) for value in values]
    count = max(count, *map(len, columns))
    rows = (np.broadcast_to(each, (count, each.shape[1])) for each in columns)
    flat = (each[:, 0] if each.shape[1] == 1 else each for each in rows)
    return dict(zip(names, flat, strict=True))


def _radiance(
    row: emissions.Emission, ports: tuple[str, ...], points: ShadingPoints, *values: Array
) -> Array:
    wo, _ = points.local
    return row.value(wo, _rows(ports, values, len(wo)))


def _utility(row: utilities.UtilityNode, *values: Array) -> Array | Mapping[str, Array]:
    """A utility node's output, or all outputs by name if there are several."""
    outputs = row.value(_rows(row.inputs, values))
    return next(iter(outputs.values())) if len(outputs) == 1 else outputs


def _linear(element: mx.Element, value: Array) -> Array:
    """A color in the document's color space. Raise NotRun for any transform except sRGB's."""
    spaces = color_spaces(element)
    if spaces is None:
        return value
    if spaces != ("srgb_texture", "lin_rec709"):
        raise NotRun(f"reference: there is no transform from color space {' to '.join(spaces)}")
    return np.concatenate([srgb_decoded(value[..., :3]), value[..., 3:]], axis=-1)
