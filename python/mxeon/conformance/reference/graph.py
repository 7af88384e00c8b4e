# SPDX-License-Identifier: Apache-2.0
"""Material graphs evaluated in NumPy, over all the points of a picture at once.

A graph may contain rough diffuse lobes and the nodes of `mxeon.models.pbrlib`; layer, mix, add and
multiply; values, arithmetic and images; nodes that are nodegraphs of these. Any other node is NotRun,
with its name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from operator import add, mul, pow, sub, truediv
from typing import Any, TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.reference.lobes import Lobe
from mxeon.conformance.reference.nodes import (
    COMBINATIONS,
    LOBES,
    combined,
    definition,
    node_lobe,
    plain,
)
from mxeon.errors import NotRun
from mxeon.io.images import srgb_decoded
from mxeon.models.layering import Bsdf
from mxeon.shaders.document.graphs import reachable
from mxeon.shaders.hosts.textures import read_texture

Path: TypeAlias = tuple[str, ...]  # see Graph
Step: TypeAlias = tuple[Callable[..., Any], tuple[Path, ...]]

# Operations on values and on lobes alike: node category -> its inputs, and the function of them.
OPERATIONS: dict[str, tuple[tuple[str, ...], Callable[..., Any]]] = {
    "constant": (("value",), lambda value: value),
    "add": (("in1", "in2"), add),
    "subtract": (("in1", "in2"), sub),
    "multiply": (("in1", "in2"), mul),
    "divide": (("in1", "in2"), truediv),
    "power": (("in1", "in2"), pow),
    "invert": (("amount", "in"), sub),
    "sqrt": (("in",), np.sqrt),
    "convert": (("in",), lambda value: value),
    "mix": (("fg", "bg", "mix"), lambda fg, bg, mix: fg * mix + bg * (1.0 - mix)),
    "surface": (
        ("bsdf", "edf", "opacity"),
        lambda bsdf, edf, opacity: bsdf.value * opacity + edf,
    ),
    "surfacematerial": (("surfaceshader",), lambda shader: shader),
}
# Where nothing is connected: black, and for a lobe nothing at all, which hides nothing.
UNCONNECTED = {
    "BSDF": Bsdf(np.zeros(3), np.ones(3)),
    "EDF": 0.0,
    "surfaceshader": 0.0,
}
CHANNELS = {"float": 1, "color3": 3}  # of an image, by the type that it is read as


class Graph:
    """A document's graph at the points of a picture.

    Parameters
    ----------
    document : MaterialX.Document
    texcoord : ndarray, shape (N, 2)
    lobe : callable
        Lobe at these points; see `mxeon.conformance.reference.lobes`.
    inputs : mapping of str to array
        Inputs of lobes that take the place of the document's.

    Notes
    -----
    A path names a node within the nodes and nodegraphs around it: a tuple of name paths, the
    outermost first. A loop evaluates each path once, so that neither a long chain nor a node with
    many uses does harm, and forgets its value after the last use.
    """

    def __init__(
        self,
        document: Any,
        texcoord: NDArray[np.float64] | None,
        lobe: Lobe,
        inputs: Mapping[str, Any] | None = None,
    ) -> None:
        self._document = document
        self._texcoord = texcoord
        self._lobe = lobe
        self._inputs = inputs or {}
        self._layered = False  # whether throughputs are needed
        self._elements: dict[Path, Any] = {}
        self._steps: dict[Path, Step] = {}

    def element(self, name_path: str) -> Any:
        """Values of the renderable element at a name path, (N, 3).

        Raises
        ------
        NotRun
            If the graph holds a node that is none of the above.
        """
        element = self._document.getDescendant(name_path)
        root = element.getConnectedNode() if element.isA(mx.Output) else element
        return self._evaluate(self._inner((), root))

    def _evaluate(self, root: Path) -> Any:
        parts = reachable([root], lambda path: self._step(path)[1])
        uses = Counter(part for inner in parts.values() for part in inner)
        values: dict[Path, Any] = {}
        waiting = [root]
        while waiting:
            path = waiting[-1]
            if path in values:
                waiting.pop()
            elif missing := [part for part in parts[path] if part not in values]:
                waiting.append(missing[0])
            else:
                values[path] = self._steps[path][0](*(values[part] for part in parts[path]))
                for part in parts[path]:
                    uses[part] -= 1
                    if not uses[part]:
                        del values[part]
        return values[root]

    def _step(self, path: Path) -> Step:
        """Function that computes the value at a path, and the paths of its arguments."""
        if path not in self._steps:
            self._steps[path] = self._node_step(path)
        return self._steps[path]

    def _node_step(self, path: Path) -> Step:
        node = self._elements[path]
        category = node.getCategory()
        if category in LOBES:
            names = tuple(port.getName() for port in definition(node).getActiveInputs())
            sources = self._sources(path, names)
            return lambda *values: self._lobe_of(
                node, dict(zip(names, values, strict=True))
            ), sources
        if category in COMBINATIONS and node.getType() == "BSDF":
            return self._combination(path, node)
        if category == "image":
            return partial(self._image, node), ()
        if category in OPERATIONS:
            ports, operation = OPERATIONS[category]
            return operation, self._sources(path, ports)
        inside = node.getImplementation()
        outputs: Any = inside.getOutputs() if inside and inside.isA(mx.NodeGraph) else ()
        if len(outputs) != 1 or not outputs[0].getConnectedNode():
            raise NotRun(f"reference: there is no model for node {category!r}")
        return lambda value: value, (self._inner(path, outputs[0].getConnectedNode()),)

    def _combination(self, path: Path, node: Any) -> Step:
        """Step of a node that combines lobes."""
        ports, operation = COMBINATIONS[node.getCategory()]
        if node.getCategory() == "layer":
            self._layered = True
            if definition(node).getActiveInput("base").getType() != "BSDF":
                raise NotRun("reference: there is no model for a layer over a volume")
        return partial(combined, node.getNamePath(), operation), self._sources(path, ports)

    def _sources(self, path: Path, names: tuple[str, ...]) -> tuple[Path, ...]:
        values = self._inputs if self._elements[path].getCategory() in LOBES else {}
        return tuple(
            self._constant(path, name, values[name]) if name in values else self._source(path, name)
            for name in names
        )

    def _source(self, path: Path, name: str) -> Path:
        """Path of an input's value: of the node connected to it, or of a constant."""
        while (port := self._port(path, name)).hasInterfaceName():
            path, name = path[:-1], port.getInterfaceName()
        if node := port.getConnectedNode():
            graph, parent = node.getParent(), self._elements[path].getParent()
            if graph.getNamePath() == parent.getNamePath():
                return self._inner(path[:-1], node)
            return self._inner(self._inner((), graph), node)
        return self._constant(path, name, self._value(path, name, port))

    def _value(self, path: Path, name: str, port: Any) -> Any:
        """Value of an input without a connection, in the document's color space."""
        definition = self._elements[path].getNodeDef()
        declared = definition.getActiveInput(name) if definition else None
        if declared and declared.hasDefaultGeomPropString():
            return None  # the surface's own: nothing sets it
        value = port.getValue()
        if value is None and declared:  # a connection that MaterialX ignores
            value = declared.getValue()
        if port.getType() in UNCONNECTED:
            return UNCONNECTED[port.getType()]
        return self._linear(port, plain(value)) if port.getType() == "color3" else plain(value)

    def _port(self, path: Path, name: str) -> Any:
        """Input of a node, or else of its nodedef."""
        element = self._elements.get(path)
        definition = element.getNodeDef() if element else None
        port = element and element.getInput(name)
        port = port or (definition and definition.getActiveInput(name))
        if not port:
            raise NotRun(f"reference: node {'/'.join(path[-1:])!r} has no input {name!r}")
        return port

    def _inner(self, around: Path, element: Any) -> Path:
        """Path of an element within another path."""
        path = (*around, element.getNamePath())
        self._elements[path] = element
        return path

    def _constant(self, path: Path, name: str, value: Any) -> Path:
        """Path of a value that has no parts."""
        constant = (*path, f":{name}")
        self._steps[constant] = (lambda: value), ()
        return constant

    def _linear(self, element: Any, value: Any) -> Any:
        """Color in the document's linear space, as the generators' color management has it."""
        space = element.getActiveColorSpace()
        if space in ("", "none", self._document.getColorSpace()):
            return value
        if space != "srgb_texture":
            raise NotRun(f"reference: there is no transform for color space {space!r}")
        return srgb_decoded(value)

    def _lobe_of(self, node: Any, inputs: Mapping[str, Any]) -> Bsdf:
        return node_lobe(node, inputs, self._lobe, self._layered)

    def _image(self, node: Any) -> Any:
        """Bilinear, periodic look-up; texel centers at half-integers, v = 0 at the bottom."""
        if self._texcoord is None or node.getInput("texcoord") is not None:
            raise NotRun("reference: images are read at the sphere's own coordinates only")
        file = node.getInput("file")
        if not file or not file.getValueString():
            raise NotRun("reference: an image must name its file itself")
        texels = read_texture(file.getValueString()).astype(np.float64)
        channels = CHANNELS.get(node.getType(), 0)
        if not 0 < channels <= texels.shape[-1]:
            raise NotRun(
                f"reference: {file.getValueString()}: must be read as float, or as color3 from an "
                f"image of 3 channels; got {node.getType()} from {texels.shape[-1]}"
            )
        height, width = texels.shape[:2]
        texel = self._texcoord * [width, height] - 0.5
        corner = np.floor(texel).astype(int)
        u, v = (texel - corner).T[..., None]
        x, y = corner.T

        def at(dx: int, dy: int) -> Any:
            return texels[(y + dy) % height, (x + dx) % width, :channels]

        lower = at(0, 0) * (1.0 - u) + at(1, 0) * u
        upper = at(0, 1) * (1.0 - u) + at(1, 1) * u
        value = lower * (1.0 - v) + upper * v
        return self._linear(file, value) if channels == 3 else value
