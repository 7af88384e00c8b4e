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

from mxeon.errors import DocumentError
from mxeon.shaders.document.encoding import decode, strict
from mxeon.shaders.document.graph_size import check_inheritance, check_interfaces
from mxeon.shaders.document.notes import (
    TEXT,
    DocumentWarning,
    label,
    numbers,
    place_of,
    warn_of_elements,
)
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.document.references import check_code, check_file, check_inside, files, folder
from mxeon.shaders.document.values import NUMERIC
from mxeon.shaders.document.words import check_words
from mxeon.shaders.document.xml import Screening, check_limit
from mxeon.shaders.library import load_library

__all__ = ["DocumentError", "DocumentWarning", "label", "read_document"]

ERRORS = (mx.Exception, LookupError)  # what MaterialX raises


def read_document(source, library="eonlib", profile=None, policy=DEFAULT):
    """A checked MaterialX document with its data library attached.

    Parameters
    ----------
    source : path-like, str or MaterialX.Document
        A file; or XML text, a str that begins with `<` and names no file; or a document, which is
        copied. XIncludes and relative file names are looked for in the folder of the file, or the
        working folder, and then on the search path that the policy name.
    library, profile : str
        See `mxeon.shaders.library.load_library`.
    policy : Policy
        What the document may do, how large it may be, and where its files are looked for.

    Returns
    -------
    MaterialX.Document

    Raises
    ------
    DocumentError
        If it cannot be read, is not MaterialX or breaks its rules, comes from a later version,
        contains a number that is none or not finite, includes itself, or does what it may not.

    Warns
    -----
    DocumentWarning
        If a number is not what MaterialX reads, a value leaves the range of its model, or there is
        no transform from a color space: once each, for the first place.
    """
    data = load_library(library, profile)
    document = mx.createDocument()
    if isinstance(source, mx.Document):
        document.copyContentFrom(source)
        document.setSourceUri(source.getSourceUri())
    elif _is_text(source):
        _Reader(policy, Path.cwd()).text(document, source)
    elif os.path.isfile(source):  # a pipe or a device may have no end
        _check_path(source)
        _Reader(policy, Path(source).resolve().parent).file(document, str(source))
    else:
        raise DocumentError(f"document must be a readable file; got {str(source)!r}")
    _find_files(document, [folder(document), *map(Path, policy.path)])
    document.setDataLibrary(data)
    _check(document, policy)
    return document


def _is_text(source):
    """Whether a source is XML text: a path is none, whatever the name of its file begins with."""
    starts = isinstance(source, str) and source.lstrip("\ufeff \t\r\n").startswith("<")
    return starts and not os.path.isfile(source)


def _find_files(document, folders):
    """Make names of files that are in one of the folders absolute, those of sets of files too."""
    path = mx.FileSearchPath()
    for each in folders:
        path.append(mx.FilePath(str(each)))
    mx.flattenFilenames(document, path)
    for element in document.traverseTree():
        name = element.getValueString() if element.isA(mx.ValueElement) else ""
        if "<" in name and element.getType() == "filename":
            sets = (each / name for each in folders if files(each / name))
            element.setValueString(str(next(sets, name)))


def _check_path(source):
    """Raise DocumentError unless MaterialX can hold the path of a file."""
    try:
        str(Path(source).resolve()).encode()
    except UnicodeEncodeError:
        raise DocumentError(f"document must lie at a path in UTF-8; got {source!r}") from None


class _Reader:
    """Reads a document and what it includes, of which MaterialX sees only what was judged.

    Parameters
    ----------
    policy : Policy
    home : Path
        The folder of the document.
    """

    def __init__(self, policy, home):
        self._permissions, self._home = policy, home
        self._screening = Screening(policy)
        self._open = []  # files that are being read, each included by the one before

    def file(self, document, name):
        """Read a file into a document."""
        data = self._screening.read(name)
        self._screening.measure(data, name)
        self._open.append(os.path.realpath(name))
        self._parse(document, decode(data, name), name)
        self._open.pop()
        document.setSourceUri(name)

    def text(self, document, text):
        """Read XML text into a document."""
        data = text.encode(errors="replace")  # halves of characters
        self._screening.measure(data, TEXT)
        self._parse(document, data.decode().removeprefix("\ufeff"), TEXT)

    def _parse(self, document, text, place):
        text = strict(text)
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
        _check_version(document, place)

    def _include(self, document, name, place):
        """Read what the document at `place` includes, which is called by its real path."""
        base = self._home if place == TEXT else Path(place).parent
        folders = (base, self._home, *self._permissions.path)
        paths = [os.path.realpath(Path(each, name)) for each in folders]
        path, rule = next(filter(os.path.isfile, paths), paths[0]), f"{place}: include must"
        check_inside(path, self._home, self._permissions, f"{place}: include")
        if path in self._open:
            raise DocumentError(f"{rule} not lead back to the same document; got {name}")
        check_limit(self._permissions, "includes", len(self._open), f"{rule} be", "in a row")
        if not os.path.isfile(path):
            raise DocumentError(f"{rule} name a file that exists; got {name}")
        self.file(document, path)


def _check(document, policy):
    """Refuse what MaterialX lets through. The order matters: a later check relies on the former."""
    _check_version(document, label(document))
    check_inheritance(document, policy, label(document))
    check_interfaces(document, policy, label(document))
    check_code(document, policy, label(document))
    check_words(document, label(document))
    _check_types(document)
    for element in document.traverseTree():
        if element.isA(mx.ValueElement) and element.getValueString():
            _check_value(element, policy)
    _check_validity(document)
    warn_of_elements(document)


def _check_version(document, place):
    """Raise DocumentError for a version that MaterialX did not make its own while it was read."""
    known = mx.getVersionIntegers()[:2]
    if tuple(document.getVersionIntegers()) != tuple(known):
        raise DocumentError(
            f"{place}: version must be one that MaterialX upgrades to {known[0]}.{known[1]}; "
            f"got {document.getVersionString()!r}"
        )


def _check_types(document):
    """Refuse members of a type that the libraries define: generators would end the process."""
    for each in document.getChildren():
        known = each.isA(mx.TypeDef) and document.getDataLibrary().getTypeDef(each.getName())
        if known and (members := each.getChildren()):
            raise DocumentError(
                f"{place_of(each)} must have no members, as a type of the libraries; "
                f"got {members[0].getName()}: rename the type"
            )


def _check_value(element, policy):
    kind, text = element.getType(), element.getValueString()
    if kind in NUMERIC:
        read = numbers(element)
        if not read or not all(map(math.isfinite, read)):
            rule = f"a valid {kind} of finite numbers"
            raise DocumentError(f"{place_of(element)} must be {rule}; got {text}")
    elif kind == "filename":
        check_file(element, place_of(element), policy)


def _check_validity(document):
    """Refuse what breaks MaterialX's own rules: it would fall back to a default in silence."""
    try:
        valid, message = document.validate()
    except ERRORS as error:
        valid, message = False, str(error)
    if not valid:
        reason = message.strip().splitlines()[0]
        raise DocumentError(f"{label(document)}: must be a valid MaterialX document; {reason}")
