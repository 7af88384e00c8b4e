# SPDX-License-Identifier: Apache-2.0
"""Images that hold values of variables, one pixel per point, and OSL that reads such images."""

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

LEAST_SIZE = 4  # minimum width in pixels, because Blender renders no smaller pictures
# OSL types by MaterialX type.
TYPES = {"color3": "color", "vector3": "vector", "boolean": "int", "integer": "int"}
WIDTHS = {"color": 3, "vector": 3, "normal": 3, "vector2": 2}
# OSL that computes the row of a point from the point's position in the picture.
ROW = """#define MXEON_AT(x, y) ((int) floor({size} * (y)) * {size} + (int) floor({size} * (x)))
#define MXEON_ROW MXEON_AT({place})
"""
FILTER = '0.0, 0.0, 0.0, 0.0, "interp", "closest"'
# Blender 5.3 ignores "firstchannel" and "closest", and turns images upside down. Therefore, the
# image has three channels, columns are side by side, a mirror image is below the upright image, and
# each point has 2 x 2 equal pixels.
READ = f'texture("{{image}}", ({{column}} + {{x}}) / {{columns}}, 0.5 * ({{y}}), {FILTER})'
NO_WARNING = "#pragma osl nowarn"  # oslc warns if a surface shader sets a global
IMAGE = "points.tif"  # name of the image


@dataclass(frozen=True)
class Column:
    kind: str  # OSL type
    values: ArrayLike  # one value per point, or one value for all points
    declared: bool = True  # false for the global variables of OSL

    @property
    def rows(self) -> NDArray[np.float32]:
        """The values as rows, (N or 1, components)."""
        return np.asarray(self.values, np.float32).reshape(-1, WIDTHS.get(self.kind, 1))

    def take(self, rows: NDArray[np.intp]) -> Column:
        return self if len(self.rows) == 1 else replace(self, values=self.rows[rows])


def side(count: int) -> int:
    """Pixels on a side of the square picture for `count` points."""
    return max(LEAST_SIZE, math.isqrt(count - 1) + 1)


def row(count: int, place: str) -> str:
    """OSL that defines MXEON_ROW, the row of a point among `count` points in a picture."""
    return ROW.format(size=side(count), place=place)


def statements(columns: Mapping[str, Column], image: Path, count: int, place: str) -> list[str]:
    """OSL statements that read a point's variables exactly from a float32 image.

    `place` has two OSL expressions, which are the coordinates at which a point reads the image.
    """
    lines, size, (x, y) = [], side(count), place.split(", ")
    pixels = np.zeros((size * size, len(columns), 3), np.float32)
    for number, (name, column) in enumerate(columns.items()):
        pixels[:count, number, : column.rows.shape[1]] = column.rows
        read = READ.format(image=image.as_posix(), column=number, columns=len(columns), x=x, y=y)
        # Texture lookups cannot return a normal, a vector2 or an int.
        if column.kind == "vector2":
            lines += [f"color {name}_xy = {read};"]
            lines += [f"vector2 {name} = vector2({name}_xy[0], {name}_xy[1]);"]
        elif column.kind == "int":
            lines += [f"float {name}_float = {read};", f"int {name} = (int) {name}_float;"]
        elif column.declared:
            kind = "vector" if column.kind == "normal" else column.kind
            lines.append(f"{kind} {name} = {read};")
        else:
            lines += [NO_WARNING, f"{name} = {read};"]
    if columns:
        upright = pixels.reshape(size, size, -1, 3).swapaxes(1, 2).reshape(size, -1, 3)
        mirrored = np.concatenate([upright, upright[::-1]]).repeat(2, axis=0).repeat(2, axis=1)
        write_image(image, mirrored, {"compression": "none"})
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

    `image` and `place` are as in `statements`. `output` declares the shader's output. `last` is the
    last statement, with {} for the value, which is a color.
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


OUTPUT = re.compile(r"\boutput MATERIAL (\w+) *=")
# OSL type, name of the input, and default value of each global variable of the surface.
SURFACE = {
    "N": ("normal", "normal", (0.0, 0.0, 1.0)),
    "dPdu": ("vector", "tangent", (1.0, 0.0, 0.0)),
    "dPdv": ("vector", "bitangent", (0.0, 1.0, 0.0)),
}


def columns_of(
    shader: Shader, inputs: Inputs, turned: Callable[[Array], Array] = lambda rows: rows
) -> Mapping[str, Column]:
    """Values of the OSL variables for surface and inputs of a shader. `turned` rotates vectors."""
    columns = {
        variable: Column(kind, inputs.get(name, default), declared=False)
        for variable, (kind, name, default) in SURFACE.items()
    }
    for port in shader.inputs:
        key = port.path if port.path in inputs else port.path.rsplit("/", 1)[-1]
        if key in inputs:
            columns[port.name] = Column(TYPES.get(port.type, port.type), inputs[key])
    return {
        name: replace(each, values=turned(each.rows)) if each.kind in ("normal", "vector") else each
        for name, each in columns.items()
    }


def with_variables(
    shader: Shader,
    columns: Mapping[str, Column],
    image: Path,
    count: int,
    place: str,
    last: str,
) -> str:
    """Text of a shader whose inputs are replaced by variables that vary from point to point.

    `last` is a statement to add at the end, with {output} for the name of the shader's output. The
    other arguments are as in `statements`.
    """
    head, brace, body = shader.stages["pixel"].rpartition("\n)\n{\n")
    main, end, _ = body.rpartition("}")
    block = indented(statements(columns, image, count, place))
    statement = last.format(output=OUTPUT.findall(head)[-1])
    return with_header(f"{head}{brace}{{\n{block}{main}{statement}}}\n{end}\n", shader)


def indented(lines: Iterable[str]) -> str:
    return "".join(f"    {line}\n" for line in lines)


def with_header(text: str, shader: Shader) -> str:
    """Generated OSL, in which mx_funcs.h is included by its full path."""
    path = mx.FileSearchPath(shader.root) if shader.root else mx.getDefaultDataSearchPath()
    header = path.find("libraries/stdlib/genosl/include/mx_funcs.h").asString()
    return text.replace('"mx_funcs.h"', f'"{header}"')
