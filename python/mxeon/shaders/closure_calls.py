# SPDX-License-Identifier: Apache-2.0
"""Checks that MaterialX's generators call a library's functions as the sources define them.

Versions of MaterialX pass different arguments to closures. In generated text, the number of
arguments of each call must be the number of parameters of an overload of the function.
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
TEXT = re.compile(rf"{COMMENT.pattern}|\"[^\"\n]*\"", re.DOTALL)  # matches comments and strings
TOKEN = re.compile(r"\$[A-Za-z]\w*")


def check_closure_calls(
    stage: mx_gen.ShaderStage, target: str, library: str, profile: str | None
) -> None:
    """Raise InterfaceError unless a generated stage calls a library's functions as defined.

    If several nodes share the function that is called wrongly, raise ShaderError instead.
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
                    f"{target}: the implementations of {' and '.join(nodes)} name the same function, {function}"
                )
            raise InterfaceError(
                f"{target}: MaterialX {mx.getVersionString()} does not call eonlib's function "
                f"{function}({', '.join(signatures[0])}); use --library stock"
            )


def unreplaced_token(text: str) -> str:
    """The first `$token` in a generated text that the generator did not replace, or ""."""
    found = TOKEN.search(TEXT.sub("", text)) if "$" in text else None
    return found[0] if found else ""


@cache
def _functions(
    library: str, profile: str | None, target: str
) -> Mapping[str, dict[str, list[str]]]:
    """The nodedefs that a library implements for a target, keyed by source file and function.

    MaterialX's own implementations are excluded. The result is empty for libraries that replace
    MaterialX's libraries.
    """
    functions: dict[str, dict[str, list[str]]] = defaultdict(dict)
    if root(library):
        return functions
    document = load_library(library, profile)
    # Most targets inherit the code of genglsl.
    targets = {GENERATORS[target].create().getTarget(), "genglsl"}
    standard = set(standard_folders())
    folders = cache(lambda uri: Path(uri).parents)  # cached, since many sources share a document
    for each in document.getImplementations():
        if each.getTarget() not in targets or not (each.hasFile() and each.hasFunction()):
            continue
        if standard.isdisjoint(parents := folders(each.getActiveSourceUri())):
            file = os.path.normpath(parents[0] / each.getFile())
            nodes = functions[file].setdefault(each.getFunction(), [])
            nodes.append(each.getNodeDefString())
    return functions


@cache
def _signatures(file: str, function: str) -> list[list[str]]:
    """Parameters of each overload of a function that a source defines."""
    text = COMMENT.sub("", Path(file).read_text(encoding="utf-8"))
    definitions = re.finditer(rf"\bvoid\s+{function}\s*\(", text)
    return [
        [" ".join(part.split()) for part in split(text[each.end() :], ",")] for each in definitions
    ]
