# SPDX-License-Identifier: Apache-2.0
"""Reads material documents from files and text, and checks the documents.

MaterialX accepts documents from which no shader can be generated, reads every file that a document
names, and copies names and text values into shaders. So mxeon checks the text of a document before
MaterialX reads the text, and checks the elements before generation. Each fault is reported on one
line.
"""

import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from xml.parsers import expat

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import STEERING, DocumentError
from mxeon.io.files import AnyPath
from mxeon.names import meant
from mxeon.shaders.document import graphs, references, words, xml
from mxeon.shaders.document.notes import DocumentWarning, numbers, warn, warn_of_elements
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.document.values import NUMERIC, TEXT, label, location
from mxeon.shaders.library import load_library

__all__ = ["Document", "DocumentError", "DocumentWarning", "read_document"]

RAISED = (mx.Exception, LookupError)  # exceptions that MaterialX raises
LONGEST_NAME = 128  # characters; a file name contains several names and may have 255
SIMILAR = 0.85  # minimum similarity of a suggested category; many categories have the same ending


@dataclass(frozen=True)
class Document:
    """A checked document."""

    content: mx.Document  # document with its data library attached
    renderables: tuple[mx.TypedElement, ...]  # one or more renderable elements
    nodes: int  # number of nodes in all shaders; a nodegraph counts at each use
    missing: tuple[str, ...] = ()  # a message for each missing file that a shader names


def read_document(
    source: AnyPath | mx.Document,
    library: str = "eonlib",
    profile: str | None = None,
    policy: Policy = DEFAULT,
) -> Document:
    """A checked MaterialX document with its data library attached.

    The source is a file, XML text, or a document, which is copied. A str is XML text if the str
    begins with `<` and names no file. XIncludes and relative file names are looked up in the file's
    folder (in the working folder for text) and then on the policy's search path. Raise
    DocumentError, which lists all faults, for an invalid document.
    """
    data = load_library(library, profile, policy.definitions)
    content = mx.createDocument()
    if not isinstance(source, str | os.PathLike | mx.Document):
        raise DocumentError(f"document must be a file, XML text or a document; got {source!r}")
    if isinstance(source, mx.Document):
        content.copyContentFrom(source)
        content.setSourceUri(source.getSourceUri())
    elif (
        isinstance(source, str)
        and source.lstrip("\ufeff \t\r\n").startswith("<")
        and not os.path.isfile(source)  # a path may also begin with `<`
    ):
        _Reader(policy, Path.cwd()).read_text(content, source)
    elif os.path.isfile(source):  # reading a pipe or a device may never end
        path = Path(source).resolve()
        try:
            str(path).encode()
        except UnicodeEncodeError:
            raise DocumentError(f"document must lie at a path in UTF-8; got {source!r}") from None
        _Reader(policy, path.parent).read_file(content, str(source))
    else:
        raise DocumentError(f"document must be a readable file; got {str(source)!r}")
    elements = tuple(content.traverseTree())
    for each in elements:  # MaterialX loops forever on self-referencing tokens
        if each.isA(mx.Token) and each.getType() in ("filename", "geomname"):
            raise DocumentError(
                f"{location(each)} must not have the type {each.getType()}, which crashes "
                "MaterialX: give it the type string"
            )
    _resolve_files(content, elements, [references.folder(content), *map(Path, policy.path)])
    content.setDataLibrary(data)
    _check_version(content, label(content))
    graphs.check_inheritance(content, policy)
    graphs.check_interfaces(content, elements, policy)
    _raise(
        [
            *references.code_faults(content, policy),
            *words.word_faults(content, elements),
            *_types(content),
        ]
    )
    faults = list(_faults(content, elements, policy))
    # MaterialX's own search visits all elements of the data library, so look for materials first.
    nodes = (each for each in content.getChildren() if each.isA(mx.Node))
    materials = (each for each in nodes if each.getType() == "material")
    renderables = tuple(filter(mx.getShaderNodes, materials))
    renderables = renderables or tuple(mx_gen.findRenderableElements(content))
    shown = graphs.upstream(content, elements, renderables)
    faults += _undefined(content, shown)
    missing = tuple(_missing(shown, policy))
    _raise([*faults, *missing] if faults else [])
    if not renderables:
        raise DocumentError(_nothing_drawn(content))
    count = graphs.check_shaders(content, renderables, policy)
    warn_of_elements(content, elements)
    return Document(content, renderables, count, missing)


def _resolve_files(
    document: mx.Document, elements: Iterable[mx.Element], folders: list[Path]
) -> None:
    """Make file names absolute for files and sets of textures that exist in one of the folders."""
    path = mx.FileSearchPath()
    for each in folders:
        path.append(mx.FilePath(str(each)))
    mx.flattenFilenames(document, path)
    for element in elements:
        name = element.getValueString() if element.isA(mx.ValueElement) else ""
        if "<" in name and element.getType() == "filename":
            found = (each / name for each in folders if references.files(each / name))
            element.setValueString(str(next(found, name)))


class _Reader:
    """Reads a document and its includes, and checks the texts before MaterialX reads the texts.

    MaterialX keeps in memory what it reads, and follows every include immediately. So a parser that
    stores nothing first counts the bytes, elements and attributes of a document and its includes.
    """

    def __init__(self, policy: Policy, home: Path) -> None:
        self._policy, self._home = policy, home
        self._size = self._elements = self._attributes = 0
        self._open: list[str] = []  # stack of the files being read

    def read_file(self, document: mx.Document, name: str) -> None:
        """Read a file into a document."""
        try:
            # Read one byte more than the limit, to notice that a file exceeds the limit.
            with Path(name).open("rb") as stream:
                size = min(self._policy.size - self._size, os.fstat(stream.fileno()).st_size)
                data = stream.read(size + 1)
        except OSError as error:
            raise DocumentError(f"{name}: must be readable; {error.strerror}") from None
        self._count(data, name)
        self._open.append(os.path.realpath(name))
        self._parse(document, xml.decode(data, name), name)
        self._open.pop()
        document.setSourceUri(name)

    def read_text(self, document: mx.Document, text: str) -> None:
        """Read XML text into a document."""
        data = text.encode(errors="replace")  # lone surrogates become question marks
        self._count(data, TEXT)
        self._parse(document, data.decode().removeprefix("\ufeff"), TEXT)

    def _count(self, data: bytes, title: str) -> None:
        self._size += len(data)
        rule, unit = f"{title}: must have", "bytes, with all that it includes"
        self._policy.check_limit("size", self._size, rule, unit)

    def _parse(self, document: mx.Document, text: str, title: str) -> None:
        text = xml.strict(text)
        warn(DocumentWarning, self._ignored(text, title))

        def include(part: mx.Document, name: mx.FilePath, *_: object) -> None:
            self._include(part, name.asString(), title)

        options = mx.XmlReadOptions()
        options.readXIncludeFunction = include
        try:
            mx.readFromXmlString(document, text, mx.FileSearchPath(), options)
        except (*RAISED, mx.ExceptionParseError) as error:
            reason = str(error).strip().splitlines()[0]
            raise DocumentError(f"{title}: must be a MaterialX document; {reason}") from None
        _check_version(document, title)

    def _ignored(self, text: str, title: str) -> list[str]:
        """Check the elements of a text; return a fault for each element that MaterialX ignores."""
        names: list[set[str]] = [set()]  # names of siblings at each level
        ignored: list[str] = []
        limit = partial(self._policy.check_limit, rule=f"{title}: must have")

        def start(category: str, attributes: Mapping[str, str]) -> None:
            self._elements += 1
            self._attributes += len(attributes)
            limit("depth", len(names), unit="nested elements")
            limit("elements", self._elements, unit="elements, with all that it includes")
            limit("attributes", self._attributes, unit="attributes, with all that it includes")
            for key, value in attributes.items():
                if len(value) > self._policy.length:
                    limit("length", len(value), unit=f"characters in {key!r} of {category!r}")
                if STEERING.search(value):
                    rule = f"must have no control characters in {key!r}"
                    raise DocumentError(f"{title}: {category} {rule}; got {value!r}")
            if len(name := attributes.get("name", "")) > LONGEST_NAME:
                rule = f"must have a name of at most {LONGEST_NAME} characters"
                raise DocumentError(f"{title}: {category} {rule}; got {name}")
            if name in names[-1]:
                rule = "must have a name that no sibling has; MaterialX ignores it"
                ignored.append(f"{title}: {category} {name!r} {rule}")
            names[-1] |= {name} - {""}
            names.append(set())

        def refuse_type(name: str, *_: object) -> None:
            rule = "must have no document type, which may define entities"
            raise DocumentError(f"{title}: {rule}; got DOCTYPE {name}")

        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = refuse_type
        parser.StartElementHandler = start
        parser.EndElementHandler = lambda _: names.pop()
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
            usd = title.lower().endswith((".usd", ".usda", ".usdc", ".usdz"))
            remedy = "; a renderer that reads USD is checked by its images: mxeon kit export" * usd
            raise DocumentError(
                f"{title}: must be a MaterialX document; XML parse error: {error}{remedy}"
            ) from None
        return ignored

    def _include(self, document: mx.Document, name: str, title: str) -> None:
        """Read a file that the document `title` includes."""
        base = self._home if title == TEXT else Path(title).parent
        folders = [base, self._home, *map(Path, self._policy.path)]
        paths = [os.path.realpath(each / name) for each in folders]
        path, rule = next(filter(os.path.isfile, paths), paths[0]), f"{title}: include must"
        references.check_inside(path, self._home, self._policy, f"{title}: include")
        if path in self._open:
            raise DocumentError(f"{rule} not lead back to the same document; got {name}")
        self._policy.check_limit("includes", len(self._open), f"{rule} be", "deep")
        if not os.path.isfile(path):
            raise DocumentError(f"{rule} name a file that exists; got {name}")
        self.read_file(document, path)


def _raise(faults: Sequence[str]) -> None:
    """Raise DocumentError if there are faults."""
    if faults:
        raise DocumentError(*dict.fromkeys(faults))


def _types(document: mx.Document) -> Iterator[str]:
    """Faults in types that the document defines; each fault would crash a generator."""
    for each in filter(lambda child: child.isA(mx.TypeDef), document.getChildren()):
        for member in each.getChildren():
            if member.getAttribute("type") == "filename":
                yield (
                    f"{location(each)} must have no member of type filename, because a shader's "
                    f"struct cannot hold an image; got {member.getName()}: make it an input"
                )
        standard = document.getDataLibrary().getTypeDef(each.getName())
        if standard and (members := each.getChildren()):
            yield (
                f"{location(each)} must have no members, because the libraries define it; "
                f"got {members[0].getName()}: rename the type"
            )


def _faults(document: mx.Document, elements: Iterable[mx.Element], policy: Policy) -> Iterator[str]:
    """Values that MaterialX would replace by defaults, and violations of MaterialX's rules."""
    reported = set()
    for each in elements:
        text, fault = each.getValueString() if each.isA(mx.ValueElement) else "", ""
        if text and (kind := each.getType()) in NUMERIC:
            read = numbers(each)
            if not read or not all(map(math.isfinite, read)):
                fault = f"{location(each)} must be a valid {kind} of finite numbers; got {text}"
        elif text and kind == "filename":
            fault = references.file_fault(each, policy)
        if fault:
            reported.add(each.asString())
            yield fault
    # MaterialX reports only one wrong input per node and suggests no other name, so mxeon looks for
    # wrong inputs.
    try:
        valid, message = document.validate()
    except RAISED as error:
        valid, message = False, str(error)
    if valid:
        return
    nodes = (each for each in elements if each.isA(mx.Node))
    wrong = [(each, fault) for node in nodes for each, fault in _input_faults(node)]
    yield from (fault for _, fault in wrong)
    reported |= {each.asString() for each, _ in wrong}
    for line in message.strip().splitlines():
        interface = wrong and line.startswith("Node interface error: Input")
        if not interface and f"<{line.partition(': <')[2]}" not in reported:
            yield f"{label(document)}: must be a valid MaterialX document; {line}"


def _check_version(document: mx.Document, title: str) -> None:
    """Raise DocumentError unless MaterialX has upgraded the document to its own version."""
    current = tuple(mx.getVersionIntegers()[:2])
    if tuple(document.getVersionIntegers()) != current:
        raise DocumentError(
            f"{title}: version must be one that MaterialX upgrades to {current[0]}.{current[1]}; "
            f"got {document.getVersionString()!r}"
        )


def _input_faults(node: mx.Node) -> Iterator[tuple[mx.Input, str]]:
    """Each invalid input of a node, with the rule that the input breaks."""
    if not (definition := node.getNodeDef("", True)):  # the definition may have other inputs
        return
    ports = {each.getName(): each.getType() for each in definition.getActiveInputs()}
    for each in node.getInputs():
        name, kind, category = each.getName(), each.getType(), node.getCategory()
        rule = f"must be an input of {category}; got {name!r}{meant(name, ports)}"
        if name in ports:
            rule = f"must have the type {ports[name]} of {category}; got {kind}"
        source = each.getNodeName()
        if kind != ports.get(name):
            yield each, f"{location(each)} {rule}"
        elif source and not (each.getConnectedNode() or node.getDocument().getNodeGraph(source)):
            near = meant(source, [other.getName() for other in node.getParent().getNodes()])
            yield each, f"{location(each)} is connected to {source!r}, which does not exist{near}"


def _undefined(document: mx.Document, nodes: Iterable[mx.Node]) -> Iterator[str]:
    """A fault for each category of nodes that has no definition; the fault names the first node."""
    groups: dict[tuple[str, str], list[mx.Node]] = {}
    for node in nodes:
        if not node.getNodeDef("", True):
            groups.setdefault((node.getCategory(), node.getType()), []).append(node)
    for (category, kind), (first, *more) in groups.items():
        same = (each for each in document.getNodeDefs() if each.getType() == kind)
        near = meant(category, {each.getNodeString() for each in same} - {category}, SIMILAR)
        remedy = near or ": load further definitions by --definitions FOLDER"
        others = f", with {len(more)} more" if more else ""
        yield (
            f'{label(document)}: node "{first.getNamePath()}"{others} must have a definition; got '
            f"{category} of type {kind}{remedy}"
        )


def _nothing_drawn(document: mx.Document) -> str:
    """A message for a document without a material that has a surface shader, and without output."""
    rule = "must contain a surfacematerial with a surface shader, or an output"
    kinds = "surfaceshader", "material", "volumeshader", "BSDF"
    nodes = (each for kind in kinds for each in document.getNodes() if each.getType() == kind)
    node = next(nodes, None)
    if not node:
        return f"{label(document)}: {rule}; there is none"
    text = f"{label(document)}: {rule}; got {node.getCategory()} {node.getName()!r}"
    if node.getType() != "surfaceshader":
        return text
    return f"{text}: connect it to the input surfaceshader of a surfacematerial"


def _missing(nodes: Iterable[mx.Node], policy: Policy) -> Iterator[str]:
    """A fault for each input that names a missing file which the policy permits to read."""
    for each in (port for node in nodes for port in node.getInputs()):
        port = each.getInterfaceInput() if each.hasInterfaceName() else each
        if port and port.getType() == "filename" and (name := port.getValueString()):
            missing = references.missing_fault(port.getDocument(), port.getNamePath(), name)
            if missing and not references.file_fault(port, policy):
                yield missing
