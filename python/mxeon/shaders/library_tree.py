# SPDX-License-Identifier: Apache-2.0
"""The files of a library that is a folder: the folder's own files, plus files of MaterialX.

There are three kinds of library folders.

whole
    The folder has targets/, stdlib/ and pbrlib/, and replaces MaterialX's libraries.
part
    The folder has files at the same relative paths as MaterialX's libraries, and replaces only
    those files.
overlay
    All files have new names, as in eonlib. The folder is loaded before MaterialX's libraries.

MaterialX looks for a node's source next to the node's document, for included files next to the
source, and for the generator's includes on a search path. So mxeon links the documents and sources
of a whole or a part from a temporary folder, `libraries`, where no installed file can replace a
file of the library.

A library is trusted, so a library may name any file. Pipes, devices and files that are not UTF-8
are still refused, because MaterialX would wait, fill the memory, or write unreadable shaders.
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

# Libraries: all of eonlib, only the diffuse nodes of eonlib, and unmodified MaterialX.
LIBRARIES = ("eonlib", "diffuse", "stock")
WHOLE, PART, OVERLAY = "whole", "part", "overlay"
NEEDED = ("targets", "stdlib", "pbrlib")  # subfolders of a library of the kind "whole"
DOCUMENT = ".mtlx"
CODE = (".glsl", ".osl", ".h", ".metal", ".slang", ".mdl")
FILES = (DOCUMENT, *CODE)  # endings of a library's files


@dataclass(frozen=True)
class Tree:
    """The files of a library folder, and the links through which MaterialX finds the files."""

    folder: str  # absolute path
    kind: str  # WHOLE, PART or OVERLAY
    own: tuple[str, ...]  # relative paths of the folder's documents and sources
    package: tuple[str, ...]  # relative paths of installed files that complete the folder
    # For each path of a link below `libraries`, the target of the link. An overlay has no links.
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
        # Libraries that the folder lacks entirely, such as lights/, come from the installed
        # package.
        tops = {each.partition("/")[0] for each in files}
        kind = WHOLE
        completing = {
            path: file for path, file in installed.items() if path.partition("/")[0] not in tops
        }
    else:
        # MaterialX would ignore a source that has the name of a MaterialX source but another
        # relative path. A search path may lead to a folder `libraries`, which may precede the path.
        known = {PurePosixPath(each).name: each for each in installed if each.endswith(CODE)}
        for each in recognized:
            other = known.get(PurePosixPath(each).name)
            if other and each not in installed and not each.endswith(f"/libraries/{other}"):
                raise InputError(
                    f"library {folder}: {each} must lie at {other} to replace MaterialX's file of that "
                    "name; otherwise rename it"
                )
        if installed.keys().isdisjoint(recognized):
            return Tree(folder, OVERLAY, recognized, (), {})
        kind, completing = PART, installed
    package = tuple(each for each in completing if each.endswith(FILES) and each not in files)
    return Tree(folder, kind, recognized, package, completing | files)


def files_in(folder: str) -> Iterator[tuple[str, str]]:
    """Relative and full paths of a folder's files. Links are followed, and hidden files skipped."""
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
    """The files of a library folder, and the files of MaterialX that complete the library."""
    known = tree(library)
    package = {} if known.kind == OVERLAY else {"MaterialX": known.package}
    return {"folder": known.own, **package}


def root(library: str) -> str:
    """Temporary folder in which `libraries` replaces MaterialX's libraries; "" if there is none.

    Each process creates its own folder, and removes the folder when the process ends.
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
    """The search path for MaterialX's libraries and for the files that sources include."""
    return mx.FileSearchPath(root(library)) if root(library) else mx.getDefaultDataSearchPath()


def roots() -> list[str]:
    """The folders that `root` created in this process."""
    return [root(library) for library in _FOLDERS]


def with_user_paths(library: str, text: str) -> str:
    """A message of MaterialX in which the paths of the user's files replace the paths of links."""
    if laid := root(library):
        for path, file in tree(library).links.items():
            text = text.replace(f"{laid}/libraries/{path}", file)
    return text


INCLUDE = "#include"  # directive that MaterialX replaces for every target


def read_source(path: AnyPath, limit: int) -> bytes:
    """The content of a regular file, cut off one byte after the limit."""
    try:
        with open(path, "rb", opener=regular) as file:
            return file.read(limit + 1)
    except OSError as error:
        raise InputError(f"{path}: must be readable; {error.strerror}") from None


def decode_source(data: bytes, path: AnyPath) -> str:
    """Decode the content of a file, without changing line endings."""
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: must be text in UTF-8; byte {error.start} is not") from None


def included(line: str) -> str:
    """The file that a line of source includes, which is the text between the outer quotes; or "".

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
    """Check the sources of a library's implementations in a document, and all included files.

    `library` is the folder of the library. The search path leads to MaterialX's own sources.
    """
    folder = Path(library)
    parents = cache(lambda uri: Path(uri).parents)  # cached, since many sources share a document
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
        # MaterialX reports a missing file when the file is used.
        if path not in known and os.path.lexists(path):
            known.add(path)
            names = filter(None, map(included, _text(path).split("\n")))
            waiting += [(each, Path(path).parent) for each in names]


def read_options() -> mx.XmlReadOptions:
    """Options for reading XML that make MaterialX check each file that a document includes."""
    options = mx.XmlReadOptions()
    options.readXIncludeFunction = _include
    return options


def _include(
    document: mx.Document,
    name: mx.FilePath,
    path: mx.FileSearchPath,
    options: mx.XmlReadOptions,  # also lists all including documents
) -> None:
    file = path.find(name)
    _text(file.asString())
    mx.readFromXmlFile(document, file, path, options)


def _text(path: AnyPath) -> str:
    """Text of a library's file. Raise InputError if the file is too large or not UTF-8."""
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
