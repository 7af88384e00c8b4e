# SPDX-License-Identifier: Apache-2.0
"""Whether the generators of this MaterialX call a library's functions as its sources define them.

MaterialX versions pass different arguments to closures. To check this, a generator writes a call of each
function that a shader uses, from mxeon's own document with unambiguous names. The shader's own document
and text are not searched.
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
from mxeon.shaders.document.graphs import inner_nodes
from mxeon.shaders.generators import GENERATORS, context_of, generated, generator_of
from mxeon.shaders.library import load_library
from mxeon.shaders.library_tree import root, standard_folders

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
TEXT = re.compile(rf"{COMMENT.pattern}|\"[^\"\n]*\"", re.DOTALL)  # comments and strings
TOKEN = re.compile(r"\$[A-Za-z]\w*")
NODE = "asked"  # name of the node in that document
CLOSURES = {"BSDF": "bsdf", "EDF": "edf"}  # inputs of a surface, which makes it call the closure


def check_closure_calls(
    stage: mx_gen.ShaderStage,
    target: str,
    library: str,
    profile: str | None,
    document: mx.Document,
) -> None:
    """Raise InterfaceError unless a generated stage calls a library's functions as they are defined.

    Raise ShaderError if the implementation of one of the document's own nodes names another node's function.
    """
    known = _functions(library, profile, target)
    for file in stage.getSourceDependencies():
        for nodedef, function in known.get(file, ()):
            signatures = _signatures(file, function)
            call = _call(target, library, profile, nodedef, function)
            if signatures and len(call) not in map(len, signatures):
                if others := [
                    each for each, name in known[file] if name == function and each != nodedef
                ]:
                    nodes = (each for each in inner_nodes(document) if each.isA(mx.Node))
                    if nodedef not in {
                        each.getNodeDef().getName() for each in nodes if each.getNodeDef()
                    }:
                        continue
                    raise ShaderError(
                        f"the implementation of {nodedef} names {function}, the function of {others[0]}"
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
) -> Mapping[str, list[tuple[str, str]]]:
    """Nodedefs and functions of each source of a library for a target, except MaterialX's own and their replacements."""
    functions: dict[str, list[tuple[str, str]]] = defaultdict(list)
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
            functions[file].append((each.getNodeDefString(), each.getFunction()))
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
    return [_arguments(text, definition.end()) for definition in definitions]


@cache
def _call(target: str, library: str, profile: str | None, nodedef: str, function: str) -> list[str]:
    """Arguments of the generator's call to a node's function; empty if there is no call."""
    document = mx.createDocument()
    document.setDataLibrary(load_library(library, profile))
    generator = generator_of(document, target, library, profile)
    context = context_of(document, target, generator, library, False, ())
    text = generated(generator, NODE, _surface(document, nodedef), context).getSourceCode("pixel")
    calls = list(re.finditer(rf"(?<!void )\b{function}\(", text))
    return _arguments(text, calls[-1].end()) if calls else []


def _surface(document: mx.Document, nodedef: str) -> mx.Node:
    """A node of a nodedef, or the surface that calls it if it is a closure."""
    definition = document.getNodeDef(nodedef)
    kind = definition.getType()
    node = document.addNode(definition.getNodeString(), NODE, kind)
    node.setNodeDefString(nodedef)
    if kind == "VDF":
        base, node, kind = node, document.addNode("layer", "layer", "BSDF"), "BSDF"
        node.addInput("base", "VDF").setConnectedNode(base)
    if kind not in CLOSURES:
        return node
    surface = document.addNode("surface", "surface", "surfaceshader")
    surface.addInput(CLOSURES[kind], kind).setConnectedNode(node)
    return surface


def _arguments(text: str, start: int) -> list[str]:
    """Arguments of a call, or parameters of a definition, whose parenthesis opens before `start`."""
    depth, commas, end = 1, [start - 1], start
    while depth:
        depth += (text[end] in "({") - (text[end] in ")}")  # MSL writes structures in braces
        if text[end] == "," and depth == 1:
            commas.append(end)
        end += 1
    ends = [*commas[1:], end - 1]
    return [" ".join(text[a + 1 : b].split()) for a, b in zip(commas, ends, strict=True)]
