# SPDX-License-Identifier: Apache-2.0
"""Finds lobes that send light below a surface, which renderers of isolated points cannot show.

A walk over the document's graph starts at the material. The walk skips lobes of constant weight 0,
and the side of a mix that a constant weight of 0 or 1 disables. Weights that cannot be computed
from constants count as nonzero.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

import MaterialX as mx

from mxeon.shaders.document.graphs import reachable
from mxeon.shaders.generation import Shader

Path: TypeAlias = tuple[str, ...]

SUBSURFACE, TRANSMISSION, VOLUME = "subsurface", "transmission", "volume"
KINDS = {
    "subsurface_bsdf": SUBSURFACE,
    "absorption_vdf": VOLUME,
    "anisotropic_vdf": VOLUME,
}
# Arithmetic nodes that MaterialX's surface shaders use to compute weights from switches.
ARITHMETIC: dict[str, tuple[tuple[str, ...], Callable[..., float]]] = {
    "convert": (("in",), lambda value: value),
    "ifgreater": (("value1", "value2", "in1", "in2"), lambda a, b, one, two: one if a > b else two),
    "switch": (("in1", "in2", "which"), lambda one, two, which: two if which >= 1.0 else one),
}
# Types of inputs that carry light from node to node.
CLOSURES = ("BSDF", "VDF", "surfaceshader", "volumeshader", "material")


def inner_lobes(shader: Shader) -> tuple[str, ...]:
    """The kinds of a shader's lobes that send light below the surface.

    >>> from mxeon.shaders.generation import generate
    >>> from mxeon.shaders.nodes import SURFACE, document_text
    >>> text = document_text('<subsurface_bsdf name="lobe" type="BSDF"/>' + SURFACE)
    >>> inner_lobes(generate(text, "glsl")[0])
    ('subsurface',)
    """
    walk = Walk([shader.document.getDescendant(shader.element)])
    return tuple(kind for kind in (SUBSURFACE, TRANSMISSION, VOLUME) if kind in walk.kinds)


class Nodes:
    """Elements of a document, keyed by path.

    A path is a tuple of name paths. The name paths of the enclosing nodes and nodegraphs come
    first, beginning with the outermost element. The name path of the element itself comes last.
    """

    def __init__(self) -> None:
        self.elements: dict[Path, mx.InterfaceElement] = {}

    def path(self, outer: Path, element: mx.Element) -> Path:
        """Store an element that lies inside the node at `outer`; return the element's path."""
        path = (*outer, element.getNamePath())
        self.elements[path] = element
        return path

    def port(self, path: Path, name: str) -> mx.Input | None:
        """A named input of a node, or of the node's definition; None if there is no such input."""
        if not (element := self.elements.get(path)):
            return None
        definition = element.getNodeDef()
        return element.getInput(name) or (definition and definition.getActiveInput(name)) or None

    def upstream(self, outer: Path, port: mx.PortElement) -> Path | None:
        """Path of the node that is connected to a port inside the node at `outer`, or None."""
        if not (node := port.getConnectedNode()):
            return None
        graph, scope = node.getParent(), port.getParent()
        if port.isA(mx.Input):
            scope = scope.getParent()
        if graph.getNamePath() != scope.getNamePath():
            outer = self.path((), graph)
        return self.path(outer, node)


class Walk(Nodes):
    """Finds the nodes that contribute light to materials, and the kinds of lobes among the nodes.

    The walk skips nodes of constant weight 0. With `values`, the walk also visits nodes that
    compute the values of inputs.
    """

    def __init__(self, elements: Iterable[mx.TypedElement], values: bool = False) -> None:
        super().__init__()
        self._values = values
        self._black_nodes: set[Path] = set()
        self.kinds: set[str] = set()
        roots = (each.getConnectedNode() if each.isA(mx.Output) else each for each in elements)
        graph = reachable([self.path((), root) for root in roots if root], self.parts)
        self.shown = tuple(path for path in graph if path not in self._black_nodes)

    def parts(self, path: Path) -> tuple[Path, ...]:
        """Paths of the nodes that contribute to a node's light."""
        node = self.elements[path]
        if self._constant(path, "weight") == 0.0 or not self.emits(path):
            self._black_nodes.add(path)
            return ()
        kind = KINDS.get(node.getCategory())
        mode = self.port(path, "scatter_mode")
        if mode and mode.getValueString() in ("T", "RT"):
            kind = TRANSMISSION
        if kind:
            self.kinds.add(kind)
        implementation = node.getImplementation()
        if implementation and implementation.isA(mx.NodeGraph):
            outputs = (output.getConnectedNode() for output in implementation.getOutputs())
            return tuple(self.path(path, output) for output in outputs if output)
        sources = (self.source(path, name) for name in self._effective(path, node))
        return tuple(source for source in sources if source)

    def emits(self, path: Path) -> bool:
        """Whether a node may emit light; False only for EDFs that are always black."""
        node = self.elements[path]
        if node.getType() != "EDF":
            return True
        sources = [self.source(path, name) for name in self._effective(path, node)]
        lights = [each for each in sources if each and self.elements[each].getType() == "EDF"]
        if lights or node.getCategory() == "multiply":
            return any(map(self.emits, lights))
        return not self._black(path, "color")

    def _black(self, path: Path, name: str) -> bool:
        """Whether an input is 0, or is connected to a node that multiplies by 0."""
        if source := self.source(path, name):
            product = self.elements[source].getCategory() == "multiply"
            return product and any(self._black(source, factor) for factor in ("in1", "in2"))
        value = self.value(path, name)
        return bool(value) and not any(map(float, str(value).split(",")))

    def _effective(self, path: Path, node: mx.InterfaceElement) -> tuple[str, ...]:
        """Names of the inputs that contribute to a node's output."""
        category = node.getCategory()
        if category == "mix":
            weight, value = self._constant(path, "mix"), ("mix",) * self._values
            sides = {0.0: ("bg",), 1.0: ("fg",)}.get(weight, ("bg", "fg"))  # type: ignore[arg-type]
            return (*sides, *value)
        if category == "multiply" and self._constant(path, "in2") == 0.0:
            return ()
        ports = node.getInputs()
        return tuple(p.getName() for p in ports if self._values or p.getType() in CLOSURES)

    def _resolved(self, path: Path, name: str) -> tuple[Path, mx.Input | None]:
        """The outermost input that supplies a node's input, and the path of that input's node."""
        while port := self.port(path, name):
            if not port.hasInterfaceName() or len(path) < 2:
                break
            path, name = path[:-1], port.getInterfaceName()
        return path, port

    def source(self, path: Path, name: str) -> Path | None:
        """Path of the node connected to an input, or None."""
        path, port = self._resolved(path, name)
        return self.upstream(path[:-1], port) if port else None

    def value(self, path: Path, name: str) -> str | None:
        """Text of an input's value; None without such an input, or if a node computes the value."""
        _, port = self._resolved(path, name)
        return None if port is None or self.source(path, name) else str(port.getValueString())

    def _constant(self, path: Path, name: str) -> float | None:
        """Numeric value of an input; None if the value is not a constant number."""
        if source := self.source(path, name):
            ports, function = ARITHMETIC.get(self.elements[source].getCategory(), ((), None))
            numbers = [self._constant(source, port) for port in ports]
            return function(*numbers) if function and None not in numbers else None
        _, port = self._resolved(path, name)
        value = port.getValue() if port else None
        return float(value) if isinstance(value, (bool, int, float)) else None
