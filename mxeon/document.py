# SPDX-License-Identifier: Apache-2.0
"""Material documents from files and text: reading them, and what is wrong with them.

MaterialX accepts much that no shader can be made from, and ends the process on a nodegraph that
contains itself. Everything of that kind is refused here, in one line, before generation.
"""

import math
import os
from pathlib import Path
from textwrap import shorten

import MaterialX as mx

from mxeon.library import load_library

NUMERIC = ("float", "color3", "color4", "vector2", "vector3", "vector4", "matrix33", "matrix44")
TEXT = "document text"
LONGEST = 1000  # characters of a message, which may quote the document
DIFFUSE_NODES = ("oren_nayar_diffuse_bsdf", "eon_diffuse_bsdf")


class DocumentError(ValueError):
    """A document that no shader can be made from; names the place, the rule and the value."""

    def __init__(self, message):
        super().__init__(shorten(message, LONGEST))


def read_document(source, library="eonlib", profile=None):
    """A checked MaterialX document with its data library attached.

    Parameters
    ----------
    source : path-like, str or MaterialX.Document
        A file; or XML text, recognised by its first character `<`; or a document, which is copied.
        XIncludes and relative file names are resolved from the folder of the file.
    library, profile : str
        See `mxeon.library.load_library`.

    Returns
    -------
    MaterialX.Document

    Raises
    ------
    DocumentError
        If it cannot be read, is not MaterialX or breaks its rules, comes from a later version,
        contains a number that is not finite or out of range, names a file that does not exist, or
        contains itself.
    """
    data = load_library(library, profile)
    document = mx.createDocument()
    if isinstance(source, mx.Document):
        document.copyContentFrom(source)
        document.setSourceUri(source.getSourceUri())
    elif str(source).lstrip().startswith("<"):
        _parse(mx.readFromXmlString, document, str(source), TEXT)
    elif os.path.isfile(source):
        _parse(mx.readFromXmlFile, document, str(source), str(source))
        document.setSourceUri(str(source))
    else:
        raise DocumentError(f"document must be a readable file; got {str(source)!r}")
    mx.flattenFilenames(document, mx.FileSearchPath(str(_folder(document))))
    document.setDataLibrary(data)
    _check(document)
    return document


def label(document):
    """How messages call a document: the file it was read from, or a word for text."""
    return document.getSourceUri() or TEXT


def _folder(document):
    """Where relative file names start: at the document's file, or the working folder for text."""
    file = document.getSourceUri()
    return Path(file).resolve().parent if file else Path.cwd()


def _parse(read, document, source, place):
    try:
        read(document, source)
    except (mx.ExceptionParseError, mx.ExceptionFileMissing, LookupError) as error:
        reason = str(error).strip().splitlines()[0]
        raise DocumentError(f"{place}: must be a MaterialX document; {reason}") from None


def _check(document):
    """Refuse what MaterialX lets through. The order matters: a later check relies on the former."""
    version, known = document.getVersionIntegers(), mx.getVersionIntegers()[:2]
    if tuple(version) > tuple(known):
        raise DocumentError(
            f"{label(document)}: version must be at most {known[0]}.{known[1]}; "
            f"got {version[0]}.{version[1]}"
        )
    _check_recursion(document)
    for element in document.traverseTree():
        if element.isA(mx.ValueElement) and element.getValueString():
            _check_value(element)
    _check_validity(document)


def _check_value(element):
    place = f'{label(element.getDocument())}: {element.getCategory()} "{element.getNamePath()}"'
    kind, text = element.getType(), element.getValueString()
    if kind in NUMERIC:
        if element.getValue() is None:
            raise DocumentError(f"{place} must be a valid {kind} of finite numbers; got {text}")
        low, high = _range(element)
        if not all(low <= float(value) <= high for value in text.split(",")):
            raise DocumentError(f"{place} must lie in [{low:g}, {high:.6g}]; got {text}")
    elif kind == "filename" and "<" not in text and not os.path.isfile(text):
        raise DocumentError(f"{place} must name a file that exists; got {text}")


def _range(element):
    """Range of an input of a rough diffuse node; any number elsewhere."""
    node = element.getParent()
    if node.getCategory() not in DIFFUSE_NODES or not element.isA(mx.Input):
        return -math.inf, math.inf
    if element.getName() in ("weight", "color"):
        return 0.0, 1.0
    if element.getName() != "roughness":
        return -math.inf, math.inf
    flag = node.getInputValue("energy_compensation")
    qualitative = node.getCategory() == "oren_nayar_diffuse_bsdf" and not flag
    return 0.0, math.pi / 2.0 if qualitative else 1.0


def _check_recursion(document):
    """Refuse a nodegraph that contains the node it implements, at any depth."""
    inside = {}
    for graph in document.getChildren():
        definition = graph.getNodeDef() if graph.isA(mx.NodeGraph) else None
        if definition:
            parts = filter(None, (node.getNodeDef() for node in graph.getNodes()))
            inside.setdefault(definition.getName(), set()).update(part.getName() for part in parts)
    for name in inside:
        seen, waiting = set(), [name]
        while waiting:
            parts = inside.get(waiting.pop(), set()) - seen
            if name in parts:
                raise DocumentError(f'{label(document)}: nodedef "{name}" must not contain itself')
            seen |= parts
            waiting.extend(parts)


def _check_validity(document):
    """Refuse what breaks MaterialX's own rules: it would fall back to a default in silence."""
    try:
        valid, message = document.validate()
    except (mx.Exception, LookupError) as error:
        valid, message = False, str(error)
    if not valid:
        reason = message.strip().splitlines()[0]
        raise DocumentError(f"{label(document)}: must be a valid MaterialX document; {reason}")
