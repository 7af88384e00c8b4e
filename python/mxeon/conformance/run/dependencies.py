# SPDX-License-Identifier: Apache-2.0
"""Digests of the files that the findings of a run depend on, so that it is resumed with the same.

Documents are not parsed as MaterialX does, since that may end the process: each attribute that can
name a file is taken as if it did, so a file too many may be listed, but none too few.
"""

import glob
import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from xml.parsers import expat

import mxeon
from mxeon.errors import DocumentError, InputError
from mxeon.io.files import regular
from mxeon.shaders.document.encoding import decode, strict
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import inside
from mxeon.shaders.library import SOURCE_FOLDERS, documents_folder, library_folders, source_folder
from mxeon.shaders.library_tree import LIBRARIES, standard_folders

INCLUDE, NAMING = "href", ("value", "file", "href")  # attributes
# A part of a file's name that is filled in later: <UDIM>, [token], {frame}.
OPEN_PART = re.compile(r"<[^<>]*>|\[[^][]*\]|\{[^{}]*\}")


def digests(
    documents: Iterable[str | os.PathLike[str]], policy: Policy, libraries: Iterable[str] = ()
) -> dict[str, str]:
    """SHA-256 of every file that findings on documents depend on.

    By path: the documents, what they include and name as far as the policy permits, and what lies in folders of
    libraries; by names that begin with "mxeon", "eonlib" or "MaterialX": the code and the data libraries. ""
    for what is no regular file or cannot be read.
    """
    found = {}
    for document in documents:
        for path in (str(document), *_named(Path(document), policy)):
            if path not in found:
                found[path] = _digest(path)
    for library in set(libraries) - set(LIBRARIES):
        for folder in library_folders(library):
            found |= {str(path): _digest(path) for path in folder.rglob("*") if path.is_file()}
    return found | _installed()


def _named(document: Path, policy: Policy) -> list[str]:
    """The files that a document includes and names, and those that the included ones do."""
    home, seen = Path(os.path.realpath(document)).parent, set[str]()
    waiting: list[str | Path] = [document]
    while waiting:
        text_file = waiting.pop()
        for key, name in _names(_text(text_file, policy), policy.elements):
            folders = {home, Path(os.path.realpath(text_file)).parent, Path.cwd()}
            for path in _paths(name, folders | set(map(Path, policy.path))):
                allowed = policy.outside or inside(path, home, policy.path)
                if path in seen or not allowed:
                    continue
                seen.add(path)
                if key == INCLUDE:
                    waiting.append(path)
    return sorted(seen)


def _text(path: Path | str, policy: Policy) -> str:
    """Text of a document, or "" of one that is too large or cannot be read."""
    with suppress(OSError, DocumentError), open(path, "rb", opener=regular) as file:
        data = file.read(policy.size + 1)
        return strict(decode(data, str(path))) if len(data) <= policy.size else ""
    return ""


def _names(text: str, elements: int) -> list[tuple[str, str]]:
    """Attributes of a document that may name files, with their prefix: as far as it may be read."""
    names: list[tuple[str, str]] = []
    prefixes = [""]

    def start(_: str, attributes: dict[str, str]) -> None:
        if len(names) > 2 * len(NAMING) * elements:
            refuse()
        prefixes.append(attributes.get("fileprefix", prefixes[-1]))
        for key in NAMING:
            if value := attributes.get(key):
                names.extend((key, name) for name in {value, prefixes[-1] + value})

    def refuse(*_: object) -> None:
        raise InputError("no document that is refused has findings of its files")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = start, lambda _: prefixes.pop()
    parser.StartDoctypeDeclHandler = refuse
    with suppress(expat.ExpatError, LookupError, ValueError):
        parser.Parse(text, True)
    return names


def _paths(name: str, folders: Iterable[Path]) -> Iterator[str]:
    """The regular files that a name may mean, by their real paths."""
    for folder in folders:
        paths = [str(folder / name)]
        if OPEN_PART.search(name):
            paths = glob.glob("*".join(map(glob.escape, OPEN_PART.split(paths[0]))))
        yield from map(os.path.realpath, filter(os.path.isfile, paths))


def _installed() -> dict[str, str]:
    """Digests of mxeon's code and of the data libraries, by names that hold on any machine."""
    folders = [("mxeon", Path(mxeon.__file__).parent), ("eonlib", documents_folder())]
    folders += [(f"eonlib/{name}", source_folder("eonlib") / name) for name in SOURCE_FOLDERS]
    folders += [("MaterialX/libraries", folder) for folder in standard_folders()]
    return {
        f"{name}/{path.relative_to(folder)}": _digest(path)
        for name, folder in folders
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.parent.name != "__pycache__"
    }


def _digest(path: str | os.PathLike[str]) -> str:
    with suppress(OSError), open(path, "rb", opener=regular) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
    return ""
