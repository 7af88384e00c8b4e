# SPDX-License-Identifier: Apache-2.0
"""Values for each point of a run: images with a pixel for each, and OSL statements that read them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import InputError
from mxeon.hosts.base import Array, Inputs
from mxeon.io.images import write_image
from mxeon.shaders import functions
from mxeon.shaders.generation import Shader

LEAST_SIZE = 4  # Blender renders no smaller picture.
# OSL's types by MaterialX's.
TYPES = {"color3": "color", "vector3": "vector", "boolean": "int", "integer": "int"}
WIDTHS = {"color": 3, "vector": 3, "normal": 3, "vector2": 2}
# The row of a point, from its place in the picture.
ROW = """#define MXEON_AT(x, y) ((int) floor({size} * (y)) * {size} + (int) floor({size} * (x)))
#define MXEON_ROW MXEON_AT({place})
"""
FILTER = '0.0, 0.0, 0.0, 0.0, "interp", "closest"'
READ = f'texture("{{image}}", {{place}}, {FILTER}, "firstchannel", {{first}})'
NO_WARNING = "#pragma osl nowarn"  # oslc warns if a surface shader sets a global of its point
IMAGE = "points.tif"  # of a shader's variables; EXR sorts more than ten channels by their names


@dataclass(frozen=True)
class Column:
    kind: str  # OSL's type
    values: ArrayLike  # one for each point, or one for all
    declared: bool = True  # else assigned, to a variable of OSL that all functions read

    @property
    def rows(self) -> NDArray[np.float32]:
        """The values, (N or 1, components)."""
        return np.asarray(self.values, np.float32).reshape(-1, WIDTHS.get(self.kind, 1))

    def some(self, rows: NDArray[np.intp]) -> Column:
        return self if len(self.rows) == 1 else replace(self, values=self.rows[rows])


def side(count: int) -> int:
    """Pixels on a side of the square picture that has so many points."""
    return max(LEAST_SIZE, math.isqrt(count - 1) + 1)


def row(count: int, place: str) -> str:
    """OSL that defines MXEON_ROW, the row of a point of so many, by its place in an image."""
    return ROW.format(size=side(count), place=place)


def statements(columns: Mapping[str, Column], image: Path, count: int, place: str) -> list[str]:
    """OSL statements that give variables the values of a point, exactly, from a float32 image.

    `place` is OSL for the two coordinates at which a point reads its pixel, without a filter.
    """
    lines, values = [], [np.zeros((count, 0), np.float32)]
    for name, column in columns.items():
        rows = np.broadcast_to(column.rows, (count, column.rows.shape[1]))
        first = sum(each.shape[1] for each in values)
        values.append(rows)
        x, y = (READ.format(image=image.as_posix(), place=place, first=first + n) for n in (0, 1))
        # A vector2 and an int are made of floats, as textures have neither.
        if column.kind == "vector2":
            lines += [f"float {name}_x = {x};", f"float {name}_y = {y};"]
            lines += [f"vector2 {name} = vector2({name}_x, {name}_y);"]
        elif column.kind == "int":
            lines += [f"float {name}_float = {x};", f"int {name} = (int) {name}_float;"]
        # A normal is read as a vector.
        else:
            kind = "vector" if column.kind == "normal" else column.kind
            lines += (
                [f"{kind} {name} = {x};"] if column.declared else [NO_WARNING, f"{name} = {x};"]
            )
    if columns:
        size, channels = side(count), sum(each.shape[1] for each in values)
        pixels = np.zeros((size * size, channels), np.float32)
        pixels[:count] = np.concatenate(values, axis=1)
        write_image(image, pixels.reshape(size, size, channels), {"compression": "none"})
    return lines


CALL = "mxeon_call"  # name of a shader that calls a function


def call_text(
    source: str,
    function: str,
    arguments: Sequence[ArrayLike],
    image: Path,
    place: str,
    output: str,
    last: str,
) -> tuple[str, int]:
    """Text of a shader that calls a function of `source` at each point, and the number of points.

    `image` and `place` are those of `statements`; `output` declares the shader's output, and `last` is
    its last statement, with {} for the value, a color.
    """
    parameters = functions.parameters(source, function)
    if len(parameters) != len(arguments):
        raise InputError(f"{function} takes {len(parameters)} arguments; got {len(arguments)}")
    columns = {
        f"argument{n}": Column(kind, value)
        for n, ((kind, _), value) in enumerate(zip(parameters, arguments, strict=True))
    }
    count = max((len(each.rows) for each in columns.values()), default=1)
    value = last.format(f"(color) {function}({', '.join(columns)})")
    body = indented([*statements(columns, image, count, place), value])
    return f"{source}\nshader {CALL}({output} = 0)\n{{\n{body}}}\n", count


OUTPUT = re.compile(r"\boutput MATERIAL (\w+) *=")  # of a shader
# What a shader reads instead of the surface.
SURFACE = {
    "N": ("normal", (0.0, 0.0, 1.0)),
    "dPdu": ("vector", (1.0, 0.0, 0.0)),
    "dPdv": ("vector", (0.0, 1.0, 0.0)),
}
NAMES = {"N": "normal", "dPdu": "tangent", "dPdv": "bitangent"}


def columns_of(
    shader: Shader, inputs: Inputs, turned: Callable[[Array], Array] = lambda rows: rows
) -> Mapping[str, Column]:
    """Columns of the surface and of the inputs that a shader has, by the names of its variables.

    Directions among them are turned.
    """
    columns = {
        each: Column(kind, inputs.get(NAMES[each], value), declared=False)
        for each, (kind, value) in SURFACE.items()
    }
    for port in shader.inputs:
        key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
        if key in inputs:
            columns[port.name] = Column(TYPES.get(port.type, port.type), inputs[key])
    return {
        name: replace(each, values=turned(each.rows)) if each.kind in ("normal", "vector") else each
        for name, each in columns.items()
    }


def with_variables(shader: Shader, block: Iterable[str], last: Callable[[str], str]) -> str:
    """Text of a shader whose body has statements before it, and one more at its end.

    `block` is a nested scope, so its declarations hide the inputs; `last` takes the name of
    the shader's output.
    """
    head, brace, body = shader.stages["pixel"].rpartition("\n)\n{\n")
    main, end, _ = body.rpartition("}")
    statement = last(OUTPUT.findall(head)[-1])
    return f"{head}{brace}{{\n{indented(block)}{main}{statement}}}\n{end}\n"


def indented(lines: Iterable[str]) -> str:
    return "".join(f"    {line}\n" for line in lines)


def with_header(text: str, shader: Shader) -> str:
    """A generated text with the path of the file that it includes, of the shader's library."""
    path = mx.FileSearchPath(shader.root) if shader.root else mx.getDefaultDataSearchPath()
    header = path.find("libraries/stdlib/genosl/include/mx_funcs.h").asString()
    return text.replace('"mx_funcs.h"', f'"{header}"')
