# SPDX-License-Identifier: Apache-2.0
"""Whether the generators of this MaterialX call a library's functions as its sources define them.

MaterialX versions pass different arguments to closures, so the number of arguments of each call in a
generated text is compared with the function's overloads.
"""

import os
import re
from collections import defaultdict
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import InterfaceError, ShaderError
from mxeon.shaders.document.values import split
from mxeon.shaders.generators import GENERATORS
from mxeon.shaders.library import load_library
from mxeon.shaders.library_tree import root, standard_folders

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
TEXT = re.compile(rf"{COMMENT.pattern}|\"[^\"\n]*\"", re.DOTALL)  # comments and strings
TOKEN = re.compile(r"\$[A-Za-z]\w*")


def check_closure_calls(
    stage: mx_gen.ShaderStage, target: str, library: str, profile: str | None
) -> None:
    """Raise InterfaceError unless a generated stage calls a library's functions as they are defined.

    Raise ShaderError if implementations of several nodes name one function, which does not suit all of them.
    """
    text, known = COMMENT.sub("", stage.getSourceCode()), _functions(library, profile, target)
    for file in stage.getSourceDependencies():
        for function, nodes in known.get(file, {}).items():
            signatures = _signatures(file, function)
            calls = re.finditer(rf"(?<!void )\b{function}\(", text) if signatures else ()
            if {len(split(text[call.end() :], ",")) for call in calls} <= {*map(len, signatures)}:
                continue
            if len(nodes) > 1:
                raise ShaderError(
                    f"{target}: the implementations of {' and '.join(nodes)} name one function, {function}"
                )
            raise InterfaceError(
                f"{target}: MaterialX {mx.getVersionString()} does not call eonlib's function "
                f"{function}({', '.join(signatures[0])}); use --library stock"
            )


def leftover(text: str) -> str:
    """The first token that the generator did not replace in a generated text, or ""."""
    found = TOKEN.search(TEXT.sub("", text)) if "$" in text else None
    return found[0] if found else ""


@cache
def _functions(
    library: str, profile: str | None, target: str
) -> Mapping[str, dict[str, list[str]]]:
    """Functions in a library's sources for a target, with their nodedefs, except MaterialX's."""
    functions: dict[str, dict[str, list[str]]] = defaultdict(dict)
    if root(library):
        return functions
    document = load_library(library, profile)
    targets = {GENERATORS[target].create().getTarget(), "genglsl"}  # most targets inherit from it
    for each in document.getImplementations():
        uri = each.getActiveSourceUri()
        if each.getTarget() not in targets:
            continue
        if each.hasFile() and each.hasFunction() and not _is_standard(uri):
            file = os.path.normpath(Path(uri).parent / each.getFile())
            nodes = functions[file].setdefault(each.getFunction(), [])
            nodes.append(each.getNodeDefString())
    return functions


@cache
def _is_standard(uri: str) -> bool:
    """Whether a document of definitions belongs to MaterialX."""
    return not set(standard_folders()).isdisjoint(Path(uri).parents)


@cache
def _signatures(file: str, function: str) -> list[list[str]]:
    """Parameters of each overload of a function that a source defines."""
    text = COMMENT.sub("", Path(file).read_text(encoding="utf-8"))
    definitions = re.finditer(rf"\bvoid\s+{function}\s*\(", text)
    return [
        [" ".join(part.split()) for part in split(text[each.end() :], ",")] for each in definitions
    ]
