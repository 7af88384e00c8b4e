# SPDX-License-Identifier: Apache-2.0
"""Material graphs of diffuse lobes evaluated in NumPy, over all the points of a picture at once.

What a graph may contain: rough diffuse lobes; mix, add and multiply; values, arithmetic and images;
nodes that are nodegraphs of these. Anything else is NotRun, with the node's name.
"""

import MaterialX as mx
import numpy as np

from mxeon.hosts import NotRun
from mxeon.images import read_texture

# Operations on values and on lobes alike: node category -> inputs -> result.
OPERATIONS = {
    "constant": lambda get: get("value"),
    "add": lambda get: get("in1") + get("in2"),
    "subtract": lambda get: get("in1") - get("in2"),
    "multiply": lambda get: get("in1") * get("in2"),
    "divide": lambda get: get("in1") / get("in2"),
    "power": lambda get: get("in1") ** get("in2"),
    "invert": lambda get: get("amount") - get("in"),
    "sqrt": lambda get: np.sqrt(get("in")),
    "convert": lambda get: get("in"),
    "mix": lambda get: get("fg") * get("mix") + get("bg") * (1.0 - get("mix")),
    "surface": lambda get: get("bsdf") * get("opacity"),
    "surfacematerial": lambda get: get("surfaceshader"),
}


class Graph:
    """A document's graph at the points of a picture.

    Parameters
    ----------
    document : MaterialX.Document
    texcoord : ndarray, shape (N, 2)
    lobe : callable (model name, color, roughness) -> ndarray, shape (N, 3)
        What a diffuse lobe of weight one gives at these points.
    inputs : mapping of str to array
        Inputs of diffuse lobes that take the place of the document's.
    """

    def __init__(self, document, texcoord, lobe, inputs=None):
        self._document = document
        self._texcoord = texcoord
        self._lobe = lobe
        self._inputs = inputs or {}

    def element(self, path):
        """What the renderable element at a name path gives.

        Raises
        ------
        NotRun
            If the graph holds a node that is none of the above.
        """
        element = self._document.getDescendant(path)
        if element.isA(mx.Output):
            return self._output(element, _no_interface)
        return self._node(element, _no_interface)

    def _output(self, output, interface):
        return self._node(output.getConnectedNode(), interface)

    def _node(self, node, interface):
        def get(name):
            return self._input(node, name, interface)

        category = node.getCategory()
        if category in ("oren_nayar_diffuse_bsdf", "eon_diffuse_bsdf"):
            return self._diffuse(node, lambda name: self._inputs.get(name, get(name)))
        if category == "image":
            return self._image(node, get)
        if category in OPERATIONS:
            return OPERATIONS[category](get)
        inside = node.getImplementation()
        if not inside or not inside.isA(mx.NodeGraph):
            raise NotRun(f"reference: there is no model for node {category!r}")
        return self._output(inside.getOutputs()[0], get)

    def _input(self, node, name, interface):
        """Value of an input: connected, from the enclosing graph, given, or the default."""
        given = node.getInput(name) or node.getNodeDef().getActiveInput(name)
        if given.hasInterfaceName():
            return interface(given.getInterfaceName())
        connected = given.getConnectedNode()
        if connected:
            graph = connected.getParent()
            if graph.getNamePath() != node.getParent().getNamePath():
                return self._node(connected, lambda each: self._input(graph, each, _no_interface))
            return self._node(connected, interface)
        if node.getNodeDef().getActiveInput(name).hasDefaultGeomPropString():
            return None  # the surface's own: MaterialX takes no value for such an input
        value = _plain(given.getValue())
        return self._linear(given, value) if given.getType() == "color3" else value

    def _linear(self, element, value):
        """A colour in the document's linear space, as the generators' colour management has it."""
        space = element.getActiveColorSpace()
        if space in ("", "none", self._document.getColorSpace()):
            return value
        if space != "srgb_texture":
            raise NotRun(f"reference: there is no transform for colour space {space!r}")
        return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)

    def _diffuse(self, node, get):
        if get("normal") is not None:
            raise NotRun("reference: there are no models for a normal other than the surface's")
        eon = node.getCategory() == "eon_diffuse_bsdf" or get("energy_compensation")
        roughness = np.reshape(get("roughness"), -1)
        value = self._lobe("eon" if eon else "qon", get("color"), roughness)
        return value * np.reshape(get("weight"), (-1, 1))

    def _image(self, node, get):
        """Bilinear, periodic look-up; texel centres at half-integers, v = 0 at the bottom."""
        if node.getInput("texcoord") is not None:
            raise NotRun("reference: images are read at the sphere's own coordinates only")
        file = node.getInput("file")
        texels = read_texture(file.getValueString()).astype(np.float64)
        channels = 3 if node.getType() == "color3" else 1
        height, width = texels.shape[:2]
        place = self._texcoord * [width, height] - 0.5
        corner = np.floor(place).astype(int)
        u, v = (place - corner).T[..., None]
        x, y = corner.T

        def at(dx, dy):
            return texels[(y + dy) % height, (x + dx) % width, :channels]

        lower = at(0, 0) * (1.0 - u) + at(1, 0) * u
        upper = at(0, 1) * (1.0 - u) + at(1, 1) * u
        value = lower * (1.0 - v) + upper * v
        return self._linear(file, value) if channels == 3 else value


def _no_interface(name):
    raise NotRun(f"reference: there is no enclosing graph to give {name!r}")


def _plain(value):
    """A MaterialX value as a bool, a string or an array; None stays None."""
    if value is None or isinstance(value, (bool, str)):
        return value
    return np.asarray(value if isinstance(value, (int, float)) else tuple(value), dtype=np.float64)
