# SPDX-License-Identifier: Apache-2.0
"""Material documents from files and text: reading them, and what is wrong with them.

MaterialX accepts much that no shader can be made from, reads every file that a document names, and
copies its words into shaders. What should not be is refused here, in one line, before generation:
the text before MaterialX reads it (`screening`), the document after.
"""

import math
import os
from pathlib import Path

import MaterialX as mx

from mxeon.expansion import check_inheritance, check_interfaces
from mxeon.library import load_library
from mxeon.permissions import DEFAULT
from mxeon.screening import DocumentError, Screening, check_limit
from mxeon.trust import check_code, check_file, check_inside, folder
from mxeon.words import check_words

__all__ = ["DocumentError", "label", "read_document"]

# How many numbers a value has.
NUMERIC = {"float": 1, "color3": 3, "color4": 4, "vector2": 2, "vector3": 3, "vector4": 4}
NUMERIC |= {"matrix33": 9, "matrix44": 16}
TEXT = "document text"
ERRORS = (mx.Exception, LookupError)  # what MaterialX raises
DIFFUSE_NODES = ("oren_nayar_diffuse_bsdf", "eon_diffuse_bsdf")


def read_document(source, library="eonlib", profile=None, permissions=DEFAULT):
    """A checked MaterialX document with its data library attached.

    Parameters
    ----------
    source : path-like, str or MaterialX.Document
        A file; or XML text, recognised by its first character `<`; or a document, which is copied.
        XIncludes and relative file names are resolved from the folder of the file.
    library, profile : str
        See `mxeon.library.load_library`.
    permissions : Permissions
        What the document may do, and how large it may be.

    Returns
    -------
    MaterialX.Document

    Raises
    ------
    DocumentError
        If it cannot be read, is not MaterialX or breaks its rules, comes from a later version,
        contains a number that is not finite or out of range, names a file that does not exist,
        includes itself, or does what it may not.
    """
    data = load_library(library, profile)
    document = mx.createDocument()
    if isinstance(source, mx.Document):
        document.copyContentFrom(source)
        document.setSourceUri(source.getSourceUri())
    elif str(source).lstrip().startswith("<"):
        _Reader(permissions, Path.cwd()).parse(document, str(source).encode(errors="replace"), TEXT)
    elif os.path.isfile(source):  # a pipe or a device may have no end
        _Reader(permissions, Path(source).resolve().parent).file(document, str(source))
    else:
        raise DocumentError(f"document must be a readable file; got {str(source)!r}")
    mx.flattenFilenames(document, mx.FileSearchPath(str(folder(document))))
    document.setDataLibrary(data)
    _check(document, permissions)
    return document


class _Reader:
    """Reads a document and what it includes, of which MaterialX sees only what was judged.

    Parameters
    ----------
    permissions : Permissions
    home : Path
        The folder of the document.
    """

    def __init__(self, permissions, home):
        self._permissions, self._home = permissions, home
        self._screening = Screening(permissions)
        self._open = []  # files that are being read, each included by the one before

    def file(self, document, name):
        """Read a file into a document."""
        text = self._screening.read(name)
        self._open.append(os.path.realpath(name))
        self.parse(document, text, name)
        self._open.pop()
        document.setSourceUri(name)

    def parse(self, document, text, place):
        """Read bytes into a document."""
        self._screening.judge(text, place)

        def include(part, name, *_):
            self._include(part, name.asString(), place)

        options = mx.XmlReadOptions()
        options.readXIncludeFunction = include
        try:
            mx.readFromXmlString(document, text, mx.FileSearchPath(), options)
        except (*ERRORS, mx.ExceptionParseError) as error:
            reason = str(error).strip().splitlines()[0]
            raise DocumentError(f"{place}: must be a MaterialX document; {reason}") from None

    def _include(self, document, name, place):
        """Read what the document at `place` includes, which is called by its real path."""
        base = self._home if place == TEXT else Path(place).parent
        path, rule = os.path.realpath(base / name), f"{place}: include must"
        check_inside(path, self._home, self._permissions, f"{place}: include")
        if path in self._open:
            raise DocumentError(f"{rule} not lead back to the same document; got {name}")
        check_limit(self._permissions, "includes", len(self._open), f"{rule} be", "in a row")
        if not os.path.isfile(path):
            raise DocumentError(f"{rule} name a file that exists; got {name}")
        self.file(document, path)


def label(document):
    """How messages call a document: the file it was read from, or a word for text."""
    return document.getSourceUri() or TEXT


def _check(document, permissions):
    """Refuse what MaterialX lets through. The order matters: a later check relies on the former."""
    version, known = document.getVersionIntegers(), mx.getVersionIntegers()[:2]
    if tuple(version) > tuple(known):
        raise DocumentError(
            f"{label(document)}: version must be at most {known[0]}.{known[1]}; "
            f"got {version[0]}.{version[1]}"
        )
    check_inheritance(document, permissions, label(document))
    check_interfaces(document, permissions, label(document))
    check_code(document, permissions, label(document))
    check_words(document, label(document))
    _check_types(document)
    for element in document.traverseTree():
        if element.isA(mx.ValueElement) and element.getValueString():
            _check_value(element, permissions)
    _check_validity(document)


def _check_types(document):
    """Refuse members of a type that the libraries define: generators would end the process."""
    for each in document.getChildren():
        known = each.isA(mx.TypeDef) and document.getDataLibrary().getTypeDef(each.getName())
        if known and (members := each.getChildren()):
            raise DocumentError(
                f"{_place(each)} must have no members, as a type of the libraries; "
                f"got {members[0].getName()}: rename the type"
            )


def _check_value(element, permissions):
    kind, text = element.getType(), element.getValueString()
    if kind in NUMERIC:
        if element.getValue() is None or text.count(",") != NUMERIC[kind] - 1:
            rule = f"a valid {kind} of finite numbers"
            raise DocumentError(f"{_place(element)} must be {rule}; got {text}")
        low, high = _range(element)
        if not all(low <= float(value) <= high for value in text.split(",")):
            raise DocumentError(f"{_place(element)} must lie in [{low:g}, {high:.6g}]; got {text}")
    elif kind == "filename":
        check_file(element, _place(element), permissions)


def _place(element):
    """How messages call an element: its document, kind and path."""
    return f'{label(element.getDocument())}: {element.getCategory()} "{element.getNamePath()}"'


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
    flag = node.getInputValue("energy_compensation")
    qualitative = node.getCategory() == "oren_nayar_diffuse_bsdf" and not flag
    return 0.0, math.pi / 2.0 if qualitative else 1.0


def _check_validity(document):
    """Refuse what breaks MaterialX's own rules: it would fall back to a default in silence."""
    try:
        valid, message = document.validate()
    except ERRORS as error:
        valid, message = False, str(error)
    if not valid:
        reason = message.strip().splitlines()[0]
        raise DocumentError(f"{label(document)}: must be a valid MaterialX document; {reason}")
