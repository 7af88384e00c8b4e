# SPDX-License-Identifier: Apache-2.0
"""Warnings of a document that MaterialX takes, each for the first place of its kind."""

import ctypes
import math
import warnings

import MaterialX as mx

from mxeon.errors import DocumentError, one_line
from mxeon.shaders.document.references import files, folder
from mxeon.shaders.document.values import NUMERIC, is_exact, plain
from mxeon.shaders.nodes import DIFFUSE_NODES, FLAG, OREN_NAYAR

TEXT = "document text"
COLORED = ("color3", "color4", "filename")
HALF_PI = ctypes.c_float(math.pi / 2.0).value  # as MaterialX keeps it, which is above pi / 2


class DocumentWarning(UserWarning):
    """What MaterialX takes, but not for what it says; names the place, the rule and the value."""

    def __init__(self, message):
        super().__init__(one_line(message))


class MissingFileWarning(DocumentError, UserWarning):
    """A file that a shader names and that is not there: an error to whoever has to read it."""


def label(document):
    """How messages call a document: the file it was read from, or a word for text."""
    return document.getSourceUri() or TEXT


def place_of(element):
    """How messages call an element: its document, kind and path."""
    return f'{label(element.getDocument())}: {element.getCategory()} "{element.getNamePath()}"'


def numbers(element):
    """Numbers of a value of a type in NUMERIC, none where MaterialX reads none."""
    value = plain(element.getValue(), element.getDocument())
    return value if isinstance(value, tuple) else () if value is None else (value,)


def warn_of_elements(document):
    """Warn of what MaterialX reads otherwise than it is written, and of values outside a model.

    Warns
    -----
    DocumentWarning
        Once for each kind.
    """
    elements = list(document.traverseTree())
    values = [each for each in elements if each.isA(mx.ValueElement) and each.getValueString()]
    for note in (_misread, _out_of_range, _unknown_space):
        _warn(DocumentWarning, [text for text in map(note, values) if text])
    _warn(DocumentWarning, [text for text in map(_unconnected, elements) if text])


def warn_of_files(shaders, document):
    """Warn of the files that shaders name and that are not there.

    Warns
    -----
    MissingFileWarning
        Once.
    """
    names = {
        each.path: each.value
        for shader in shaders
        for each in shader.inputs
        if each.type == "filename" and each.value
    }
    home = folder(document)
    remedy = "--path FOLDER says where it lies"
    texts = [
        f'{label(document)}: input "{path}" must name a file that exists; got {name}: {remedy}'
        for path, name in names.items()
        if not files(home / name)
    ]
    _warn(MissingFileWarning, texts)


def _warn(kind, texts):
    """Warn of the first of what is alike, and of how many there are: there may be thousands."""
    if texts:
        also = f"; {len(texts) - 1} more like it" if len(texts) > 1 else ""
        warnings.warn(kind(texts[0] + also), stacklevel=4)


def _misread(element):
    """What to say of a number of which MaterialX reads a part."""
    kind, text = element.getType(), element.getValueString()
    if kind in NUMERIC and not is_exact(text, kind):
        read = ", ".join(f"{number:g}" for number in numbers(element))
        rule = f"must be a valid {kind}; got {text}, which MaterialX reads as {read}"
        return f"{place_of(element)} {rule}"


def _out_of_range(element):
    """What to say of a value that the model of its node is not defined for."""
    low, high = _range(element)
    if low > -math.inf and not all(low <= number <= high for number in numbers(element)):
        rule = f"must lie in [{low:g}, {high:.6g}], where its model is defined"
        return f"{place_of(element)} {rule}; got {element.getValueString()}"


def _unknown_space(element):
    """What to say of a value without a transform from its color space to the document's."""
    document, space = element.getDocument(), element.getActiveColorSpace()
    target = document.getColorSpace()
    if element.getType() not in COLORED or {"", "none"} & {space, target} or space == target:
        return None
    if not document.getMatchingNodeDefs(f"{space}_to_{target}"):
        rule = f"must have a color space with a transform to {target}"
        return f"{place_of(element)} {rule}; got {space}, which MaterialX takes as {target}"


def _unconnected(element):
    """What to say of an input that is connected to a nodegraph as if that were a node."""
    if element.isA(mx.Input) and element.getNodeName() and not element.getConnectedNode():
        rule = f"must be connected to a node; got nodename {element.getNodeName()!r}"
        remedy = "a nodegraph is connected by nodegraph"
        return f"{place_of(element)} {rule}, which MaterialX ignores: {remedy}"


def _range(element):
    """Range of an input of a rough diffuse node; any number elsewhere."""
    node = element.getParent()
    lobe = node.isA(mx.Node) and node.getCategory() in DIFFUSE_NODES
    if not lobe or not element.isA(mx.Input):
        return -math.inf, math.inf
    if element.getName() in ("weight", "color"):
        return 0.0, 1.0
    if element.getName() != "roughness":
        return -math.inf, math.inf
    flag = node.getInputValue(FLAG)
    qualitative = node.getCategory() == OREN_NAYAR and not flag
    return 0.0, HALF_PI if qualitative else 1.0
