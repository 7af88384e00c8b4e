# SPDX-License-Identifier: Apache-2.0
"""Warnings about documents that MaterialX accepts but misreads.

For each rule, a single warning is issued, about the first element that breaks the rule.
"""

import ctypes
import math
import warnings
from collections.abc import Iterable, Sequence
from typing import cast

import MaterialX as mx

from mxeon.errors import DocumentError, one_line
from mxeon.shaders.document.references import foreign_code, missing_fault
from mxeon.shaders.document.values import NUMERIC, color_spaces, is_exact, label, location, plain
from mxeon.shaders.nodes import DIFFUSE_NODES, FLAG, OREN_NAYAR

COLORED = ("color3", "color4", "filename")
HALF_PI = ctypes.c_float(math.pi / 2.0).value  # MaterialX's float32, slightly above pi / 2


class DocumentWarning(UserWarning):
    """A part of a document that MaterialX accepts but misreads."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class RangeWarning(DocumentWarning):
    """A value outside the domain of a node's model, or outside the range in the node's definition."""


class CodeWarning(UserWarning):
    """Shader code in a document."""


class MissingFileWarning(DocumentError, UserWarning):
    """A shader names files that do not exist, which is an error for code that reads the files."""


def numbers(element: mx.ValueElement) -> tuple[float, ...]:
    """The numbers that MaterialX reads from a value of a numeric type."""
    value = plain(element.getValue(), element.getDocument())
    values = value if isinstance(value, tuple) else () if value is None else (value,)
    return cast(tuple[float, ...], values)


def warn_of_elements(document: mx.Document, elements: Iterable[mx.Element]) -> None:
    """Warn about values that are misread or out of range, and about shader code in a document."""
    values = [each for each in elements if each.isA(mx.ValueElement) and each.getValueString()]
    for kind, note in (
        (DocumentWarning, _misread),
        (RangeWarning, lambda each: out_of_range(each) or _beyond(each)),
        (DocumentWarning, _unknown_space),
    ):
        warn(kind, [text for text in map(note, values) if text])
    warn(DocumentWarning, [text for text in map(_unconnected, elements) if text])
    if names := ", ".join(each.getName() for each in foreign_code(document)):
        warn(CodeWarning, [f"{label(document)}: contains its own code: {names}"])


def warn_of_files(inputs: Iterable[tuple[str, str]], document: mx.Document) -> None:
    """Warn about files that do not exist."""
    texts = [missing_fault(document, path, name) for path, name in dict(inputs).items()]
    if missing := tuple(filter(None, texts)):
        warnings.warn(MissingFileWarning(*missing), stacklevel=3)


def same_names(element: mx.Element) -> tuple[str, ...]:
    """Pairs of nodes that share a name, but lie in different nodegraphs and have different inputs.

    MaterialX gives both nodes of a pair the values of the first node, because the names of a
    shader's inputs omit the nodegraph. Each pair is a text.
    """
    nodes = [element, *(edge.getUpstreamElement() for edge in element.traverseGraph())]
    first: dict[tuple[str, str], mx.Node] = {}
    pairs: dict[str, None] = {}
    for node in nodes:
        if node.isA(mx.Node):
            other = first.setdefault((node.getCategory(), node.getName()), node)
            if other.getNamePath() != node.getNamePath() and _inputs(other) != _inputs(node):
                pairs[f'"{other.getNamePath()}" and "{node.getNamePath()}"'] = None
    return tuple(pairs)


def _inputs(node: mx.Node) -> set[tuple[str, str]]:
    """Names and values of those inputs of a node that have a value."""
    return {
        (port.getName(), port.getValueString())
        for port in node.getInputs()
        if port.hasValueString()
    }


def warn_of_names(elements: Iterable[mx.Element], document: mx.Document) -> None:
    """Warn about the pairs of nodes that `same_names` finds."""
    if not any(each.isA(mx.NodeGraph) for each in document.getChildren()):
        return  # names are unique within a graph
    pairs = dict.fromkeys(pair for element in elements for pair in same_names(element))
    rule = "must have different names; MaterialX gives both nodes the same values"
    warn(DocumentWarning, [f"{label(document)}: nodes {pair} {rule}" for pair in pairs])


def warn(kind: type[Warning], texts: Sequence[str]) -> None:
    """Issue the first of several similar warnings, and append the number of further warnings."""

    if texts:
        also = f"; {len(texts) - 1} more like it" if len(texts) > 1 else ""
        # The warning refers to the caller of the function that calls this module.
        warnings.warn(kind(texts[0] + also), stacklevel=4)


def _misread(element: mx.ValueElement) -> str | None:
    """Warning about a number of which MaterialX reads only the beginning."""
    kind, text = element.getType(), element.getValueString()
    if kind not in NUMERIC or is_exact(text, kind):
        return None
    read = ", ".join(f"{number:g}" for number in numbers(element))
    rule = f"must be a valid {kind}; got {text}, which MaterialX reads as {read}"
    return f"{location(element)} {rule}"


def out_of_range(element: mx.ValueElement) -> str | None:
    """Warning about a value outside the domain of its node's rough diffuse model."""
    node, name = element.getParent(), element.getName()
    diffuse = element.isA(mx.Input) and node.isA(mx.Node) and node.getCategory() in DIFFUSE_NODES
    if not diffuse or name not in ("weight", "color", "roughness"):
        return None
    qualitative = node.getCategory() == OREN_NAYAR and not node.getInputValue(FLAG)
    high = HALF_PI if name == "roughness" and qualitative else 1.0
    if all(0.0 <= number <= high for number in numbers(element)):
        return None
    rule = f"must lie in [0, {1 if high == 1.0 else 'pi/2'}], where its model is defined"
    return f"{location(element)} {rule}; got {element.getValueString()}"


def _beyond(element: mx.ValueElement) -> str | None:
    """Warning about a value below the uimin or above the uimax in its node's definition."""
    node = element.getParent()
    definition = node.getNodeDef() if element.isA(mx.Input) and node.isA(mx.Node) else None
    port = definition and definition.getActiveInput(element.getName())
    if not port or element.getType() not in NUMERIC:
        return None
    ends = [port.getAttribute(name) for name in ("uimin", "uimax")]
    try:
        low, high = (
            [float(each) for each in text.split(",")] if text else [end]
            for text, end in zip(ends, (-math.inf, math.inf), strict=True)
        )
    except ValueError:  # uimin or uimax is not a number
        return None
    values = numbers(element)
    rows = ((values[k], low[k % len(low)], high[k % len(high)]) for k in range(len(values)))
    if all(least <= value <= most for value, least, most in rows):
        return None
    rule = f"must lie in [{ends[0] or '-inf'}, {ends[1] or 'inf'}], the range of its node"
    return f"{location(element)} {rule}; got {element.getValueString()}"


def _unknown_space(element: mx.ValueElement) -> str | None:
    """Warning about a value whose color space has no transform to the document's color space."""
    spaces = color_spaces(element) if element.getType() in COLORED else None
    if not spaces or element.getDocument().getMatchingNodeDefs("_to_".join(spaces)):
        return None
    space, target = spaces
    rule = f"must have a color space with a transform to {target}"
    return f"{location(element)} {rule}; got {space}, which MaterialX takes as {target}"


def _unconnected(element: mx.Element) -> str | None:
    """Warning about an input whose `nodename` names no node but, for example, a nodegraph."""
    if not element.isA(mx.Input) or not element.getNodeName() or element.getConnectedNode():
        return None
    rule = f"must be connected to a node; got nodename {element.getNodeName()!r}"
    remedy = "use the attribute nodegraph for a nodegraph"
    return f"{location(element)} {rule}, which MaterialX ignores: {remedy}"
