# SPDX-License-Identifier: Apache-2.0
"""The files of a library in a folder: its own, plus MaterialX's files that complete it.

A folder is one of three kinds.

whole
    It has targets/, stdlib/ and pbrlib/, and replaces MaterialX's own libraries.
part
    It has files at the same relative paths as MaterialX's libraries. They replace those files.
overlay
    It has its own names, as eonlib does, and is loaded before MaterialX's libraries.

MaterialX looks for a node's source next to its document, for included files next to the source, and
for the generator's includes on a search path. So a whole or a part becomes a temporary folder,
`libraries`, of links to documents and sources: no installed file can replace one in the folder.

A library is trusted, so it may name any file. Pipes, devices and files that are not UTF-8 are still
refused in one line: MaterialX would wait, fill the memory, or write shaders that cannot be decoded.
"""

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

import MaterialX as mx

from mxeon.errors import InputError
from mxeon.io.files import AnyPath, regular
from mxeon.jobs.signals import Temporary, block_signals

# All of eonlib, only its diffuse nodes, and unmodified MaterialX.
LIBRARIES = ("eonlib", "diffuse", "stock")
WHOLE, PART, OVERLAY = "whole", "part", "overlay"
NEEDED = ("targets", "stdlib", "pbrlib")  # subfolders of a whole
DOCUMENT = ".mtlx"
CODE = (".glsl", ".osl", ".h", ".metal", ".slang", ".mdl")
FILES = (DOCUMENT, *CODE)  # endings of a library's files


@dataclass(frozen=True)
class Tree:
    """The files of a library, and where MaterialX finds them."""

    folder: str  # absolute path
    kind: str  # WHOLE, PART or OVERLAY
    own: tuple[str, ...]  # documents and sources of the folder, relative to it
    package: tuple[str, ...]  # relative paths of installed files that complete the folder
    # File to which each path below `libraries` is linked; empty for an overlay.
    links: Mapping[str, str] = field(repr=False)


def tree(library: str) -> Tree:
    """The files of a folder that is a library."""
    return _tree(os.path.abspath(library))


@cache
def _tree(folder: str) -> Tree:
    files = dict(files_in(folder))
    recognized = tuple(each for each in files if each.endswith(FILES))
    if all(os.path.isdir(os.path.join(folder, "libraries", each)) for each in NEEDED):
        raise InputError(
            f"library {folder}: must be the folder with {', '.join(NEEDED)}; pass {folder}/libraries"
        )
    installed = {path: file for root in standard_folders() for path, file in files_in(str(root))}
    if all(os.path.isdir(os.path.join(folder, each)) for each in NEEDED):
        # Libraries that a whole lacks entirely, such as lights/, come from the package.
        tops = {each.partition("/")[0] for each in files}
        kind = WHOLE
        completing = {
            path: file for path, file in installed.items() if path.partition("/")[0] not in tops
        }
    else:
        # Reject a source that would not be used, since it has the name of one of MaterialX's but lies
        # elsewhere. Paths that end in libraries/ and MaterialX's path are found by a search path.
        known = {PurePosixPath(each).name: each for each in installed if each.endswith(CODE)}
        for each in recognized:
            other = known.get(PurePosixPath(each).name)
            if other and each not in installed and not each.endswith(f"/libraries/{other}"):
                raise InputError(
                    f"library {folder}: {each} must lie at {other}, as MaterialX's file of that name, to "
                    "replace it; or rename it"
                )
        if installed.keys().isdisjoint(recognized):
            return Tree(folder, OVERLAY, recognized, (), {})
        kind, completing = PART, installed
    package = tuple(each for each in completing if each.endswith(FILES) and each not in files)
    return Tree(folder, kind, recognized, package, completing | files)


def files_in(folder: str) -> Iterator[tuple[str, str]]:
    """Relative and full path of every file in a folder; follows links and skips hidden files."""
    for top, folders, names in os.walk(folder, followlinks=True):
        home = os.path.realpath(top)
        folders[:] = sorted(
            each
            for each in folders
            if not each.startswith(".")
            and not Path(home).is_relative_to(os.path.realpath(os.path.join(top, each)))
        )
        for each in sorted(names):
            path = os.path.join(top, each)
            if not each.startswith(".") and os.path.isfile(path):
                yield os.path.relpath(path, folder).replace(os.sep, "/"), path


def standard_folders() -> list[Path]:
    """Folders of the installed MaterialX's own data libraries."""
    paths = mx.getDefaultDataSearchPath().asString().split(mx.PATH_LIST_SEPARATOR)
    return [Path(path, name) for path in paths for name in mx.getDefaultDataLibraryFolders()]


def origins(library: str) -> dict[str, tuple[str, ...]]:
    """Files of a library folder, and MaterialX's files that complete it."""
    known = tree(library)
    package = {} if known.kind == OVERLAY else {"MaterialX": known.package}
    return {"folder": known.own, **package}


def root(library: str) -> str:
    """Folder whose `libraries` replace MaterialX's own for a library; "" for the installed libraries.

    Each process creates its own folder, and removes it at its end.
    """
    known = None if library in LIBRARIES else tree(library)
    return _root(known.folder) if known and known.links else ""


@cache
def _root(library: str) -> str:
    with block_signals():
        _FOLDERS[library] = Temporary("mxeon-library-")
    temporary = os.path.realpath(_FOLDERS[library].name)
    for path, file in tree(library).links.items():
        link = Path(temporary, "libraries", path)
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(os.path.abspath(file))
    return temporary


_FOLDERS: dict[str, TemporaryDirectory[str]] = {}  # deleted when the process ends


def search_path(library: str) -> mx.FileSearchPath:
    """Search path for `libraries` and for the files that sources include from there."""
    return mx.FileSearchPath(root(library)) if root(library) else mx.getDefaultDataSearchPath()


def roots() -> list[str]:
    """The folders that `root` created in this process."""
    return [root(library) for library in _FOLDERS]


def with_user_paths(library: str, text: str) -> str:
    """A message of MaterialX that names the user's files instead of the links to them."""
    if laid := root(library):
        for path, file in tree(library).links.items():
            text = text.replace(f"{laid}/libraries/{path}", file)
    return text


INCLUDE = "#include"  # MaterialX's directive for every target


def read_source(path: AnyPath, limit: int) -> bytes:
    """Content of a regular file, at most one byte more than the limit."""
    try:
        with open(path, "rb", opener=regular) as file:
            return file.read(limit + 1)
    except OSError as error:
        raise InputError(f"{path}: must be readable; {error.strerror}") from None


def decode_source(data: bytes, path: AnyPath) -> str:
    """Text of a file with unchanged line endings."""
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: must be text in UTF-8; byte {error.start} is not") from None


def included(line: str) -> str:
    """File that MaterialX includes for a line of source, the text between its outer quotes, or "".

    >>> included('#include "lib/mx_math.glsl"')
    'lib/mx_math.glsl'
    """
    return line[line.index('"') + 1 : line.rindex('"')] if INCLUDE in line and '"' in line else ""


LARGEST = 16 * 2**20  # maximum bytes of a file


def check_files(paths: Iterable[AnyPath]) -> None:
    """Raise InputError unless each path is a regular UTF-8 file of at most LARGEST bytes."""
    for path in paths:
        _text(path)


def check_sources(document: mx.Document, library: str, search: mx.FileSearchPath) -> None:
    """Check the sources of a library's implementations in a document, and all files they include.

    `library` is its folder; MaterialX's own sources are found on the search path.
    """
    folder = Path(library)
    parents = cache(lambda uri: Path(uri).parents)  # many implementations share few documents
    waiting = [
        (each.getFile(), parents(uri)[0])
        for each in document.getImplementations()
        if each.hasFile() and folder in parents(uri := each.getActiveSourceUri())
    ]
    known = set()
    while waiting:
        name, local = waiting.pop()
        folders = mx.FileSearchPath(str(local))
        folders.append(search)
        path = str(folders.find(name).getNormalized().asString())
        if path not in known and os.path.lexists(path):  # MaterialX reports missing files if used
            known.add(path)
            names = filter(None, map(included, _text(path).split("\n")))
            waiting += [(each, Path(path).parent) for each in names]


def read_options() -> mx.XmlReadOptions:
    """Options with which MaterialX checks the files that a library's documents include."""
    options = mx.XmlReadOptions()
    options.readXIncludeFunction = _include
    return options


def _include(
    document: mx.Document,
    name: mx.FilePath,
    path: mx.FileSearchPath,
    options: mx.XmlReadOptions,  # holds the documents that include this one
) -> None:
    file = path.find(name)
    _text(file.asString())
    mx.readFromXmlFile(document, file, path, options)


def _text(path: AnyPath) -> str:
    """Text of a file of a library."""
    data = read_source(path, LARGEST)
    if len(data) > LARGEST:
        raise InputError(f"{path}: must have at most {LARGEST} bytes")
    return decode_source(data, path)


def check_definitions(
    document: mx.Document, base: mx.Document, folders: Iterable[str], search: mx.FileSearchPath
) -> None:
    """Raise InputError if folders of definitions replace names or implementations of a library."""
    for folder in folders:
        check_sources(document, folder, search)
        for each in document.getChildren():
            file = each.getActiveSourceUri()
            if Path(folder) not in Path(file).parents:
                continue
            implements = each.isA(mx.Implementation) or each.isA(mx.NodeGraph)
            definition = base.getNodeDef(each.getNodeDefString()) if implements else None
            same = definition and definition.getImplementation(each.getTarget())
            if same or base.getChild(each.getName()):
                raise InputError(
                    f"{file}: {each.getName()} must not redefine a name of the library: "
                    "rename it, or load the folder with --library"
                )
