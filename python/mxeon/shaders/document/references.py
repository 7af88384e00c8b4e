# SPDX-License-Identifier: Apache-2.0
"""Which files a document may name, and whether it brings code."""

import glob
import os
import re
from functools import cache
from pathlib import Path

import MaterialX as mx

from mxeon.errors import DocumentError
from mxeon.shaders.document.words import ENDS_A_STRING
from mxeon.shaders.library import data_folder, eonlib_folder

CODE = ("file", "sourcecode")


def folder(document):
    """Where relative file names start: at the document's file, or the working folder for text."""
    file = document.getSourceUri()
    return Path(file).resolve().parent if file else Path.cwd()


def inside(path, home, others=()):
    """Whether a path, its symbolic links resolved, lies in a folder, in others or the libraries."""
    real = Path(os.path.realpath(path))
    roots = (home, *map(os.path.realpath, others), *_libraries())
    return any(real.is_relative_to(root) for root in roots)


def check_inside(path, home, policy, place):
    """Nothing, if a document in the folder `home` may name that file.

    Raises
    ------
    DocumentError
        Otherwise.
    """
    if not policy.outside and not inside(path, home, policy.path):
        raise DocumentError(
            f"{place} must name a file in {home}, on the search path or in the libraries; got "
            f"{path}: pass --allowOutside to permit it"
        )


def check_file(element, place, policy):
    """Nothing, if the file that an input names may be read, should it be there.

    Of a set of textures, any that is there has to be one that may be read.

    Raises
    ------
    DocumentError
        Otherwise.
    """
    text, home = element.getValueString(), folder(element.getDocument())
    if ENDS_A_STRING.search(text):
        raise DocumentError(f"{place} must name a file without quotes and backslashes; got {text}")
    path = home / text  # what MaterialX did not find there is relative still
    check_inside(path, home, policy, place)
    if "<" in str(path.parent):
        raise DocumentError(f"{place} must name one folder; got {text}")
    for each in files(path):
        check_inside(each, home, policy, place)


def files(path):
    """The files that a name stands for: its own, or those of a set, which has `<UDIM>` in it."""
    if "<" not in path.name:
        return [path] if os.path.isfile(path) else []
    return list(path.parent.glob(re.sub(r"(<\w*>)+", "*", glob.escape(path.name))))


def foreign_code(document):
    """The implementations by which a document brings shader code of its own."""
    return [
        each
        for each in document.getChildren()  # getImplementations has the data library's too
        if each.isA(mx.Implementation) and any(map(each.hasAttribute, CODE))
    ]


def check_code(document, policy, called):
    """Nothing, if the code that a document brings may be used.

    Raises
    ------
    DocumentError
        If it may not, or lies in a file that may not be read.
    """
    home = folder(document)
    for element in foreign_code(document):
        place = f'{called}: implementation "{element.getName()}"'
        if not policy.code:
            raise DocumentError(
                f"{place} must not bring code of its own; got {_code(element)}: "
                "pass --allowCode to permit it"
            )
        for path in _sources(element, home, policy.path):
            check_inside(path, home, policy, place)


def _code(element):
    name = next(filter(element.hasAttribute, CODE))
    return f'{name} "{element.getAttribute(name)}"'


def _sources(element, home, path):
    """The files that an implementation's `file` may mean to a generator."""
    name = element.getAttribute("file")
    origin = Path(element.getActiveSourceUri() or home / "document").parent
    bases = (origin, home, Path.cwd(), *map(Path, path), *_libraries())
    return [base / name for base in bases if name and os.path.lexists(base / name)]


@cache
def _libraries():
    """Folders whose files any document may use: MaterialX's own and eonlib's."""
    standard = mx.getDefaultDataSearchPath().asString().split(mx.PATH_LIST_SEPARATOR)
    ours = (eonlib_folder(), *(data_folder() / each for each in ("profiles", "genglsl", "genosl")))
    return tuple(Path(each).resolve() for each in (*standard, *ours))
