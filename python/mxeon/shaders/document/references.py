# SPDX-License-Identifier: Apache-2.0
"""Checks the files that a document names, and the shader code of a document."""

import glob
import html
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cache
from itertools import islice
from pathlib import Path

import MaterialX as mx

import mxeon
from mxeon.errors import DocumentError, InputError
from mxeon.io.files import AnyPath, digest, regular
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.values import label, location
from mxeon.shaders.document.words import ENDS_A_STRING
from mxeon.shaders.document.xml import decode, strict
from mxeon.shaders.library import (
    PROFILES,
    SOURCE_FOLDERS,
    documents_folder,
    eonlib_folder,
    library_folders,
    source_folder,
)
from mxeon.shaders.library_tree import FILES, LARGEST, LIBRARIES, files_in, roots, standard_folders

CODE = ("file", "sourcecode")
ATTRIBUTE = re.compile(r"""([\w:.-]+)\s*=\s*("[^"]*"|'[^']*')""")
NAMING = ("value", "file", "href", "fileprefix")
# Matches the names of files that shader code includes or that documents name.
INCLUDED = re.compile(r"""(?:#include\s+|\b(?:href|file)\s*=\s*)["']([^"'\n]+)["']""")
# Matches placeholders in a file's name: <UDIM>, [token], {frame}.
OPEN_PART = re.compile(r"<[^<>]*>|\[[^][]*\]|\{[^{}]*\}")


def folder(document: mx.Document) -> Path:
    """The folder of a document, to which file names are relative; for text, the working folder."""
    file = document.getSourceUri()
    return Path(file).resolve().parent if file else Path.cwd()


def is_inside(path: AnyPath, home: Path, others: Iterable[str] = ()) -> bool:
    """Whether a path, after following links, lies in `home`, in `others` or in the libraries."""
    real = Path(os.path.realpath(path))
    roots = [home, *(Path(os.path.realpath(each)) for each in others), *_libraries()]
    return any(real.is_relative_to(root) for root in roots)


def check_inside(path: AnyPath, home: Path, policy: Policy, prefix: str) -> None:
    """Raise DocumentError unless a document in the folder `home` may name the file."""
    if not policy.outside and not is_inside(path, home, policy.path):
        raise DocumentError(
            f"{prefix} must name a file in {home}, on the search path or in the libraries; got "
            f"{path}: pass --allowOutside to permit it"
        )


def file_fault(element: mx.ValueElement, policy: Policy) -> str:
    """The reason why an input's file or set of textures must not be read; "" if there is none."""
    text, home, prefix = element.getValueString(), folder(element.getDocument()), location(element)
    if ENDS_A_STRING.search(text):
        remedy = ": write / instead of \\" if "\\" in text else ""
        return f"{prefix} must name a file without quotes and backslashes; got {text}{remedy}"
    path = home / text  # the text is still relative if no file was found
    try:
        check_inside(path, home, policy, prefix)
        if "<" in str(path.parent):
            return f"{prefix} must name one folder; got {text}"
        for file in files(path):
            check_inside(file, home, policy, prefix)
    except DocumentError as error:
        return str(error)
    return ""


def missing_fault(document: mx.Document, path: str, name: str) -> str:
    """A message if the file of an input does not exist, otherwise ""."""
    if files(folder(document) / name):
        return ""
    rule = f'{label(document)}: input "{path}" must name a file that exists; got {name}'
    return f"{rule}: pass its folder as --path FOLDER"


def files(path: Path) -> list[Path]:
    """Existing files for a name: the file itself, or a set of textures for a name with `<UDIM>`."""
    if "<" not in path.name:
        return [path] if os.path.isfile(path) else []
    return list(path.parent.glob(re.sub(r"(<\w*>)+", "*", glob.escape(path.name))))


def foreign_code(document: mx.Document) -> list[mx.Implementation]:
    """Implementations with the document's own shader code."""
    return [
        each
        for each in document.getChildren()  # getImplementations includes the data library
        if each.isA(mx.Implementation) and any(map(each.hasAttribute, CODE))
    ]


def code_faults(document: mx.Document, policy: Policy) -> Iterator[str]:
    """Faults for a document's own code, if the policy forbids the code or the code's files."""
    home = folder(document)
    for element in foreign_code(document):
        prefix = location(element)
        if not policy.code:
            name = next(filter(element.hasAttribute, CODE))
            got = f'{name} "{element.getAttribute(name)}"'
            remedy = "pass --allowCode to permit it"
            yield f"{prefix} must not contain its own code; got {got}: {remedy}"
            continue
        try:
            for path in _sources(element, home, policy.path):
                check_inside(path, home, policy, prefix)
        except DocumentError as error:
            yield str(error)


def _sources(element: mx.Implementation, home: Path, path: Iterable[str]) -> list[Path]:
    """Existing files that a generator may open for an implementation's attribute `file`."""
    name = element.getAttribute("file")
    origin = Path(element.getActiveSourceUri() or home / "document").parent
    bases = (origin, home, Path.cwd(), *map(Path, path), *_libraries())
    return [base / name for base in bases if name and os.path.lexists(base / name)]


def library_path(path: AnyPath) -> str:
    """The path by which MaterialX finds a library file; "" for any other file."""
    if any(Path(path).is_relative_to(each) for each in roots()):
        return str(path)
    real = os.path.realpath(path)
    for root, known in _libraries().items():
        if Path(real).is_relative_to(root):
            return os.path.join(known, os.path.relpath(real, root))
    return ""


@cache
def _libraries() -> dict[Path, str]:
    """Folders whose files any document may use: MaterialX's own and eonlib's."""
    standard = mx.getDefaultDataSearchPath().asString().split(mx.PATH_LIST_SEPARATOR)
    ours = (eonlib_folder(), *(source_folder("eonlib") / name for name in SOURCE_FOLDERS))
    return {Path(each).resolve(): str(each) for each in (*standard, *ours)}


def named_files(document: str, policy: Policy) -> list[str]:
    """A document, and all files that the document and its includes name."""
    home, seen, texts = Path(os.path.realpath(document)).parent, {document: None}, [document]
    for text in texts:  # the loop appends included texts
        folders = {home, Path(os.path.realpath(text)).parent, Path.cwd(), *map(Path, policy.path)}
        # Documents with too many elements are refused, so the files of such documents do not
        # matter.
        for key, name in islice(_names(_text(text, policy)), 6 * policy.elements):
            for path in _paths(name, folders):
                if path not in seen and (policy.outside or is_inside(path, home, policy.path)):
                    seen[path] = None
                    if key in ("href", "file"):
                        texts.append(path)
    return list(seen)


def _text(path: str, policy: Policy) -> str:
    """Text of a document, or "" if the file is too large or cannot be read."""
    with suppress(OSError, DocumentError), open(path, "rb", opener=regular) as file:
        data = file.read(policy.size + 1)
        return strict(decode(data, path)) if len(data) <= policy.size else ""
    return ""


def _names(text: str) -> Iterator[tuple[str, str]]:
    """Keys and values of attributes that may name files, without and with each `fileprefix`."""
    found = dict.fromkeys(
        (key, html.unescape(value[1:-1])) for key, value in ATTRIBUTE.findall(text) if key in NAMING
    )
    found |= dict.fromkeys(("file", each) for each in INCLUDED.findall(text))
    prefixes = ["", *(value for key, value in found if key == "fileprefix")]
    return ((key, prefix + value) for key, value in found if value for prefix in prefixes)


def _paths(name: str, folders: Iterable[Path]) -> Iterator[str]:
    """Real paths of the regular files that a name may refer to."""
    for folder in folders:
        paths = [str(folder / name)]
        if OPEN_PART.search(name):
            paths = glob.glob("*".join(map(glob.escape, OPEN_PART.split(paths[0]))))
        yield from map(os.path.realpath, filter(os.path.isfile, paths))


def documents_in(files: Iterable[AnyPath]) -> tuple[str, ...]:
    """The given files, and the documents in the given folders and their subfolders, in order.

    Raise InputError if a folder contains no document.
    """
    documents: list[str] = []
    for file in files:
        found = [os.fspath(file)]
        if os.path.isdir(file):
            found = sorted(map(str, Path(file).rglob("*.mtlx")))
        if not found:
            raise InputError(f"{file}: must hold MaterialX documents (*.mtlx); there is none")
        documents += found
    return tuple(dict.fromkeys(documents))


def files_read(
    documents: Iterable[AnyPath], policy: Policy, libraries: Iterable[str] = ()
) -> dict[str, str]:
    """Paths of all files that a run on documents may read.

    The keys of installed files begin with "mxeon", "eonlib" or "MaterialX". Documents, files that
    documents may include or name, and files of library folders have their paths as keys.
    """
    paths = {path: path for document in documents for path in named_files(str(document), policy)}
    trusted = {*map(os.path.abspath, {*libraries, *policy.definitions} - {*LIBRARIES})}
    paths |= {path: path for each in sorted(trusted) for path in _library_files(each)}
    folders = [("mxeon", Path(mxeon.__file__).parent), ("eonlib", documents_folder())]
    folders += [(f"eonlib/{name}", source_folder("eonlib") / name) for name in SOURCE_FOLDERS]
    folders += [("MaterialX/libraries", folder) for folder in standard_folders()]
    for name, folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.parent.name != "__pycache__":
                paths[f"{name}/{path.relative_to(folder)}"] = str(path)
    return paths


def _library_files(library: str) -> Iterator[str]:
    """Documents and sources in the folders of a library, and all files that the sources include."""
    for folder in library_folders(library):
        profiles = (folder / profile for profile in PROFILES)  # folders of documents (*.xml)
        names = [path for _, path in files_in(str(folder)) if path.endswith(FILES)]
        for path in (*names, *(str(file) for each in profiles for file in each.glob("*.xml"))):
            yield path
            with suppress(OSError), open(path, encoding="utf-8", errors="replace") as file:
                for name in INCLUDED.findall(file.read(LARGEST)):
                    yield from _paths(name, (Path(path).parent, folder))


def digests(
    documents: Iterable[AnyPath], policy: Policy, libraries: Iterable[str] = ()
) -> dict[str, str]:
    """SHA-256 of each file, with the keys of `files_read`; "" for unreadable or special files."""
    return {name: digest(path) for name, path in files_read(documents, policy, libraries).items()}
