# SPDX-License-Identifier: Apache-2.0
"""Material graphs of diffuse lobes evaluated in NumPy, over all the points of a picture at once.

What a graph may contain: rough diffuse lobes; mix, add and multiply; values, arithmetic and images;
nodes that are nodegraphs of these. Anything else is NotRun, with the node's name.
"""

from collections import Counter
from functools import partial
from operator import add, mul, pow, sub, truediv

import MaterialX as mx
import numpy as np

from mxeon.errors import NotRun, OutsideModel
from mxeon.io.images import srgb_decoded
from mxeon.shaders.document.graphs import reachable
from mxeon.shaders.hosts.textures import read_texture
from mxeon.shaders.nodes import DIFFUSE_NODES, EON

# Operations on values and on lobes alike: node category -> its inputs, and the result from them.
OPERATIONS = {
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
    "surface": (("bsdf", "opacity"), mul),
    "surfacematerial": (("surfaceshader",), lambda shader: shader),
}
CLOSURES = ("BSDF", "EDF", "surfaceshader")  # black where nothing is connected
CHANNELS = {"float": 1, "color3": 3}  # of an image, by the type that it is read as


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

    Notes
    -----
    A place is a node as part of all the nodes and nodegraphs around it: a tuple of name paths, the
    outermost first. Places are evaluated by a loop, each once, so that neither a long chain nor a
    node with many uses does harm, and forgotten after their last use.
    """

    def __init__(self, document, texcoord, lobe, inputs=None):
        self._document = document
        self._texcoord = texcoord
        self._lobe = lobe
        self._inputs = inputs or {}
        self._elements = {}  # by their places
        self._recipes = {}  # place -> a function and the places of its arguments

    def element(self, path):
        """What the renderable element at a name path gives.

        Raises
        ------
        NotRun
            If the graph holds a node that is none of the above.
        """
        element = self._document.getDescendant(path)
        root = element.getConnectedNode() if element.isA(mx.Output) else element
        return self._evaluate(self._place((), root))

    def _evaluate(self, root):
        parts = reachable([root], lambda place: self._recipe(place)[1])
        uses = Counter(part for each in parts.values() for part in each)
        values, waiting = {}, [root]
        while waiting:
            place = waiting[-1]
            if place in values:
                waiting.pop()
            elif missing := [part for part in parts[place] if part not in values]:
                waiting.append(missing[0])
            else:
                values[place] = self._recipes[place][0](*(values[part] for part in parts[place]))
                for part in parts[place]:
                    uses[part] -= 1
                    if not uses[part]:
                        del values[part]
        return values[root]

    def _recipe(self, place):
        """How the value at a place is made."""
        if place not in self._recipes:
            self._recipes[place] = self._made(place)
        return self._recipes[place]

    def _made(self, place):
        node = self._elements[place]
        category = node.getCategory()
        if category in DIFFUSE_NODES:
            names = ("normal", "color", "roughness", "weight")
            make = partial(self._diffuse, node.getNamePath())
            if category == EON:
                return partial(make, True), self._sources(place, names)
            return make, self._sources(place, ("energy_compensation", *names))
        if category == "image":
            return partial(self._image, node), ()
        if category in OPERATIONS:
            names, make = OPERATIONS[category]
            return make, self._sources(place, names)
        inside = node.getImplementation()
        outputs = inside.getOutputs() if inside and inside.isA(mx.NodeGraph) else ()
        if len(outputs) != 1 or not outputs[0].getConnectedNode():
            raise NotRun(f"reference: there is no model for node {category!r}")
        return lambda value: value, (self._place(place, outputs[0].getConnectedNode()),)

    def _sources(self, place, names):
        lobe = self._elements[place].getCategory() in DIFFUSE_NODES
        given = self._inputs if lobe else {}
        return tuple(
            self._constant(place, name, given[name]) if name in given else self._source(place, name)
            for name in names
        )

    def _source(self, place, name):
        """The place that an input's value comes from: connected, given, or the default."""
        while (given := self._port(place, name)).hasInterfaceName():
            place, name = place[:-1], given.getInterfaceName()
        connected = given.getConnectedNode()
        if connected:
            graph, parent = connected.getParent(), self._elements[place].getParent()
            if graph.getNamePath() == parent.getNamePath():
                return self._place(place[:-1], connected)
            return self._place(self._place((), graph), connected)
        definition = self._elements[place].getNodeDef()
        declared = definition.getActiveInput(name) if definition else None
        if declared and declared.hasDefaultGeomPropString():
            return self._constant(place, name, None)  # the surface's own: nothing sets it
        written = given.getValue()
        if written is None and declared:  # a connection that MaterialX ignores
            written = declared.getValue()
        value = 0.0 if given.getType() in CLOSURES else _plain(written)
        linear = self._linear(given, value) if given.getType() == "color3" else value
        return self._constant(place, name, linear)

    def _port(self, place, name):
        """An input as it is written, or else as its nodedef has it."""
        element = self._elements.get(place)
        definition = element.getNodeDef() if element else None
        given = element and element.getInput(name)
        given = given or (definition and definition.getActiveInput(name))
        if not given:
            raise NotRun(f"reference: there is nothing to give {name!r} to {place[-1:]}")
        return given

    def _place(self, around, element):
        place = (*around, element.getNamePath())
        self._elements[place] = element
        return place

    def _constant(self, place, name, value):
        """A place that has no parts."""
        constant = (*place, f":{name}")
        self._recipes[constant] = (lambda: value), ()
        return constant

    def _linear(self, element, value):
        """A colour in the document's linear space, as the generators' colour management has it."""
        space = element.getActiveColorSpace()
        if space in ("", "none", self._document.getColorSpace()):
            return value
        if space != "srgb_texture":
            raise NotRun(f"reference: there is no transform for colour space {space!r}")
        return srgb_decoded(value)

    def _diffuse(self, name, compensated, normal, color, roughness, weight):
        if normal is not None:
            raise NotRun("reference: there are no models for a normal other than the surface's")
        model = "eon" if compensated else "qon"
        weight = np.reshape(weight, (-1, 1))
        if (beyond := weight[~((weight >= 0.0) & (weight <= 1.0))]).size:
            rule = f"weight must lie in [0, 1]; got {beyond[0]:g}"
            raise OutsideModel(f"reference: node {name!r}: {rule}")
        # MaterialX keeps float32, in which pi / 2 is above pi / 2: that alone is lowered to it.
        rounded = np.float32(roughness) == np.float32(np.pi / 2.0)
        roughness = np.where(rounded & (not compensated), np.pi / 2.0, roughness)
        try:
            lobe = self._lobe(model, color, np.reshape(roughness, -1))
        except ValueError as error:
            raise OutsideModel(f"reference: node {name!r}: {error}") from None
        return lobe * weight

    def _image(self, node):
        """Bilinear, periodic look-up; texel centres at half-integers, v = 0 at the bottom."""
        if node.getInput("texcoord") is not None:
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


def _plain(value):
    """A MaterialX value as a bool, a string or an array; None stays None."""
    if value is None or isinstance(value, (bool, str)):
        return value
    return np.asarray(value if isinstance(value, (int, float)) else tuple(value), dtype=np.float64)
