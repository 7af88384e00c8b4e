# SPDX-License-Identifier: Apache-2.0
"""Lobes that send light below a material's surface, which a single surface point cannot show.

The document's graph is walked from its material. Lobes of constant weight 0 are skipped, and so is
the side of a mix that a constant weight of 0 or 1 disables. Computed weights count as nonzero.
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
    """Kinds of a shader's lobes below the surface.

    >>> from mxeon.shaders.generation import generate
    >>> from mxeon.shaders.nodes import SURFACE, document_text
    >>> text = document_text('<subsurface_bsdf name="lobe" type="BSDF"/>' + SURFACE)
    >>> inner_lobes(generate(text, "glsl")[0])
    ('subsurface',)
    """
    walk = Walk([shader.document.getDescendant(shader.element)])
    return tuple(kind for kind in (SUBSURFACE, TRANSMISSION, VOLUME) if kind in walk.kinds)


class Nodes:
    """Elements of a document, by path.

    A path is a tuple of name paths: of each enclosing node or nodegraph, from the outermost, and of
    the node itself.
    """

    def __init__(self) -> None:
        self.elements: dict[Path, mx.InterfaceElement] = {}

    def path(self, outer: Path, element: mx.Element) -> Path:
        """Path of an element inside the node at `outer`; also stores the element."""
        path = (*outer, element.getNamePath())
        self.elements[path] = element
        return path

    def port(self, path: Path, name: str) -> mx.Input | None:
        """Input of a node, otherwise of its nodedef, or None."""
        if not (element := self.elements.get(path)):
            return None
        definition = element.getNodeDef()
        return element.getInput(name) or (definition and definition.getActiveInput(name)) or None

    def upstream(self, outer: Path, port: mx.PortElement) -> Path | None:
        """Path of the node connected to an input or output inside the node at `outer`, or None."""
        if not (node := port.getConnectedNode()):
            return None
        graph, scope = node.getParent(), port.getParent()
        if port.isA(mx.Input):
            scope = scope.getParent()
        if graph.getNamePath() != scope.getNamePath():
            outer = self.path((), graph)
        return self.path(outer, node)


class Walk(Nodes):
    """The nodes that contribute light to a material, by path, and the kinds of lobes among them.

    Nodes of constant weight 0 are skipped; with `values`, nodes that compute inputs are included.
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
        """Whether an input is 0, or is connected to a product with a factor of 0."""
        if source := self.source(path, name):
            product = self.elements[source].getCategory() == "multiply"
            return product and any(self._black(source, factor) for factor in ("in1", "in2"))
        value = self.value(path, name)
        return bool(value) and not any(map(float, str(value).split(",")))

    def _effective(self, path: Path, node: mx.InterfaceElement) -> tuple[str, ...]:
        """Names of the inputs whose light reaches the node's output."""
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
        """The outermost input that a node's input takes its value from, and the path of its node."""
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
        """Text of an input's value; None if it is computed or the input does not exist."""
        _, port = self._resolved(path, name)
        return None if port is None or self.source(path, name) else str(port.getValueString())

    def _constant(self, path: Path, name: str) -> float | None:
        """Numeric value of an input; None if it is not a constant number."""
        if source := self.source(path, name):
            ports, function = ARITHMETIC.get(self.elements[source].getCategory(), ((), None))
            numbers = [self._constant(source, port) for port in ports]
            return function(*numbers) if function and None not in numbers else None
        _, port = self._resolved(path, name)
        value = port.getValue() if port else None
        return float(value) if isinstance(value, (bool, int, float)) else None
