# SPDX-License-Identifier: Apache-2.0
"""Pictures that are exact at every pixel, because a vertex stage runs for each pixel.

A mesh that is exact at each pixel needs two triangles per pixel, and drivers shade whole blocks of
pixels for each triangle. Instead, a host runs a generated vertex stage for points and captures the
outputs. The pixel stage reads the outputs from the layers of a texture, one texel per pixel, and
one triangle covers the picture. Derivatives are differences between neighboring pixels, as usual.

The text of each stage is unchanged. Macros turn the inputs of the pixel stage into variables, and
a second `main` sets these variables before calling the generated `main`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.fragment import renamed
from mxeon.hosts.mesh import mesh_points_at
from mxeon.io.images import Floats
from mxeon.shaders.document.values import property_defaults
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import SHAPES, VisiblePoints, pixel_centers, sphere_at, tangents
from mxeon.shaders.shader_ball import shader_ball_at

MARGIN = 1  # number of points beyond each edge, for derivatives at the edges
SAMPLER = "mxeon_points"
ALPHA = "mxeon_alpha"  # uniform that makes pixels show alpha instead of color

# Macros that turn the inputs of a pixel stage into variables. In GLSL, the inputs form a block.
VARIABLES = {
    "glsl": "#define VertexData mxeon_Inputs { float mxeon_unused; } mxeon_inputs; struct VertexData\n",
    "essl": "#define in\n",
}
# Names and values of vertex attributes; () stands for the shape's texture coordinates.
Constants: TypeAlias = tuple[tuple[str, tuple[float, ...]], ...]
ATTRIBUTE = re.compile(r"^in (float|vec\d) i_(color|geomprop|texcoord)_(\w+);", re.MULTILINE)
WHITE, BLACK = (1.0,) * 4, (0.0,)
FORMATS = {"float": "f4", "vec2": "2f4", "vec3": "3f4", "vec4": "4f4", "int": "i4"}


@dataclass(frozen=True)
class Output:
    kind: str  # GLSL type
    name: str  # name in the vertex stage, which identifies the output to capture
    variable: str  # name in the pixel stage


def outputs(shader: Shader) -> tuple[Output, ...]:
    """Outputs of a generated vertex stage, which the pixel stage declares as inputs."""
    text = shader.stages["pixel"]
    if shader.target == "essl":
        found = re.findall(r"^(?:flat )?in (\w+) (\w+);", text, re.MULTILINE)
        return tuple(Output(kind, name, name) for kind, name in found)
    block = re.search(r"^in VertexData\s*\{([^}]*)\} (\w+);", text, re.MULTILINE)
    members, instance = block.groups() if block else ("", "")
    return tuple(
        Output(kind, f"VertexData.{name}", f"{instance}.{name}")
        for kind, name in re.findall(r"(\w+) (\w+);", members)
    )


def pixel_stage(shader: Shader) -> str:
    """Pixel stage that reads the outputs of the vertex stage from a texture."""
    version, text = shader.stages["pixel"].split("\n", 1)
    reads = [
        f"    {each.variable} = {each.kind}(texelFetch({SAMPLER}, ivec3(pixel, {layer}), 0));\n"
        for layer, each in enumerate(outputs(shader))
    ]
    [output] = re.findall(r"\bout vec4 (\w+);", text)
    return (
        f"{version}\n#define flat\n{VARIABLES[shader.target]}{renamed(text)}#undef main\n"
        f"uniform highp sampler2DArray {SAMPLER};\nuniform bool {ALPHA};\nvoid main()\n{{\n"
        f"    ivec2 pixel = ivec2(gl_FragCoord.xy) + {MARGIN};\n{''.join(reads)}"
        f"    mxeon_generated_main();\n    if ({ALPHA}) {output} = {output}.aaaa;\n}}\n"
    )


@lru_cache(maxsize=4)
def visible(size: int, shape: str, margin: int = 0) -> VisiblePoints:
    """Visible points of a shape at pixel centers; see `mxeon.shaders.scene.Scene` for shapes."""
    return visible_at(*pixel_centers(size, margin), shape)


def visible_at(x: Floats, y: Floats, shape: str) -> VisiblePoints:
    """Visible points of a shape at positions in the frame."""
    if shape in SHAPES:
        return shader_ball_at(x, y) if shape == "ball" else sphere_at(x, y)
    return mesh_points_at(shape, x, y)


def constants(shader: Shader) -> Constants:
    """Values of the attributes that no shape has: white vertex colors and geometric properties.

    A property has the default of its node. Pairs of numbers are texture coordinates, as USD's `st`;
    their value is (). Integers stay 0.
    """
    defaults, constants = property_defaults(shader.document), []
    for size, kind, name in ATTRIBUTE.findall(shader.stages["vertex"]):
        value = WHITE if kind == "color" else defaults.get(name, BLACK)
        on_shape = size == "vec2" or kind == "texcoord"
        constants.append((f"i_{kind}_{name}", () if on_shape else value))
    return tuple(constants)


def vertices(points: VisiblePoints, constants: Constants) -> dict[str, NDArray[np.float32]]:
    """Vertex attributes of the points of a frame, row by row from the top."""
    flat = points.normal.reshape(-1, 3)
    attributes = {
        "i_position": points.position.reshape(-1, 3),
        "i_normal": flat,
        "i_tangent": tangents(flat) if points.tangent is None else points.tangent.reshape(-1, 3),
    }
    for name, value in constants:
        shown = points.texcoord.reshape(-1, 2)
        attributes[name] = np.tile(value, (len(flat), 1)) if value else shown
    return {name: values.astype("f4") for name, values in attributes.items()}


def frame(points: VisiblePoints) -> tuple[int, int]:
    """Width and height of a frame of points, not including the margin."""
    height, width = points.mask.shape
    return width - 2 * MARGIN, height - 2 * MARGIN


def stride(captured: Iterable[Output]) -> int:
    return _row(captured).itemsize


def texels(buffer: bytes, captured: Sequence[Output], points: VisiblePoints) -> NDArray[np.float32]:
    """Texels of the captured outputs, (layers, rows, columns, 4), row 0 at the bottom."""
    height, width = points.mask.shape
    rows = np.frombuffer(buffer, _row(captured))
    layers = np.zeros((len(captured), height * width, 4), dtype=np.float32)
    for layer, each in zip(layers, captured, strict=True):
        values = rows[each.name].reshape(height * width, -1)
        layer[:, : values.shape[1]] = values
    return np.ascontiguousarray(layers.reshape(-1, height, width, 4)[:, ::-1])


def _row(captured: Iterable[Output]) -> np.dtype[np.void]:
    return np.dtype([(each.name, FORMATS[each.kind]) for each in captured])
