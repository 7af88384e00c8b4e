# SPDX-License-Identifier: Apache-2.0
"""Elements of a document by their paths, with their ports and the values that are written there."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.reference.measured import CLOSURES
from mxeon.conformance.reference.nodes import NOTHING, plain
from mxeon.conformance.reference.operations import Value, Values
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.errors import NotRun
from mxeon.hosts.textures import read_texture
from mxeon.io.srgb import srgb_decoded
from mxeon.shaders.document.values import color_spaces

Path: TypeAlias = tuple[str, ...]  # of a node: names of the nodegraphs around it, and its own

# Where nothing is connected: black, and for a lobe zero, which hides nothing.
UNCONNECTED: dict[str, Value] = {
    "BSDF": NOTHING,
    "EDF": np.zeros(3),
    "surfaceshader": np.zeros(3),
    "VDF": None,
}
DISTANCE = "distance"  # type of units


class Elements:
    """Elements of a document, each found under a path before it is asked for.

    A path names a node within the nodes and nodegraphs around it: a tuple of name paths, the
    outermost first.
    """

    def __init__(self, document: mx.Document, points: ShadingPoints) -> None:
        self._document, self._points = document, points
        self._elements: dict[Path, mx.Element] = {(): document}

    def __getitem__(self, path: Path) -> mx.Element:
        return self._elements[path]

    def get(self, path: Path) -> mx.Element | None:
        return self._elements.get(path)

    def along(self, path: Path, outer: Path = ()) -> list[mx.Element]:
        """Those at a path and around it, up to one within another path, the outermost first."""
        ends = range(max(len(outer), 1), len(path) + 1)
        return [self._elements[path[:end]] for end in ends if path[:end] in self._elements]

    def scatter(self, path: Path, outer: Path) -> bool:
        """Whether a node, or one around it up to another path, scatters light or combines what does."""
        return any(each.getType() in CLOSURES for each in self.along(path, outer))

    def inner(self, around: Path, element: mx.Element) -> Path:
        """Path of an element within another path."""
        path = (*around, element.getNamePath())
        self._elements[path] = element
        return path

    def port(self, path: Path, name: str) -> mx.Input:
        """Input of a node, or else of its nodedef."""
        element = self._elements.get(path)
        nodedef = element.getNodeDef() if element and path else None
        port = element and element.getInput(name)
        port = port or (nodedef and nodedef.getActiveInput(name))
        if not port:
            raise NotRun(f"reference: node {'/'.join(path[-1:])!r} has no input {name!r}")
        return port

    def value(self, path: Path, name: str, port: mx.Input) -> Value:
        """Value of an input without a connection, in the document's color space."""
        element = self._elements[path]
        nodedef = element.getNodeDef() if element.isA(mx.Node) else None
        declared = nodedef.getActiveInput(name) if nodedef else port
        if declared and declared.hasDefaultGeomPropString():  # nothing else sets it
            return self._points.geometry(declared.getDefaultGeomPropString())
        value = port.getValue()
        if value is None and declared:  # a connection that MaterialX ignores
            value = declared.getValue()
        if port.getType() in UNCONNECTED:
            return UNCONNECTED[port.getType()]
        constant = plain(value)
        if isinstance(constant, np.ndarray):
            if port.getType() in ("color3", "color4"):
                return self.linear(port, constant)
            if port.hasUnit():
                return constant * self._meters(port)
        return constant

    def _meters(self, port: mx.Input) -> float:
        """Factor from the unit of an input, a length, to that of shaders, which is a meter."""
        library = self._document.getDataLibrary() or self._document
        definition = library.getUnitTypeDef(DISTANCE)
        scales = mx.LinearUnitConverter.create(definition).getUnitScale() if definition else {}
        return float(scales.get(port.getUnit(), 1.0))

    def linear(self, element: mx.Element, value: Values) -> Values:
        """Color in the document's space, as the generators' color management has it; alpha stays.

        Raise NotRun if that takes a transform other than the decoding of sRGB.
        """
        spaces = color_spaces(element)
        if spaces is None:
            return value
        if spaces != ("srgb_texture", "lin_rec709"):
            raise NotRun(f"reference: there is no transform from color space {' to '.join(spaces)}")
        return np.concatenate([srgb_decoded(value[..., :3]), value[..., 3:]], axis=-1)


def graph_output(node: mx.Node, output: str = "") -> mx.Output | None:
    """Output of a node in its nodegraph, or the only one, where that has a node; None if there is none."""
    graph = node.getImplementation()
    outputs = graph.getOutputs() if graph and graph.isA(mx.NodeGraph) else []
    named = [each for each in outputs if each.getName() == output] or outputs
    return named[0] if len(named) == 1 and named[0].getConnectedNode() else None


FILES = 16  # of which the values at the points of a picture are kept
CHANNELS = {"float": 1, "color3": 3}  # of an image, by the type that it is read as


def lookup(
    node: mx.Node, texcoord: Values | None, linear: Callable[[mx.Element, Values], Values]
) -> Callable[[], Values]:
    """Function that reads an image node: texel centers at half-integers, v = 0 at the bottom.

    Raise NotRun if the image is read in another way.
    """
    if texcoord is None or node.getInput("texcoord") is not None:
        raise NotRun("reference: images are read at the sphere's own coordinates only")
    file = node.getInput("file")
    if not file or not file.getValueString():
        raise NotRun("reference: an image must name its file itself")
    if file.hasUnit():
        raise NotRun("reference: an image must hold no lengths")
    channels = CHANNELS.get(node.getType(), 0)
    values = _texels(file.getValueString(), texcoord.tobytes())
    if not 0 < channels <= values.shape[-1]:
        raise NotRun(
            f"reference: {file.getValueString()}: must be read as float, or as color3 from an "
            f"image of 3 channels; got {node.getType()} from {values.shape[-1]}"
        )
    value = linear(file, values[:, :channels]) if channels == 3 else values[:, :channels]
    return lambda: value


@lru_cache(maxsize=FILES)
def _texels(path: str, texcoord: bytes) -> Values:
    """Values of all channels of an image at points, (N, channels)."""
    where = np.frombuffer(texcoord).reshape(-1, 2)
    return _bilinear(read_texture(path), where)


def _bilinear(texels: NDArray[np.float32], texcoord: Values) -> Values:
    height, width = texels.shape[:2]
    texel = texcoord * [width, height] - 0.5
    corner = np.floor(texel).astype(int)
    u, v = (texel - corner).T[..., None]
    x, y = corner.T

    def at(dx: int, dy: int) -> Values:
        return np.asarray(texels[(y + dy) % height, (x + dx) % width], np.float64)

    lower = at(0, 0) * (1.0 - u) + at(1, 0) * u
    upper = at(0, 1) * (1.0 - u) + at(1, 1) * u
    return np.asarray(lower * (1.0 - v) + upper * v)
