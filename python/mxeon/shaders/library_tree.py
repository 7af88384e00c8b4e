# SPDX-License-Identifier: Apache-2.0
"""The files behind a library that is given as a folder: its own, and those of MaterialX beside them.

A folder is one of three kinds.

whole
    It has targets/, stdlib/ and pbrlib/, and replaces MaterialX's own libraries.
part
    It has files at the same relative paths as MaterialX's libraries, or as one folder in them: pbrlib/,
    or a node's source with its lib/. They replace those files.
overlay
    It has names of its own, as eonlib does, and is loaded before MaterialX's libraries.

MaterialX finds a node's source beside its document, what the source includes beside that, and what the
generator includes on a search path. So a whole or a part is laid out as one tree of links, `libraries`, and
both documents and sources come from there: no installed file can take the place of one in the folder.
"""

import os
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

import MaterialX as mx

from mxeon.errors import InputError

# eonlib as a whole, its diffuse nodes alone, and MaterialX as it comes.
LIBRARIES = ("eonlib", "diffuse", "stock")
WHOLE, PART, OVERLAY = "whole", "part", "overlay"
NEEDED = ("targets", "stdlib", "pbrlib")  # subfolders of a whole
DOCUMENT = ".mtlx"
CODE = (".glsl", ".osl", ".h", ".metal", ".slang", ".mdl")
FILES = (DOCUMENT, *CODE)  # endings of what a library is made of


@dataclass(frozen=True)
class Tree:
    """The files of a library, and where MaterialX finds them.

    Attributes
    ----------
    folder : str
        As given, as an absolute path.
    kind : str
        WHOLE, PART or OVERLAY.
    place : str
        Folder of MaterialX's libraries that a part stands for, such as "pbrlib/genglsl"; "" for all.
    own : tuple of str
        Documents and sources of the folder, relative to it.
    package : tuple of str
        Files of the installed libraries that complete it, relative to these.
    links : mapping of str to str
        The file behind each path below `libraries`; empty for an overlay.
    """

    folder: str
    kind: str
    place: str
    own: tuple[str, ...]
    package: tuple[str, ...]
    links: Mapping[str, str] = field(repr=False)


def tree(library: str) -> Tree:
    """The files of a folder that is a library.

    Raises
    ------
    InputError
        If it cannot be combined with the installed libraries.
    """
    return _tree(os.path.abspath(library))


@cache
def _tree(folder: str) -> Tree:
    own = dict(_files(folder))
    named = tuple(each for each in own if each.endswith(FILES))
    if all(os.path.isdir(os.path.join(folder, "libraries", each)) for each in NEEDED):
        raise InputError(
            f"library {folder}: must be the folder with {', '.join(NEEDED)}; pass {folder}/libraries"
        )
    installed = {path: file for root in standard_folders() for path, file in _files(str(root))}
    # A whole; a library that it has not at all, such as lights/, is the package's.
    if all(os.path.isdir(os.path.join(folder, each)) for each in NEEDED):
        tops = {each.partition("/")[0] for each in own}
        missing = {
            path: file
            for path, file in installed.items()
            if path.endswith(FILES) and path.partition("/")[0] not in tops
        }
        return Tree(folder, WHOLE, "", named, tuple(missing), missing | own)
    # A part, or an overlay; no source may look like another's replacement and be none.
    place = _place(folder, named, installed)
    known = {PurePosixPath(each).name: each for each in installed if each.endswith(CODE)}
    for each in named:
        other = known.get(PurePosixPath(each).name)
        if other and (place is None or place + each not in installed):
            raise InputError(
                f"library {folder}: {each} must lie at {other}, as MaterialX's file of that name, to "
                "replace it; or rename it"
            )
    if place is None:
        return Tree(folder, OVERLAY, "", named, (), {})
    placed = {place + path: file for path, file in own.items()}
    package = tuple(each for each in installed if each.endswith(FILES) and each not in placed)
    return Tree(folder, PART, place.rstrip("/"), named, package, installed | placed)


def _place(folder: str, own: tuple[str, ...], installed: Mapping[str, str]) -> str | None:
    """Folder of the installed libraries, with "/" at its end, where most files have a namesake."""
    paths = defaultdict(list)
    for path in installed:
        paths[PurePosixPath(path).name].append(path)
    places = Counter(
        path.removesuffix(each)
        for each in own
        for path in paths[PurePosixPath(each).name]
        if path == each or path.endswith(f"/{each}")
    )
    best = [each for each, count in places.items() if count == max(places.values())]
    if len(best) > 1:
        raise InputError(
            f"library {folder}: must be one part of MaterialX's libraries; its files may be those of "
            f"{' or '.join(sorted(best))}: put them into folders as MaterialX has them"
        )
    return best[0] if best else None


def _files(folder: str) -> Iterator[tuple[str, str]]:
    """Relative and whole path of every file in a folder, without hidden ones, through links."""
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
    """Files of a folder that is a library, and of MaterialX's libraries that complete it."""
    known = tree(library)
    package = {} if known.kind == OVERLAY else {"MaterialX": known.package}
    return {"folder": known.own, **package}


def root(library: str) -> str:
    """Folder whose `libraries` take the place of MaterialX's own for a library; "" for the installed.

    Each process lays its own, which goes when the process ends.
    """
    known = None if library in LIBRARIES else tree(library)
    return _root(known.folder) if known and known.links else ""


@cache
def _root(library: str) -> str:
    temporary = _temporary(library)
    for path, file in tree(library).links.items():
        link = Path(temporary, "libraries", path)
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(os.path.abspath(file))
    return temporary


_KEPT: dict[str, TemporaryDirectory[str]] = {}  # until the process ends


def _temporary(library: str) -> str:
    _KEPT[library] = TemporaryDirectory(prefix="mxeon-library-")
    return os.path.realpath(_KEPT[library].name)


def search_path(library: str) -> mx.FileSearchPath:
    """Where MaterialX looks for `libraries`, and for what sources include from there."""
    return mx.FileSearchPath(root(library)) if root(library) else mx.getDefaultDataSearchPath()


def roots() -> list[str]:
    """The folders that `root` laid in this process."""
    return [root(library) for library in _KEPT]


def in_words(library: str, text: str) -> str:
    """A message of MaterialX with the user's files in place of the links to them."""
    if laid := root(library):
        for path, file in tree(library).links.items():
            text = text.replace(f"{laid}/libraries/{path}", file)
    return text
