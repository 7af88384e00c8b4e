# SPDX-License-Identifier: Apache-2.0
"""SHA-256 of the files that a run depends on, so that --resume goes on with the same ones.

MaterialX may end the process on a document, so none is parsed: each attribute that can name a file
counts as if it did. A file too many may be listed, but none too few.
"""

import glob
import hashlib
import html
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path

import mxeon
from mxeon.errors import DocumentError
from mxeon.io.files import regular
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import inside
from mxeon.shaders.document.xml import decode, strict
from mxeon.shaders.library import SOURCE_FOLDERS, documents_folder, library_folders, source_folder
from mxeon.shaders.library_tree import LIBRARIES, standard_folders

ATTRIBUTE = re.compile(r"""([\w:.-]+)\s*=\s*("[^"]*"|'[^']*')""")
NAMING = ("value", "file", "href", "fileprefix")
# A part of a file's name that is filled in later: <UDIM>, [token], {frame}.
OPEN_PART = re.compile(r"<[^<>]*>|\[[^][]*\]|\{[^{}]*\}")


def digests(
    documents: Iterable[str | os.PathLike[str]], policy: Policy, libraries: Iterable[str] = ()
) -> dict[str, str]:
    """SHA-256 of every file that a run depends on; "" for what is no regular file or cannot be read.

    By path: the documents, what they include and name as far as the policy permits, and what lies in
    folders of libraries. By names that begin with "mxeon", "eonlib" or "MaterialX": code and data here.
    """
    paths = {path: path for document in documents for path in _named(str(document), policy)}
    folders = [
        (str(folder), folder)
        for library in set(libraries) - set(LIBRARIES)
        for folder in library_folders(library)
    ]
    folders += [("mxeon", Path(mxeon.__file__).parent), ("eonlib", documents_folder())]
    folders += [(f"eonlib/{name}", source_folder("eonlib") / name) for name in SOURCE_FOLDERS]
    folders += [("MaterialX/libraries", folder) for folder in standard_folders()]
    for name, folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.parent.name != "__pycache__":
                paths[f"{name}/{path.relative_to(folder)}"] = str(path)
    return {name: _digest(path) for name, path in paths.items()}


def _named(document: str, policy: Policy) -> list[str]:
    """A document, and the files that it and what it includes name."""
    home, seen, texts = Path(os.path.realpath(document)).parent, {document: None}, [document]
    for text in texts:  # which grows by what is included
        folders = {home, Path(os.path.realpath(text)).parent, Path.cwd(), *map(Path, policy.path)}
        # A document with more elements than it may have is refused, and its files do not count.
        for key, name in islice(_names(_text(text, policy)), 6 * policy.elements):
            for path in _paths(name, folders):
                if path not in seen and (policy.outside or inside(path, home, policy.path)):
                    seen[path] = None
                    if key == "href":
                        texts.append(path)
    return list(seen)


def _text(path: str, policy: Policy) -> str:
    """Text of a document, or "" of one that is too large or cannot be read."""
    with suppress(OSError, DocumentError), open(path, "rb", opener=regular) as file:
        data = file.read(policy.size + 1)
        return strict(decode(data, path)) if len(data) <= policy.size else ""
    return ""


def _names(text: str) -> Iterator[tuple[str, str]]:
    """Attributes of a document that may name files, each with every prefix that the document has."""
    found = dict.fromkeys(
        (key, html.unescape(value[1:-1])) for key, value in ATTRIBUTE.findall(text) if key in NAMING
    )
    prefixes = ["", *(value for key, value in found if key == "fileprefix")]
    return ((key, prefix + value) for key, value in found if value for prefix in prefixes)


def _paths(name: str, folders: Iterable[Path]) -> Iterator[str]:
    """The regular files that a name may mean, by their real paths."""
    for folder in folders:
        paths = [str(folder / name)]
        if OPEN_PART.search(name):
            paths = glob.glob("*".join(map(glob.escape, OPEN_PART.split(paths[0]))))
        yield from map(os.path.realpath, filter(os.path.isfile, paths))


def _digest(path: str) -> str:
    with suppress(OSError), open(path, "rb", opener=regular) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
    return ""
