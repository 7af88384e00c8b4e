# SPDX-License-Identifier: Apache-2.0
"""Frames that a rasterizing host draws with uniforms, textures, and a triangle over all pixels."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from mxeon.hosts import base, fragment, points
from mxeon.hosts.base import TABLE, Array, Query
from mxeon.hosts.points import MARGIN, visible
from mxeon.hosts.textures import image_files, irradiance, read_latlong, read_texture
from mxeon.shaders.document.values import Plain, flat
from mxeon.shaders.generation import Input, Shader
from mxeon.shaders.inner_lobes import SUBSURFACE, TRANSMISSION, VOLUME, inner_lobes
from mxeon.shaders.methods import GENERATED, TABLE_SIZE
from mxeon.shaders.scene import SIDE, Client, Lamp, Scene, VisiblePoints

Uniforms: TypeAlias = dict[str, Plain]  # values by name

Rectangle: TypeAlias = tuple[int, int, int, int]  # left, lowest row, width, height

BAND = 4  # number of rows in each of the rectangles that cover a shape
ALPHA_THRESHOLD = 1e-3  # generated text discards pixels with a smaller alpha
VIEW_DISTANCE = 1e8  # makes normalize(u_viewPosition - positionWorld) the z axis, in float32
# Texels of a white environment. A single texel would have no mipmaps, and Mesa would compile
# programs again for other environments.
WHITE_TEXELS = np.ones((2, 2, 3), dtype=np.float32)

# Microfacet lobes are summed over 1024 directions in evaluations and over 256 in pictures. Only the
# first mipmap of the environment is read. docs/hosts.md compares numbers of directions.
EVALUATION = {"u_envRadianceSamples": 1024, "u_envRadianceMips": 1}
PICTURE_DIRECTIONS = 256
DARK = {"u_envRadianceSamples": 1, "u_envRadianceMips": 1}  # settings without an environment
TRIANGLE = {  # attributes of a triangle's three vertices
    "i_position": np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], dtype="f4"),
    "i_normal": np.array([[0, 0, 1]] * 3, dtype="f4"),
}

PROPERTY = re.compile(r"^ *(?:in )?(float|vec\d) i_geomprop_(\w+);", re.MULTILINE)
INNER_APPROXIMATIONS = {
    SUBSURFACE: "subsurface_bsdf is rasterized: its direct light is blurred as on a sphere of the "
    "surface's curvature, and under an environment it is Lambertian",
    TRANSMISSION: "transmission is rasterized: the surface shows the environment in one "
    "refracted direction, without light that the object itself bends or blocks",
    VOLUME: "a volume is rasterized: it absorbs over a length of 1 and scatters nothing",
}


def missing_properties(shader: Shader) -> tuple[str, ...]:
    """A note on the geometric properties whose defaults are drawn, if there are any."""
    found = PROPERTY.findall(shader.stages["pixel"])
    names = sorted({name for size, name in found if size != "vec2"})  # pairs are on the shape
    note = f"no shape has the property {', '.join(names)}: its node's default is drawn"
    return (note,) if names else ()


def approximations(shader: Shader) -> tuple[str, ...]:
    """Descriptions of how generated GLSL approximates a shader's lobes below the surface."""
    return tuple(INNER_APPROXIMATIONS[kind] for kind in inner_lobes(shader))


def textures(shader: Shader, scene: Scene) -> dict[str, Array]:
    """Texels by sampler for the images of a shader's document and for the environment.

    Row 0 of an array is at v = 0. Samplers of the same file share an array.
    """
    client, radiance = scene.client, read_latlong(scene.environment)
    return images(shader) | {
        "u_envRadiance": radiance if client.radiance is None else client.radiance,
        "u_envIrradiance": irradiance(radiance) if client.irradiance is None else client.irradiance,
        "u_shadowMap": np.full((2, 2, 3), (*client.moments, 0.0), np.float32),
        "u_ambOccMap": np.full((2, 2, 3), client.ambient, np.float32),
    }


def images(shader: Shader) -> dict[str, Array]:
    """Texels of the images of a shader's document, by sampler.

    An image without a file has the color of its node's `default`, as in MaterialX's renderer. If
    there is no default, the image is black.
    """
    pixels = {name: read_texture(name) for name in image_files([shader])}
    values = {port.path: port.value for port in shader.inputs}

    def texels(port: Input) -> Array:
        if port.value:
            return pixels[str(port.value)]
        color = values.get(f"{port.path.rpartition('/')[0]}/default") or 0.0
        texel = [*(color if isinstance(color, tuple) else [color] * 3), 0.0, 0.0]
        return np.tile(np.array(texel[:4], np.float32), (2, 2, 1))

    return {port.name: texels(port) for port in shader.inputs if port.type == "filename"}


def environment(irradiance: Array | None) -> dict[str, Array]:
    """Texels of an environment for each sampler. The environment is white by default."""
    return dict.fromkeys(
        ("u_envRadiance", "u_envIrradiance"), WHITE_TEXELS if irradiance is None else irradiance
    )


def inputs(shader: Shader) -> Uniforms:
    """Values of the uniforms for a shader's inputs, except images.

    A matrix is a flat tuple, in which a row of the input is a column of the uniform. Each member of
    a structure is a separate uniform.
    """
    return {
        name: value
        for port in shader.inputs
        for name, _, value in flat(port.name, port.type, port.value, shader.document)
    }


def light(scene: Scene, directions: int = PICTURE_DIRECTIONS) -> Uniforms:
    """Values of the uniforms for the viewer, all lights, and other settings of the client."""
    client = scene.client
    values: Uniforms = {
        **surroundings(client),
        "u_viewPosition": (0.0, 0.0, VIEW_DISTANCE),
        "u_shadowMatrix": client.shadow,
        "u_ambOccGain": client.gain,
        "u_alphaThreshold": ALPHA_THRESHOLD,
        points.ALPHA: client.alpha,
    }
    values |= DARK
    if scene.environment is not None or client.radiance is not None:
        values["u_envRadianceSamples"] = directions
    if isinstance(scene.environment, Path):  # mipmaps avoid a visible pattern of samples
        values["u_envRadianceMips"] = int(np.log2(max(read_latlong(scene.environment).shape))) + 1
    lamps = client.lamps
    if scene.light is not None:
        x, y, z = scene.light
        lamps = (Lamp(direction=(-x, -y, -z)), *lamps)
    values["u_numActiveLightSources"] = len(lamps)  # set even if 0, since programs keep old values
    for number, lamp in enumerate(lamps):
        for name, value in vars(lamp).items():
            values[f"u_lightData[{number}].{name}"] = value
    return values


def surroundings(client: Client) -> Uniforms:
    """Values of the uniforms that a client sets for an environment."""
    return {
        "u_envMatrix": client.turn,
        "u_envLightIntensity": client.intensity,
        "u_refractionTwoSided": client.two_sided,
    }


@lru_cache(maxsize=8)
def bands(size: int, shape: str) -> tuple[Rectangle, ...]:
    """Rectangles that cover a shape in a frame whose row 0 is at the bottom.

    The edges of rectangles are multiples of BAND, so that blocks of 2 x 2 pixels stay whole.
    """
    mask = visible(size, shape).mask[::-1]
    parts = []
    for low in range(0, size, BAND):
        columns = np.flatnonzero(mask[low : low + BAND].any(axis=0)) // BAND * BAND
        if columns.size:
            left, right = int(columns[0]), min(int(columns[-1]) + BAND, size)
            parts.append((left, low, right - left, min(BAND, size - low)))
    return tuple(parts)


# An evaluation has two lights, and belongs to frame 24 of an animation.
FRAME_UNIFORMS = (
    light(SIDE)
    | {"u_numActiveLightSources": 2, "u_frame": 24.0, "u_time": 1.0, TABLE + "Size": TABLE_SIZE}
    | EVALUATION
)


class Frame(NamedTuple):
    """A program with the data of a frame. Arguments have one row, or one row per element."""

    vertex: str
    pixel: str
    arguments: Mapping[str, Array] = {}
    textures: Mapping[str, Array] = {}
    uniforms: Uniforms = FRAME_UNIFORMS


class FragmentHost(base.Host):
    """A host whose engine draws frames with one pixel per element of an evaluation or a call."""

    reads_images = True
    default = GENERATED

    def picture(self, shader: Shader, scene: Scene) -> Array:
        self.refuse_paths(scene)
        seen = visible(scene.size, scene.shape, MARGIN)
        image = self.shade(shader, scene, seen, bands(scene.size, scene.shape))
        return np.where(visible(scene.size, scene.shape).mask[..., None], image, np.float32(0.0))

    def shade(
        self,
        shader: Shader,
        scene: Scene,
        seen: VisiblePoints,
        parts: Sequence[Rectangle] = (),
        directions: int = PICTURE_DIRECTIONS,
    ) -> Array:
        """Radiance at visible points, (height, width, 3), row 0 at the top.

        `seen` includes a margin, and the result does not. Pixels outside `parts` may stay black.
        """
        bound = textures(shader, scene) | self.table(shader)
        return self._shade(shader, seen, bound, inputs(shader) | light(scene, directions), parts)

    def _shade(
        self,
        shader: Shader,
        seen: VisiblePoints,
        textures: dict[str, Array],
        uniforms: Uniforms,
        parts: Sequence[Rectangle],
    ) -> Array:
        raise self._unsupported("pictures of a sphere", "gl")

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        return (*approximations(shader), *missing_properties(shader))

    def _values(self, query: Query) -> Array:
        pixel, arguments = fragment.bsdf_evaluation(query)
        textures = environment(query.irradiance) | images(query.shader) | self.table(query.shader)
        uniforms = FRAME_UNIFORMS | surroundings(query.client)
        vertex = query.shader.stages["vertex"]
        return self._in_parts(Frame(vertex, pixel, arguments, textures, uniforms))

    def _drawn_table(self, text: str) -> Array:
        dialect, (version, rest) = fragment.DIALECTS[self.target], text.split("\n", 1)
        texels = self._evaluate(Frame(dialect.vertex, f"{version}\n{dialect.prelude}{rest}"))
        return texels.reshape(TABLE_SIZE, TABLE_SIZE, 3)

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        return self.drawn(*fragment.function_evaluation(source, function, arguments, self.target))

    def drawn(self, pixel: str, texels: Mapping[str, Array]) -> Array:
        """Values of a pixel stage without vertex outputs, one value for each row of `texels`."""
        vertex = fragment.DIALECTS[self.target].vertex
        return self._in_parts(Frame(vertex, pixel, texels, environment(None)))

    def _in_parts(self, frame: Frame) -> Array:
        """Values of a pixel stage, evaluated part by part to limit the size of textures."""
        frames = (frame._replace(arguments=part) for part in fragment.parts(frame.arguments))
        return np.concatenate(list(map(self._evaluate, frames)))

    @abstractmethod
    def _evaluate(self, frame: Frame) -> Array:
        """Values of a pixel stage, one for each element of the longest argument."""
