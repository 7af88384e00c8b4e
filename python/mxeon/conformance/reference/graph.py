# SPDX-License-Identifier: Apache-2.0
"""Material graphs evaluated in NumPy, over all the points of a picture at once.

A graph may contain the lobes that have a model, with their combinations; emissions; images; the
operations of the standard library; and nodes that are nodegraphs of these, surface shaders among
them. Any other node is NotRun, with its name, unless it adds nothing: a lobe whose weight is 0
everywhere, or that a mix leaves out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property, partial
from operator import itemgetter
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.reference.elements import Elements, Path, graph_output, lookup
from mxeon.conformance.reference.lobes import VOLUMES, over_volume
from mxeon.conformance.reference.measured import DRAWN, Measure
from mxeon.conformance.reference.nodes import (
    COMBINATIONS,
    LOBES,
    NOTHING,
    ShownLobe,
    combined,
    definition,
    node_lobe,
)
from mxeon.conformance.reference.operations import (
    OPERATIONS,
    Operation,
    Value,
    Values,
    computed,
    fitted,
    same,
)
from mxeon.conformance.reference.pbr_operations import UTILITIES, emissions, surfaces
from mxeon.conformance.reference.points import ShadingPoints
from mxeon.errors import NotRun
from mxeon.models.core.layering import Bsdf
from mxeon.shaders.document.graphs import reachable

Step: TypeAlias = tuple[Callable[..., Value], tuple[Path, ...]]

NUMBERS = ("float", "boolean", "integer")
# Operations in which hosts differ: jumps and ties, and the arc functions of drivers. They are measured.
HOSTS_OWN = ("round", "floor", "ceil", "modulo", "asin", "acos")


class Graph:
    """A document's graph at the points of a picture."""

    def __init__(
        self,
        document: mx.Document,
        points: ShadingPoints,
        inputs: Mapping[str, ArrayLike] | None = None,  # instead of the document's
        emits: bool = True,  # whether emission and opacity count
        measure: Measure
        | None = None,  # values of nodes without a function; None: they are not run
    ) -> None:
        self._document, self._points, self._inputs = document, points, inputs or {}
        self._emits, self._measure = emits, measure
        self.measured: dict[str, None] = {}  # inputs, each behind the name of its node
        self.lobes: list[ShownLobe] = []
        self._shader: Path | None = None  # the surface shader that is a nodegraph
        self._tops: list[Path] = []  # of layers: their throughputs are needed
        self._hiding: set[Path] = set()  # and those of what they are made of
        self._elements = Elements(document, points)
        self._steps: dict[Path, Step] = {}

    def element(self, name_path: str) -> Values:
        """Values of the renderable element at a name path, (N, 3).

        Raise NotRun if the graph holds a node that is none of the above.
        """
        element = self._document.getDescendant(name_path)
        graph = element.getParent()
        around = self._elements.inner((), graph) if graph.isA(mx.NodeGraph) else ()
        # Ignore what is not finite: another node may leave it out.
        with np.errstate(divide="ignore", invalid="ignore"):
            find = self._connected if element.isA(mx.Output) else self._elements.inner
            path = find(around, element)
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
        if category in LOBES:
            return self._lobe(path, node)
        if kind == "BSDF" and category in COMBINATIONS:
            return self._combination(path, node)
        if category == "image":
            return lookup(node, self._points.texcoord, self._elements.linear), ()
        if category in self._operations and not (self._measure and category in HOSTS_OWN):
            ports, operation = self._operations[category]
            return partial(computed, kind, operation), self._sources(path, ports)
        if kind == "surfaceshader" and self._shader is None:
            self._shader = path
        if inner := self._inside(path, node):
            return same, (inner,)
        if kind == "BSDF" and not self._weighs(path, node):
            return lambda: NOTHING, ()
        raise NotRun(f"reference: there is no model for node {category!r}")

    @cached_property
    def _operations(self) -> dict[str, Operation]:
        """Nodes that compute numbers or colors, some of them by the points."""
        shown = surfaces(self._emits, self._points.behind)
        return {**OPERATIONS, **UTILITIES, **VOLUMES, **emissions(self._points), **shown}

    def _inside(self, path: Path, node: mx.Node, output: str = "") -> Path | None:
        """Path of what an output of a node has in its nodegraph; None if that is none."""
        port = graph_output(node, output)
        return self._connected(path, port) if port else None

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
        if category == "mix":
            share = self._evaluate(self._source(path, "mix"))
            for port, none in (("bg", 0.0), ("fg", 1.0)):
                if np.all(share == none):
                    return same, self._sources(path, (port,))
        # A layer asks its top for a throughput; a volume below must be empty.
        if category == "layer":
            self._tops.append(self._source(path, "top"))
            if definition(node).getActiveInput("base").getType() != "BSDF":
                if self._points.behind:
                    return over_volume, self._sources(path, ports)
                if not self._points.round:
                    self._assert_empty(path)
                return same, self._sources(path, ("top",))
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
        owner = path
        while (given := self._given(path, name)) is None:
            port = self._elements.port(path, name)
            if not port.hasInterfaceName():
                break
            path, name = path[:-1], port.getInterfaceName()
        else:
            return self._constant(path, name, given)
        if port.getConnectedNode():
            shown = (
                f"{port.getParent().getName()}.{name}"
                if self._elements.scatter(owner, path)
                else ""
            )
            return self._connected(path[:-1], port, shown)
        return self._constant(path, name, self._elements.value(path, name, port))

    def _given(self, path: Path, name: str) -> Values | None:
        """Value that was handed in for an input, (N, 1) if it is one number for each point; or None."""
        element = self._elements.get(path)
        lobe = element is not None and element.getCategory() in LOBES
        if name not in self._inputs or not (path == self._shader if self._shader else lobe):
            return None
        number = self._elements.port(path, name).getType() in NUMBERS
        value = np.asarray(self._inputs[name])
        return np.reshape(value, (-1, 1)) if number else value

    def _connected(self, around: Path, port: mx.PortElement, shown: str = "") -> Path:
        """Path of what an input or output within another path is connected to.

        Where a value comes from a node without a function, and is an input that has a name as
        `shown`, all of it is measured.
        """
        node, source = port.getConnectedNode(), port
        graph, scope = node.getParent(), port.getParent()
        if not port.getNodeName():
            source = port.getConnectedOutput()
        if port.isA(mx.Input):
            scope = scope.getParent()
        if graph.getNamePath() != scope.getNamePath():
            around = self._elements.inner((), graph)
        path, output = self._elements.inner(around, node), source.getOutputString()
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
        part = (*path, f"={output}")
        self._steps[part] = partial(self._measure, self._elements.along(path), kind, output), ()
        return part

    def _constant(self, path: Path, name: str, value: Value) -> Path:
        """Path of a value that has no parts."""
        constant = (*path, f":{name}")
        self._steps[constant] = (lambda: value), ()
        return constant


def evaluated(
    root: Path,
    parts: Mapping[Path, tuple[Path, ...]],
    function: Callable[[Path], Callable[..., Value]],
) -> Value:
    """Value at a path: neither a long chain nor a part with many uses does harm."""
    uses = Counter(part for inner in parts.values() for part in inner)
    values: dict[Path, Value] = {}
    waiting = [root]
    while waiting:
        key = waiting[-1]
        if key in values:
            waiting.pop()
        elif missing := [part for part in parts[key] if part not in values]:
            waiting.append(missing[0])
        else:
            values[key] = function(key)(*(values[part] for part in parts[key]))
            for part in parts[key]:
                uses[part] -= 1
                if not uses[part]:
                    del values[part]
    return values[root]
