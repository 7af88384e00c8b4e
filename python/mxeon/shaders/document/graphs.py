# SPDX-License-Identifier: Apache-2.0
"""Limits the number and the depth of the nodes in a document's shaders, before generation.

MaterialX writes a nodegraph once, but compilers copy the nodegraph to each use. So the nodes of a
nodegraph are counted once per use, but visited only once. A graph in this module maps each key to
its parts. The parts of an element are the nodes upstream of the element. The parts of a definition
are the definitions that the definition uses. No function is recursive, because documents may have
any depth.
"""

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from typing import TypeVar

import MaterialX as mx

from mxeon.errors import DocumentError
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.values import label, location

Key = TypeVar("Key", bound=Hashable)
Graph = Mapping[Key, Iterable[Key]]


def reachable(
    roots: Iterable[Key], parts: Callable[[Key], Iterable[Key] | None]
) -> dict[Key, tuple[Key, ...]]:
    """The graph of all keys that the roots lead to. `parts` returns the parts of a key, or None.

    >>> reachable("a", {"a": "bc", "b": "c", "d": "a"}.get)
    {'a': ('b', 'c'), 'c': (), 'b': ('c',)}
    """
    graph: dict[Key, tuple[Key, ...]] = {}
    waiting = list(roots)
    while waiting:
        key = waiting.pop()
        if key not in graph:
            graph[key] = tuple(parts(key) or ())
            waiting += graph[key]
    return graph


def heights(graph: Graph[Key], order: Iterable[Key]) -> dict[Key, int]:
    """For each key, the number of keys on the longest path to a key without parts."""
    height: dict[Key, int] = {}
    for key in order:
        height[key] = 1 + max((height[part] for part in graph[key]), default=0)
    return height


def check_shaders(
    document: mx.Document, elements: Sequence[mx.TypedElement], policy: Policy
) -> int:
    """Number of nodes in the shaders of renderable elements.

    Raise DocumentError if nodes or nodegraphs form a cycle, or if there are too many shaders,
    nodes, inputs, nodes in a chain, or nested nodegraphs.
    """
    title, rule = label(document), f"{label(document)}: must have"
    counts, total, ports = _NodeCounts(document, policy), 0, 0
    policy.check_limit("shaders", len(elements), rule, "renderable elements")
    for element in elements:
        graph = reachable([element.getNamePath()], lambda path: _upstream(document, path))
        order = _ordered(graph, f"{title}: node", "be upstream of itself")
        longest = max(heights(graph, order).values())
        policy.check_limit("chain", longest, rule, "nodes in a chain")
        for path in order:
            definition = _definition(document.getDescendant(path))
            total += counts[definition]
            ports += _inputs(document.getNodeDef(definition))
        ports += _inputs(element.getParent())
        policy.check_limit("ports", ports, rule, "inputs of nodes in all its shaders")
        policy.check_limit("nodes", total, rule, "nodes in all its shaders")
    return total


def upstream(
    document: mx.Document, elements: Iterable[mx.Element], roots: Iterable[mx.Element]
) -> list[mx.Node]:
    """The nodes among `elements` that are in `roots` or upstream of a root."""
    start = [each.getNamePath() for each in roots]
    paths = reachable(start, lambda path: _upstream(document, path))
    nodes = (each for each in elements if each.isA(mx.Node))
    return [each for each in nodes if each.getNamePath() in paths]


def categories(elements: Iterable[mx.Element]) -> set[str]:
    return {each.getCategory() for each in elements}


def inner_nodes(document: mx.Document) -> Iterator[mx.Element]:
    """Elements of a document and of the graphs that define its nodes."""
    waiting, seen = [document], set()
    while waiting:
        for each in waiting.pop().traverseTree():
            yield each
            graph = each.getImplementation() if each.isA(mx.Node) else None
            if graph and graph.isA(mx.NodeGraph) and graph.getNamePath() not in seen:
                seen.add(graph.getNamePath())
                waiting.append(graph)


def check_inheritance(document: mx.Document, policy: Policy) -> None:
    """Raise DocumentError for inheritance cycles and for chains longer than the limit."""
    parents = {
        each.getName(): (each.getAttribute("inherit"),)
        for each in document.getChildren()
        if each.hasAttribute("inherit")
    }
    graph = reachable(parents, parents.get)
    order = _ordered(graph, f"{label(document)}: definition", "inherit itself")
    deepest = max(heights(graph, order).values(), default=0)
    rule = f"{label(document)}: must have"
    policy.check_limit("depth", deepest, rule, "definitions in a chain of inheritance")


def check_interfaces(document: mx.Document, elements: Sequence[mx.Element], policy: Policy) -> None:
    """Raise DocumentError if an element has too many inputs, or the document too many tokens."""
    widest = max(elements, key=_inputs)
    policy.check_limit("inputs", _inputs(widest), f"{location(widest)} must have", "inputs")
    tokens = sum(element.isA(mx.Token) for element in elements)
    policy.check_limit("tokens", tokens, f"{label(document)}: must have", "tokens")


class _NodeCounts(dict[str, int]):
    """Number of nodes that a node expands to, keyed by the name of the node's definition."""

    def __init__(self, document: mx.Document, policy: Policy) -> None:
        self._document, self._policy = document, policy

    def __missing__(self, name: str) -> int:
        title = label(self._document)
        graph = reachable([name], self._parts)
        order = _ordered(graph, f"{title}: nodedef", "contain itself")
        deepest = max(heights(graph, order).values())
        rule = f"{title}: must have"
        self._policy.check_limit("depth", deepest, rule, "nested nodegraphs")
        for part in order:
            self[part] = 1 + sum(self[each] for each in graph[part])
        return self[name]

    def _parts(self, name: str) -> list[str]:
        """Names of the nodedefs of all nodes in the graphs that implement a nodedef."""
        nodedef = self._document.getNodeDef(name)
        if not nodedef:
            return []
        names = dict.fromkeys((name, nodedef.getQualifiedName(name)))
        matching = [
            each for key in names for each in self._document.getMatchingImplementations(key)
        ]
        graphs = (
            each
            if each.isA(mx.NodeGraph)
            else self._document.getNodeGraph(each.getAttribute("nodegraph"))
            for each in matching
        )
        return [_definition(node) for graph in graphs if graph for node in graph.getNodes()]


def _ordered(graph: Mapping[str, tuple[str, ...]], kind: str, rule: str) -> tuple[str, ...]:
    """The keys of a graph, with each key after its parts. Raise DocumentError for a cycle."""
    try:
        return tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        raise DocumentError(f'{kind} "{min(error.args[1])}" must not {rule}') from None


def _upstream(document: mx.Document, path: str) -> list[str]:
    """Name paths of the nodes that are connected to an element."""
    element = document.getDescendant(path)
    ports = [element] if element.isA(mx.Output) else element.getInputs()
    linked = (
        port.getInterfaceInput() if port.isA(mx.Input) and port.hasInterfaceName() else port
        for port in ports
    )
    nodes = (port.getConnectedNode() for port in linked if port)
    return [node.getNamePath() for node in nodes if node]


def _definition(element: mx.Element) -> str:
    definition = element.getNodeDef() if element.isA(mx.Node) else None
    return definition.getName() if definition else ""


def _inputs(element: mx.Element | None) -> int:
    """Number of an element's inputs; 0 for elements without inputs, such as outputs."""
    return element.getInputCount() if element and element.isA(mx.InterfaceElement) else 0


def surface_shader(document: mx.Document, path: str) -> mx.Node:
    """The surface shader of the material at a name path; a shader is returned unchanged."""
    element = document.getDescendant(path)
    return next(iter(mx.getShaderNodes(element)), element)
