# SPDX-License-Identifier: Apache-2.0
"""Fragment shaders that evaluate a function once per pixel, without changes to generated text.

Arguments are read from float textures, one texel per pixel. A macro renames the `main` of the
generated text. A second `main` repeats the statements that call the BSDF, with local variables that
hide the uniforms.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.hosts.base import Array, Query
from mxeon.hosts.calls import POSITION, booleans, bsdf_call
from mxeon.shaders import functions
from mxeon.shaders.methods import TABLE_SIZE

TEXEL = "texelFetch(mxeon_{}, mxeon_pixel, 0)"
FETCH = {
    "float": "float {0} = {1}.x;",
    "boolean": "bool {0} = {1}.x > 0.5;",
    "color3": "vec3 {0} = {1}.xyz;",
}
FETCH["vector3"] = FETCH["vec3"] = FETCH["color3"]
FETCH["vector2"] = "vec2 {0} = {1}.xy;"
FETCH["integer"] = "int {0} = int({1}.x);"
# Name of the texture that holds all arguments, in layers, if there are more than MOST arguments.
STACK = "mxeon_stack"
MOST = 12  # maximum number of textures for arguments; every device supports 16 textures
LAYER = (
    f"texelFetch({STACK}, mxeon_pixel + ivec2(0, {{0}} * (textureSize({STACK}, 0).y / {{1}})), 0)"
)
# Number of components by type. All other types have three components.
COMPONENTS = {"float": 1, "boolean": 1, "integer": 1, "vector2": 2}
WIDTH = 1024  # maximum number of pixels in a row of a frame
PART = 1 << 15  # maximum number of elements that one frame evaluates
# One column and one row are added to argument textures, so that no size is a power of two. Mesa
# compiles a program again whenever a texture's size changes from a power of two to another size.
ODD = 1

Columns: TypeAlias = dict[str, NDArray[np.float32]]  # (rows, 1 to 3) or (layers, rows, 3)


@dataclass(frozen=True)
class Dialect:
    """Parts of the text around a function, in a language of the GLSL family."""

    version: str  # first line of a stage
    prelude: str  # code between the version and a generated text
    output: str  # declaration of a pixel stage's output
    sampler: str  # declaration of an argument's sampler, with placeholders for name and number
    vertex: str  # vertex stage without outputs


VERTEX = "in vec3 i_position;\nvoid main() { gl_Position = vec4(i_position, 1.0); }\n"

# WebGPU separates textures and samplers, but generated text combines a texture and a sampler.
# Macros turn sampler2D into a texture that is always read through the same sampler.
SEPARATE = """#extension GL_EXT_samplerless_texture_functions : require
layout (set = 1, binding = 0) uniform sampler mxeon_sampler;
vec4 mxeon_lookup(texture2D t, vec2 uv) { return texture(sampler2D(t, mxeon_sampler), uv); }
vec4 mxeon_lookup_lod(texture2D t, vec2 uv, float lod)
{
    return textureLod(sampler2D(t, mxeon_sampler), uv, lod);
}
#define sampler2D texture2D
#define texture mxeon_lookup
#define textureLod mxeon_lookup_lod
"""

DIALECTS = {
    "glsl": Dialect(
        version="#version 430\n",
        prelude="",
        output="out vec4 mxeon_out;\n",
        sampler="uniform sampler2D {name};",
        vertex="#version 430\n" + VERTEX,
    ),
    "essl": Dialect(
        version="#version 300 es\n",
        prelude="",
        output="precision highp float;\nout vec4 mxeon_out;\n",
        sampler="uniform highp sampler2D {name};",
        vertex="#version 300 es\n" + VERTEX,
    ),
    "vulkan": Dialect(
        version="#version 450\n",
        prelude=SEPARATE,
        output="layout (location = 0) out vec4 mxeon_out;\n",
        sampler="layout (set = 2, binding = {number}) uniform texture2D {name};",
        vertex="#version 450\nlayout (location = 0) " + VERTEX,
    ),
}
DIALECTS["wgsl"] = replace(DIALECTS["vulkan"], prelude="")  # textures are already separate


def bsdf_evaluation(query: Query) -> tuple[str, Columns]:
    """Pixel stage that evaluates a shader's BSDF. Also returns the texels of each sampler."""
    shader = query.shader
    dialect, call = DIALECTS[shader.target], bsdf_call(query)
    before, output = _before_main(shader.stages["pixel"], dialect)
    # By default, P varies from pixel to pixel, because subsurface_bsdf divides by fwidth(P).
    body = [
        POSITION.format("vec3(gl_FragCoord.xy, 0.0)"),
        call.statements,
        f"{output} = vec4({call.value}, 1.0);",
    ]
    images = sum(port.type == "filename" for port in shader.inputs)
    main, texels = _main(dialect, call.arguments, body, MOST - images)
    return before + main, texels


@lru_cache(maxsize=16)
def _before_main(pixel: str, dialect: Dialect) -> tuple[str, str]:
    """The text that precedes a new `main`, and the name of the output of the generated text."""
    version, text = pixel.split("\n", 1)
    macros = "".join(f"#undef {name}\n" for name in ["main", *booleans(text)])
    before = f"{version}\n{dialect.prelude}{renamed(text)}{macros}"
    return before, re.findall(r"\bout vec4 (\w+);", text)[0]


def renamed(text: str) -> str:
    """A generated text with a macro that renames `main`. The macro follows all other functions."""
    functions, main = text.rsplit("void main", 1)
    return f"{functions}#define main mxeon_generated_main\nvoid main{main}"


def function_evaluation(
    source: str, function: str, arguments: Sequence[ArrayLike], target: str
) -> tuple[str, Columns]:
    """Pixel stage that calls a function of `source`. Also returns the texels of each sampler."""
    values, call = functions.call(source, function, arguments)
    return evaluation(source, values, [f"mxeon_out = vec4(vec3({call}), 1.0);"], target)


def evaluation(
    source: str, arguments: Mapping[str, tuple[str, ArrayLike]], body: Sequence[str], target: str
) -> tuple[str, Columns]:
    """Pixel stage that executes the statements `body`. Also returns the texels of each sampler."""
    dialect = DIALECTS[target]
    main, texels = _main(dialect, arguments, body)
    return dialect.version + dialect.prelude + dialect.output + source + main, texels


def frame(arguments: Mapping[str, Array]) -> tuple[int, tuple[int, int]]:
    """Length of the longest argument, and the size of a frame with at least as many pixels.

    Width and height are even, because GPUs compute derivatives in blocks of 2 x 2 pixels.
    """
    if not arguments:  # the frame shows the table of albedos
        return TABLE_SIZE**2, (TABLE_SIZE, TABLE_SIZE)
    count = max(each.shape[-2] for each in arguments.values())
    height = 2 * -(-count // (2 * WIDTH))
    return count, (2 * -(-count // (2 * height)), height)


def parts(arguments: Mapping[str, Array]) -> Iterator[dict[str, Array]]:
    """Yield the arguments in parts of at most PART elements, to save memory."""
    count, _ = frame(arguments)
    for start in range(0, count, PART):
        yield {
            name: rows if rows.shape[-2] == 1 else rows[..., start : start + PART, :]
            for name, rows in arguments.items()
        }


def texels(values: Array, size: tuple[int, int], margin: int = 0) -> NDArray[np.float32]:
    """Values as texels of a texture. An array of three dimensions becomes several layers.

    A single row of `values` is a constant and fills the texture. `margin` columns and rows are
    added to each layer.
    """
    width, height = size
    layers = values[np.newaxis] if values.ndim == 2 else values
    number, count, components = layers.shape
    shape = (number, height + margin, width + margin, components)
    frames = np.zeros(shape, dtype=np.float32)
    if count == 1:
        frames[:, :height, :width] = layers[:, :, np.newaxis]
    else:
        full, rest = divmod(count, width)
        rows = layers[:, : full * width].reshape(number, full, width, components)
        frames[:, :full, :width] = rows
        frames[:, full : full + 1, :rest] = layers[:, np.newaxis, full * width :]
    return frames.reshape(-1, width + margin, components)


def columns(arguments: Mapping[str, tuple[str, ArrayLike]]) -> Columns:
    """Values of arguments, given as (type, values) by name, in float32 rows of 1 to 3 numbers."""
    return {
        name: np.asarray(value, dtype=np.float32).reshape(-1, COMPONENTS.get(kind, 3))
        for name, (kind, value) in arguments.items()
    }


def _main(
    dialect: Dialect,
    arguments: Mapping[str, tuple[str, ArrayLike]],
    body: Sequence[str],
    most: int = MOST,
) -> tuple[str, Columns]:
    """A `main` that reads arguments and executes `body`. Also returns the samplers' texels."""
    rows = columns(arguments)
    if len(rows) <= most:
        values = {f"mxeon_{name}": each for name, each in rows.items()}
        texels = [TEXEL.format(name) for name in rows]
    else:
        layers = np.zeros((len(rows), max(map(len, rows.values())), 3), np.float32)
        for layer, each in zip(layers, rows.values(), strict=True):
            layer[:, : each.shape[1]] = each
        values = {STACK: layers}
        texels = [LAYER.format(index, len(rows)) for index in range(len(rows))]
    fetches = [
        FETCH[kind].format(name, texel)
        for (name, (kind, _)), texel in zip(arguments.items(), texels, strict=True)
    ]
    lines = ["ivec2 mxeon_pixel = ivec2(gl_FragCoord.xy);", *fetches, *body]
    samplers = [
        dialect.sampler.format(name=name, number=number) for number, name in enumerate(values)
    ]
    text = [*samplers, "void main()", "{", *("    " + line for line in lines), "}", ""]
    return "\n".join(text), values
