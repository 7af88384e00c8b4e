# SPDX-License-Identifier: Apache-2.0
"""Generated OSL with local variables that hide its inputs, and a surface that is set, so that each point has its own."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping

import MaterialX as mx

from mxeon.hosts.base import Inputs
from mxeon.hosts.osl.points import TYPES, Column
from mxeon.shaders.generation import Shader

OUTPUT = re.compile(r"\boutput MATERIAL (\w+) *=")  # of a shader
# What a shader finds in the place of the surface.
SURFACE = {
    "N": ("normal", (0.0, 0.0, 1.0)),
    "dPdu": ("vector", (1.0, 0.0, 0.0)),
    "dPdv": ("vector", (0.0, 1.0, 0.0)),
}
NAMES = {"N": "normal", "dPdu": "tangent", "dPdv": "bitangent"}


def columns_of(shader: Shader, inputs: Inputs) -> Mapping[str, Column]:
    """Columns of the surface and of the inputs that a shader has, by the names of its variables."""
    columns = {
        each: Column(kind, inputs.get(NAMES[each], value), declared=False)
        for each, (kind, value) in SURFACE.items()
    }
    for port in shader.inputs:
        key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
        if key in inputs:
            columns[port.name] = Column(TYPES.get(port.type, port.type), inputs[key])
    return columns


def with_variables(shader: Shader, block: Iterable[str], last: Callable[[str], str]) -> str:
    """Text of a shader whose body has statements before it, and one more at its end.

    `block` is a scope of its own, so that what it declares hides the inputs; `last` takes the name of
    the shader's output.
    """
    head, brace, body = shader.stages["pixel"].rpartition("\n)\n{\n")
    main, end, _ = body.rpartition("}")
    statement = last(OUTPUT.findall(head)[-1])
    return f"{head}{brace}{{\n{indented(block)}{main}{statement}}}\n{end}\n"


def indented(lines: Iterable[str]) -> str:
    """Lines of a body."""
    return "".join(f"    {line}\n" for line in lines)


def with_header(text: str, shader: Shader) -> str:
    """A generated text with the path of the file that it includes, of the shader's library."""
    path = mx.FileSearchPath(shader.root) if shader.root else mx.getDefaultDataSearchPath()
    header = path.find("libraries/stdlib/genosl/include/mx_funcs.h").asString()
    return text.replace('"mx_funcs.h"', f'"{header}"')
