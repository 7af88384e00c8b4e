# SPDX-License-Identifier: Apache-2.0
"""Files of a folder that is loaded as a library: text of limited size, and nothing without an end.

A library is trusted, so it may name any file. A pipe, a device or an encoding is still refused in one
line: MaterialX would wait, fill the memory, or give text that no one can decode.
"""

import os
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import MaterialX as mx

from mxeon.errors import InputError
from mxeon.io.files import AnyPath
from mxeon.shaders.source_text import decode_source, included, read_source

LARGEST = 16 * 2**20  # bytes of a file


def check_files(paths: Iterable[AnyPath]) -> None:
    """Raise InputError unless each is a regular file of text in UTF-8, and no larger than LARGEST."""
    for path in paths:
        _text(path)


def check_sources(document: mx.Document, library: str, search: mx.FileSearchPath) -> None:
    """Check every source that a library's implementations in a document name, and all that it includes.

    The library is given by its folder; MaterialX's own sources are looked for on the search path.
    """
    # The sources that the library's own implementations name.
    folder = Path(library)
    parents = cache(lambda uri: Path(uri).parents)  # of few documents, for many implementations
    waiting = [
        (each.getFile(), parents(uri)[0])
        for each in document.getImplementations()
        if each.hasFile() and folder in parents(uri := each.getActiveSourceUri())
    ]
    # Each of them once, and what it includes.
    known = set()
    while waiting:
        name, local = waiting.pop()
        path = _find(search, name, local)
        if path not in known and os.path.lexists(path):  # what is missing is told when it is used
            known.add(path)
            names = filter(None, map(included, _text(path).split("\n")))
            waiting += [(each, Path(path).parent) for each in names]


def read_options() -> mx.XmlReadOptions:
    """Options by which MaterialX reads the documents of a library, and checks what they include."""
    options = mx.XmlReadOptions()
    options.readXIncludeFunction = _include
    return options


def _include(
    document: mx.Document,
    name: mx.FilePath,
    path: mx.FileSearchPath,
    options: mx.XmlReadOptions,  # knows the documents that include this one
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


def _find(search: mx.FileSearchPath, name: str, local: Path) -> str:
    """Path that MaterialX finds for a source, or the name."""
    path = mx.FileSearchPath(str(local))
    path.append(search)
    return str(path.find(name).getNormalized().asString())


def check_definitions(
    document: mx.Document, base: mx.Document, folders: Iterable[str], search: mx.FileSearchPath
) -> None:
    """Raise InputError if folders of definitions replace names or implementations of a library."""
    for folder in folders:
        check_sources(document, folder, search)
        for each in document.getChildren():
            file = each.getActiveSourceUri()
            if Path(folder) in Path(file).parents and _replaces(each, base):
                raise InputError(
                    f"{file}: {each.getName()} must replace nothing of the library, which has it: "
                    "give it another name, or load the folder by --library"
                )


def _replaces(element: mx.Element, base: mx.Document) -> bool:
    """Whether a library has an element of that name, or an implementation of that node and target."""
    if base.getChild(element.getName()):
        return True
    implements = element.isA(mx.Implementation) or element.isA(mx.NodeGraph)
    definition = base.getNodeDef(element.getNodeDefString()) if implements else None
    return bool(definition and definition.getImplementation(element.getTarget()))
