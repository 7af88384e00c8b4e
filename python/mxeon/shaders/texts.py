# SPDX-License-Identifier: Apache-2.0
"""Reads the sources of a library's nodes, and finds nodes that cannot be used in one shader.

A generator writes the source of a node once and each included file once. If the source of a node is
also included, the generator writes the source twice. A shader does not compile if two of its files
define the same function.
"""

import os
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple, TypeAlias

import MaterialX as mx

from mxeon.shaders.closure_calls import COMMENT
from mxeon.shaders.document.values import split
from mxeon.shaders.library_tree import included

# The name of a definition. For a function, "(" and the parameter types follow the name.
Definition: TypeAlias = tuple[str, ...]
Source: TypeAlias = tuple[str, Path]  # name and file of the function that implements a node

TOKEN = re.compile(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*$|[{};]", re.MULTILINE)
FUNCTION = re.compile(r"(\w+)\s*\(([^(){}]*)\)\s*$")
MACRO = re.compile(r"\s*#\s*define\s+(\w+)")
CONSTANT = re.compile(r"(\w+)\s*(?:\[[^\]]*\]\s*)*=")
QUALIFIERS = {"const", "in", "out", "inout", "output", "thread", "constant", "highp", "static"}
PLACED = "$fileTransformUv", "mx_transform_uv.glsl"  # an include and the generator's replacement
MATH = "libraries/stdlib/genglsl/lib/mx_math.glsl"
ARGUMENT = re.compile(r"\s*(?:(\w+)\s*:(?!:))?(.*)", re.DOTALL)


class Clash(NamedTuple):
    """A name that two sources define, and the nodedefs that use these sources."""

    name: str
    nodes: tuple[str, str]


@cache
def text_of(path: Path) -> str:
    """Text of a source file without comments; "" if the file cannot be read."""
    try:
        return COMMENT.sub(" ", path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError):
        return ""


@cache
def definitions(path: Path) -> Mapping[Definition, str]:
    """Names that a file defines outside of #if, with the text of each definition."""
    text, found = text_of(path), dict[Definition, str]()
    start = depth = conditions = 0
    for token in TOKEN.finditer(text):
        if "#" in token[0]:
            if depth == 0:
                start = token.end()
            conditions += bool(re.match(r"\s*#\s*if", token[0])) - ("#endif" in token[0])
            if not conditions and (macro := MACRO.match(token[0])):
                found[(macro[1],)] = " ".join(token[0].split())
            continue
        depth += (token[0] == "{") - (token[0] == "}")
        if depth or token[0] == "{":
            continue
        chunk = text[start : token.end()]
        head, body, _ = chunk.partition("{")
        function = FUNCTION.search(head) if body else None
        if function is None and token[0] == "}":
            continue  # this brace closes a structure or an initializer
        start = token.end()
        if conditions:
            continue
        if function:
            kinds = (each.split() for each in function[2].split(",") if each.strip())
            types = (" ".join(w for w in words[:-1] if w not in QUALIFIERS) for words in kinds)
            found[(function[1], "(", *types)] = " ".join(chunk.split())
        elif constant := CONSTANT.search(head + body):
            found[(constant[1],)] = " ".join(chunk.split())
        elif body and (name := re.search(r"\bstruct\s+(\w+)", head)):
            found[(name[1],)] = " ".join(chunk.split())
    return found


def _reached(path: Path, search: mx.FileSearchPath) -> tuple[Path, ...]:
    """The result of `files`, plus the functions that GLSL generators add to every shader."""
    return *files(path, search.asString()), Path(search.find(MATH).asString())


@cache
def files(path: Path, search: str) -> tuple[Path, ...]:
    """A source file and all files that the source includes directly or indirectly."""
    seen: dict[Path, None] = {}
    waiting = [path]
    while waiting:
        if (file := waiting.pop()) not in seen:
            seen[file] = None
            for name in filter(None, map(included, text_of(file).split("\n"))):
                folders = mx.FileSearchPath(str(file.parent))
                folders.append(mx.FileSearchPath(search))
                place = Path(folders.find(name.replace(*PLACED)).getNormalized().asString())
                waiting += [Path(os.path.normpath(place))] * place.is_file()
    return tuple(seen)


def source_of(element: mx.Element | None) -> Source | None:
    """The function and the file of an implementation; None for implementations without a file."""
    if element is None or not element.isA(mx.Implementation) or not element.hasFile():
        return None
    # Keep links unresolved, because included files lie next to the link.
    path = Path(element.getActiveSourceUri()).parent / element.getFile()
    return element.getFunction(), Path(os.path.normpath(path))


def all_texts(element: mx.Implementation, search: mx.FileSearchPath) -> tuple[str, ...]:
    """All texts of an implementation: code, inputs, function, and files."""
    names = sorted(
        f"{each.getName()} {each.getImplementationName()}" for each in element.getInputs()
    )
    code = "".join(element.getAttribute("sourcecode").split())
    source = source_of(element)
    texts = map(text_of, _reached(source[1], search)) if source else ()
    return (code, *names, element.getFunction(), *texts)


def used_texts(element: mx.Implementation, search: mx.FileSearchPath) -> tuple[str, ...]:
    """Texts of the functions and constants that an implementation's function uses."""
    if (source := source_of(element)) is None:
        return all_texts(element, search)
    known: dict[str, list[str]] = defaultdict(list)
    for file in _reached(source[1], search):
        for definition, text in definitions(file).items():
            known[definition[0]].append("".join(text.split()))
            known[definition[0]].append(" ".join(re.findall(r"\w+", text)))
    reached, waiting = set[str](), [source[0]]
    while waiting:
        if (name := waiting.pop()) not in reached:
            reached.add(name)
            words = {word for text in known[name][1::2] for word in text.split()}
            waiting += words & known.keys()
    return source[0], *sorted(text for name in reached for text in known[name][::2])


def clashes(
    document: mx.Document, target: str, search: mx.FileSearchPath, twice: bool = False
) -> Iterator[Clash]:
    """Names that are defined twice, by two nodes that may occur in one shader of a target.

    For a negative control, `twice` includes the source of one node a second time.
    """
    nodes: dict[Path, str] = {}
    for each in document.getNodeDefs():
        if source := source_of(each.getImplementation(target)):
            nodes.setdefault(source[1], each.getName())
    # For each definition, maps (file, whether another file includes the file) to a node.
    owners: dict[Definition, dict[tuple[Path, bool], str]] = defaultdict(dict)
    for path, node in nodes.items():
        for file in files(path, search.asString()):
            for definition in definitions(file):
                owners[definition].setdefault((file, file != path), node)
                if twice and file == path:
                    owners[definition].setdefault((file, True), node)
        twice = False
    for definition, sources in owners.items():
        texts = {definitions(file)[definition] for file, _ in sources}
        if len(sources) > 1 and (len(texts) > 1 or not texts.pop().lstrip().startswith("#")):
            first, second, *_ = sources.values()
            yield Clash(definition[0], (first, second))


def arguments(code: str) -> tuple[str, dict[str, str]]:
    """The function that an MDL call names, and the arguments, keyed by name or by position.

    >>> arguments("m::f(mxp_a:{{a}}, 2.0)")
    ('m::f', {'mxp_a': '{{a}}', '1': '2.0'})
    """
    callee, _, rest = code.partition("(")
    matches = map(ARGUMENT.fullmatch, split(rest, ","))
    return callee.strip(), {
        match[1] or str(number): "".join(match[2].split())
        for number, match in enumerate(matches)
        if match
    }
