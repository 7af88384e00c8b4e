# SPDX-License-Identifier: Apache-2.0
"""How many nodes the shaders of a document have, and how deep they are, before any is generated.

MaterialX writes a nodegraph once, however often it is used; a compiler copies it to each place. So
nodes are counted as often as they are used, by weights, without visiting them as often. Nothing
here recurses: depth is what is to be found out.
"""

from graphlib import CycleError

import MaterialX as mx

from mxeon.errors import DocumentError
from mxeon.shaders.document.graphs import heights, parts_first, reachable
from mxeon.shaders.document.xml import check_limit


def check_expansion(document, elements, policy, called):
    """Nothing, if the shaders of renderable elements stay within the limits.

    Parameters
    ----------
    document : MaterialX.Document
    elements : sequence of MaterialX.TypedElement
    policy : Policy
    called : str
        What messages call the document.

    Raises
    ------
    DocumentError
        If nodes or nodegraphs lead back to themselves, or there are too many of them, or of their
        inputs, in all, in a row or within each other.
    """
    rule, total, ports = f"{called}: must have", 0, 0
    weights, weigh = {}, _Weights(document, policy, called)
    check_limit(policy, "shaders", len(elements), rule, "renderable elements")
    for element in elements:
        graph = reachable([element.getNamePath()], lambda path: _upstream(document, path))
        order = _ordered(graph, f"{called}: node", "be upstream of itself")
        longest = max(heights(graph, order).values())
        check_limit(policy, "chain", longest, rule, "nodes in a row")
        for path in order:
            definition = _definition(document.getDescendant(path))
            if definition not in weights:
                weights[definition] = weigh(definition)
            total += weights[definition]
            ports += _inputs(document.getNodeDef(definition))
        ports += _inputs(element.getParent())
        check_limit(policy, "ports", ports, rule, "inputs of nodes in all its shaders")
        check_limit(policy, "nodes", total, rule, "nodes in all its shaders")


def check_inheritance(document, policy, called):
    """Nothing, if definitions inherit each other in rows short enough, and not themselves.

    Raises
    ------
    DocumentError
        Otherwise.
    """
    heirs = [each for each in document.getChildren() if each.hasAttribute("inherit")]
    graph = reachable(
        [each.getName() for each in heirs],
        {each.getName(): [each.getAttribute("inherit")] for each in heirs}.get,
    )
    order = _ordered(graph, f"{called}: definition", "inherit itself")
    deepest = max(heights(graph, order).values(), default=0)
    rule = f"{called}: must have"
    check_limit(policy, "depth", deepest, rule, "definitions that inherit each other")


def check_interfaces(document, policy, called):
    """Raise DocumentError if an element has too many inputs, or there are too many tokens."""
    tokens = 0
    for element in document.traverseTree():
        tokens += element.isA(mx.Token)
        rule = f'{called}: {element.getCategory()} "{element.getNamePath()}" must have'
        check_limit(policy, "inputs", _inputs(element), rule, "inputs")
    check_limit(policy, "tokens", tokens, f"{called}: must have", "tokens")


class _Weights:
    """How many nodes a node stands for, by the name of its nodedef."""

    def __init__(self, document, policy, called):
        self._document, self._permissions, self._called = document, policy, called

    def __call__(self, name):
        graph = reachable([name], self._parts)
        order = _ordered(graph, f"{self._called}: nodedef", "contain itself")
        deepest, rule = max(heights(graph, order).values()), f"{self._called}: must have"
        check_limit(self._permissions, "depth", deepest, rule, "nodegraphs within each other")
        weights = {}
        for each in order:
            weights[each] = 1 + sum(weights[part] for part in graph[each])
        return weights[name]

    def _parts(self, name):
        """The nodedefs of all nodes in the graphs that implement a nodedef."""
        nodedef = self._document.getNodeDef(name)
        if not nodedef:
            return []
        names = dict.fromkeys((name, nodedef.getQualifiedName(name)))
        found = [each for key in names for each in self._document.getMatchingImplementations(key)]
        graphs = (self._graph(each) for each in found)
        return [_definition(node) for graph in graphs if graph for node in graph.getNodes()]

    def _graph(self, implementation):
        if implementation.isA(mx.NodeGraph):
            return implementation
        return self._document.getNodeGraph(implementation.getAttribute("nodegraph"))


def _ordered(graph, kind, rule):
    """Its keys, each after its parts."""
    try:
        return parts_first(graph)
    except CycleError as error:
        raise DocumentError(f'{kind} "{min(error.args[1])}" must not {rule}') from None


def _upstream(document, path):
    """Name paths of the nodes that an element is connected to."""
    element = document.getDescendant(path)
    ports = [element] if element.isA(mx.Output) else element.getInputs()
    connected = (_connected(port) for port in ports)
    return [node.getNamePath() for node in connected if node]


def _connected(port):
    if port.isA(mx.Input) and port.hasInterfaceName():
        port = port.getInterfaceInput()
    return port.getConnectedNode() if port else None


def _definition(element):
    definition = element.getNodeDef() if element.isA(mx.Node) else None
    return definition.getName() if definition else ""


def _inputs(element):
    """How many inputs an element has, if it is one that can."""
    return len(element.getInputs()) if element and element.isA(mx.InterfaceElement) else 0
