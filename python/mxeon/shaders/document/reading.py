# SPDX-License-Identifier: Apache-2.0
"""Material documents from files and text, checked.

MaterialX accepts documents that no shader can be generated from, reads every file that a document
names, and copies its words into shaders. Such documents are refused here, in one line, before
generation: their text before MaterialX reads it (`xml`), their elements after.
"""

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeGuard

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import DocumentError
from mxeon.io.files import AnyPath
from mxeon.shaders.document.encoding import decode, strict
from mxeon.shaders.document.graph_size import check_inheritance, check_interfaces, check_shaders
from mxeon.shaders.document.labels import TEXT, label, location
from mxeon.shaders.document.notes import DocumentWarning, numbers, warn_of_elements
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.document.references import check_code, check_file, check_inside, files, folder
from mxeon.shaders.document.values import NUMERIC
from mxeon.shaders.document.words import check_words
from mxeon.shaders.document.xml import XmlChecker
from mxeon.shaders.library import load_library

__all__ = ["Document", "DocumentError", "DocumentWarning", "read_document"]

ERRORS = (mx.Exception, LookupError)  # raised by MaterialX


@dataclass(frozen=True)
class Document:
    """A checked document.

    Attributes
    ----------
    content : MaterialX.Document
        With its data library attached.
    renderables : tuple of MaterialX.TypedElement
        Its renderable elements; at least one.
    nodes : int
        Number of nodes in their shaders, nodegraphs counted wherever they are used.
    """

    content: mx.Document
    renderables: tuple[mx.TypedElement, ...]
    nodes: int


def read_document(
    source: AnyPath | mx.Document,
    library: str = "eonlib",
    profile: str | None = None,
    policy: Policy = DEFAULT,
) -> Document:
    """A checked MaterialX document with its data library attached.

    Parameters
    ----------
    source : path-like, str or MaterialX.Document
        A file; or XML text, a str that begins with `<` and names no file; or a document, which is
        copied. XIncludes and relative file names are looked for in the folder of the file, or the
        working folder, and then on the policy's search path.
    library, profile : str
        See `mxeon.shaders.library.load_library`.
    policy : Policy
        Permissions, limits and search path.

    Returns
    -------
    Document

    Raises
    ------
    DocumentError
        If it cannot be read, is not MaterialX or breaks its rules, comes from a later version,
        contains a number that is not finite, includes itself, exceeds a limit, needs a permission
        that the policy does not give, or has no renderable element.

    Warns
    -----
    DocumentWarning
        If MaterialX reads a number otherwise than written, a value leaves the range of its model, or
        a color space has no transform: once each, for the first place.
    CodeWarning
        If it brings shader code of its own.
    """
    # Read the source, with all that it includes.
    data = load_library(library, profile, policy.definitions)
    content = mx.createDocument()
    if isinstance(source, mx.Document):
        content.copyContentFrom(source)
        content.setSourceUri(source.getSourceUri())
    elif _is_text(source):
        _Reader(policy, Path.cwd()).read_text(content, source)
    elif os.path.isfile(source):  # a pipe or a device may have no end
        _check_path(source)
        _Reader(policy, Path(source).resolve().parent).read_file(content, str(source))
    else:
        raise DocumentError(f"document must be a readable file; got {str(source)!r}")
    # Check what the content says.
    elements = tuple(content.traverseTree())
    _check_tokens(elements)
    _resolve_files(content, elements, [folder(content), *map(Path, policy.path)])
    content.setDataLibrary(data)
    _check(content, elements, policy)
    # Limit what shaders would grow from it.
    renderables = _renderables(content)
    nodes = check_shaders(content, renderables, policy)
    warn_of_elements(content, elements)
    return Document(content, renderables, nodes)


def _is_text(source: AnyPath) -> TypeGuard[str]:
    """Whether a source is XML text; the path of a file is not, even if it begins with `<`."""
    starts = isinstance(source, str) and source.lstrip("\ufeff \t\r\n").startswith("<")
    return starts and not os.path.isfile(source)


def _check_tokens(elements: Iterable[mx.Element]) -> None:
    """Raise DocumentError for tokens of names: MaterialX resolves them by themselves, for ever."""
    for element in elements:
        if element.isA(mx.Token) and element.getType() in ("filename", "geomname"):
            raise DocumentError(
                f"{location(element)} must not have the type {element.getType()}, which ends "
                "MaterialX: give it the type string"
            )


def _resolve_files(
    document: mx.Document, elements: Iterable[mx.Element], folders: list[Path]
) -> None:
    """Make names of files that lie in one of the folders absolute, also of sets of files."""
    path = mx.FileSearchPath()
    for each in folders:
        path.append(mx.FilePath(str(each)))
    mx.flattenFilenames(document, path)
    for element in elements:
        name = element.getValueString() if element.isA(mx.ValueElement) else ""
        if "<" in name and element.getType() == "filename":
            sets = (each / name for each in folders if files(each / name))
            element.setValueString(str(next(sets, name)))


def _check_path(source: AnyPath) -> None:
    """Raise DocumentError unless MaterialX can hold the path of a file."""
    try:
        str(Path(source).resolve()).encode()
    except UnicodeEncodeError:
        raise DocumentError(f"document must lie at a path in UTF-8; got {source!r}") from None


class _Reader:
    """Reader of a document and its includes, whose text is checked before MaterialX reads it.

    Parameters
    ----------
    policy : Policy
    home : Path
        The folder of the document.
    """

    def __init__(self, policy: Policy, home: Path) -> None:
        self._policy, self._home = policy, home
        self._checker = XmlChecker(policy)
        self._open: list[str] = []  # files that are being read, each included by the one before

    def read_file(self, document: mx.Document, name: str) -> None:
        """Read a file into a document."""
        data = self._checker.read(name)
        self._checker.check_size(data, name)
        self._open.append(os.path.realpath(name))
        self._parse(document, decode(data, name), name)
        self._open.pop()
        document.setSourceUri(name)

    def read_text(self, document: mx.Document, text: str) -> None:
        """Read XML text into a document."""
        data = text.encode(errors="replace")  # halves of characters
        self._checker.check_size(data, TEXT)
        self._parse(document, data.decode().removeprefix("\ufeff"), TEXT)

    def _parse(self, document: mx.Document, text: str, title: str) -> None:
        # Check the text before MaterialX sees it.
        text = strict(text)
        self._checker.check(text, title)

        # Let MaterialX ask for each file that it includes.
        def include(part: mx.Document, name: mx.FilePath, *_: object) -> None:
            self._include(part, name.asString(), title)

        options = mx.XmlReadOptions()
        options.readXIncludeFunction = include
        # Parse it.
        try:
            mx.readFromXmlString(document, text, mx.FileSearchPath(), options)
        except (*ERRORS, mx.ExceptionParseError) as error:
            reason = str(error).strip().splitlines()[0]
            raise DocumentError(f"{title}: must be a MaterialX document; {reason}") from None
        _check_version(document, title)

    def _include(self, document: mx.Document, name: str, title: str) -> None:
        """Read a file that the document `title` includes, by its real path."""
        # Find the file.
        base = self._home if title == TEXT else Path(title).parent
        folders = [base, self._home, *map(Path, self._policy.path)]
        paths = [os.path.realpath(each / name) for each in folders]
        path, rule = next(filter(os.path.isfile, paths), paths[0]), f"{title}: include must"
        # Refuse what lies outside, repeats itself, or is missing.
        check_inside(path, self._home, self._policy, f"{title}: include")
        if path in self._open:
            raise DocumentError(f"{rule} not lead back to the same document; got {name}")
        self._policy.check_limit("includes", len(self._open), f"{rule} be", "in a row")
        if not os.path.isfile(path):
            raise DocumentError(f"{rule} name a file that exists; got {name}")
        # Read it.
        self.read_file(document, path)


def _check(document: mx.Document, elements: Sequence[mx.Element], policy: Policy) -> None:
    """Check a document that MaterialX has read. Later checks rely on earlier ones."""
    _check_version(document, label(document))
    check_inheritance(document, policy)
    check_interfaces(document, elements, policy)
    check_code(document, policy)
    check_words(document, elements)
    _check_types(document)
    for element in elements:
        if element.isA(mx.ValueElement) and element.getValueString():
            _check_value(element, policy)
    _check_validity(document)


def _check_version(document: mx.Document, title: str) -> None:
    """Raise DocumentError for a version that MaterialX did not upgrade while reading."""
    current = tuple(mx.getVersionIntegers()[:2])
    if tuple(document.getVersionIntegers()) != current:
        raise DocumentError(
            f"{title}: version must be one that MaterialX upgrades to {current[0]}.{current[1]}; "
            f"got {document.getVersionString()!r}"
        )


def _check_types(document: mx.Document) -> None:
    """Raise DocumentError for members of the libraries' types: generators would end the process."""
    for each in document.getChildren():
        standard = each.isA(mx.TypeDef) and document.getDataLibrary().getTypeDef(each.getName())
        if standard and (members := each.getChildren()):
            raise DocumentError(
                f"{location(each)} must have no members, as a type of the libraries; "
                f"got {members[0].getName()}: rename the type"
            )


def _check_value(element: mx.ValueElement, policy: Policy) -> None:
    kind, text = element.getType(), element.getValueString()
    if kind in NUMERIC:
        read = numbers(element)
        if not read or not all(map(math.isfinite, read)):
            rule = f"a valid {kind} of finite numbers"
            raise DocumentError(f"{location(element)} must be {rule}; got {text}")
    elif kind == "filename":
        check_file(element, policy)


def _check_validity(document: mx.Document) -> None:
    """Raise DocumentError if MaterialX's own rules are broken: it would take defaults silently."""
    try:
        valid, message = document.validate()
    except ERRORS as error:
        valid, message = False, str(error)
    if not valid:
        reason = message.strip().splitlines()[0]
        raise DocumentError(f"{label(document)}: must be a valid MaterialX document; {reason}")


def _renderables(document: mx.Document) -> tuple[mx.TypedElement, ...]:
    """Renderable elements of a document; none is a DocumentError.

    MaterialX looks for materials among the thousands of elements of the data library as well.
    """
    nodes = (each for each in document.getChildren() if each.isA(mx.Node))
    materials = [each for each in nodes if each.getType() == "material"]
    elements = tuple(filter(mx.getShaderNodes, materials))
    elements = elements or tuple(mx_gen.findRenderableElements(document))
    if not elements:
        raise DocumentError(
            f"{label(document)}: must contain a renderable element (a surfacematerial, a surface "
            "shader or an output of one); there is none"
        )
    return elements
