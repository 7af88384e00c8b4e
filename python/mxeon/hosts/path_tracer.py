# SPDX-License-Identifier: Apache-2.0
"""Path tracing on OpenGL with `path_tracer.glsl` and generated text of the profile "path"."""

import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

import numpy as np

from mxeon.errors import InputError
from mxeon.hosts import Row, gl, raster
from mxeon.hosts.base import Array
from mxeon.hosts.textures import read_latlong
from mxeon.shaders.generation import Shader
from mxeon.shaders.methods import UNCHOSEN
from mxeon.shaders.scene import SHAPES, Scene
from mxeon.shaders.shader_ball import BELT, OBJECT

SAMPLES, BOUNCES = 64, 8  # default numbers of paths per pixel and bounces per path
NOISY = 0.02  # relative noise above which a picture is denoised or a remedy is reported
# The function `texture` needs derivatives, which a path does not have, so level 0 is read.
HEAD = "#version 430\n#define texture(map, at) textureLod(map, at, 0.0)\n"


def by_light(sky: Array) -> tuple[Array, Array]:
    """Indices of 256 x 256 texels drawn in proportion to light, and each texel's probability."""
    rows, columns, _ = sky.shape
    across = np.sin(np.pi * (np.arange(rows) + 0.5) / rows)[:, np.newaxis]
    share = np.cumsum(sky.mean(axis=-1) * across + 1e-6)
    drawn = np.searchsorted(share, (np.arange(1 << 16) + 0.5) / (1 << 16) * share[-1])
    chance = np.bincount(drawn, minlength=rows * columns) / float(1 << 16)
    return np.float32(drawn).reshape(256, 256, 1), np.float32(chance).reshape(rows, columns, 1)


class NoiseNote(UserWarning):
    """Reports the estimated noise of a picture."""


class PathTracerHost(gl.GlHost):
    """A path tracer on OpenGL, which reports the noise of a picture as a NoiseNote."""

    name = "path"
    profile: ClassVar[str | None] = "path"
    default = UNCHOSEN

    def picture(self, shader: Shader, scene: Scene) -> Array:
        if scene.shape not in SHAPES:
            known = " or ".join(SHAPES)
            raise InputError(f"--integrator path: shape must be {known}; got {scene.shape}")
        samples, bounces = scene.paths.samples or SAMPLES, scene.paths.bounces or BOUNCES
        tracer = Path(__file__).with_suffix(".glsl").read_text(encoding="utf-8")
        uniforms: dict[str, object] = {
            **raster.inputs(shader),
            "tracer_bounces": bounces,
            "tracer_size": scene.size,
            "tracer_ball": scene.shape == "ball",
            "tracer_light": scene.light or (0.0, 0.0, 0.0),
            "tracer_foot": tuple(OBJECT.T.ravel()),
            "tracer_belt": tuple(BELT.T.ravel()),
        }
        sky = read_latlong(scene.environment)
        drawn, chance = by_light(sky)
        uniforms["tracer_mapped"] = sky.size > sky.shape[-1]
        textures = raster.textures(shader, scene) | {"tracer_environment": sky}
        textures |= {"tracer_drawn": drawn, "tracer_chance": chance}
        text, size = HEAD + shader.stages["pixel"] + tracer, (scene.size, scene.size)
        sums = self.accumulate(text, uniforms, size, range(samples), textures)
        mean = sums[::-1] / np.float32(samples)
        gray = mean[..., :3].mean(axis=-1)
        variance = np.maximum(mean[..., 3] - gray**2, 0.0) / max(samples - 1, 1)
        noise = np.sqrt(variance.sum() / max((gray**2).sum(), 1e-30))
        note = f"{shader.element}: noise of {100.0 * noise:.2g} % of the light"
        image = np.ascontiguousarray(mean[..., :3])
        if noise > NOISY and scene.paths.samples is None and find_spec("pyoidn"):
            import pyoidn  # part of the `render` extra; the import is slow

            image = pyoidn.denoise(image, hdr=True)
            note += ", removed by Open Image Denoise; --samples N turns this off"
        elif noise > NOISY:
            note = f"{shader.element}: still noisy ({100.0 * noise:.2g} %); try --samples {16 * samples}"
        warnings.warn(NoiseNote(note), stacklevel=2)
        return image

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        return raster.missing_properties(shader)


ROW = Row("path", "glsl", start=lambda name: PathTracerHost())
