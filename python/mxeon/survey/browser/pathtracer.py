# SPDX-License-Identifier: Apache-2.0
"""Diffuse functions of the package three-gpu-pathtracer, called for pairs of directions."""

from __future__ import annotations

import base64
import math
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import NotRun
from mxeon.hosts import webgl
from mxeon.hosts.base import Array
from mxeon.shaders.scene import Scene
from mxeon.survey import browser
from mxeon.survey.browser import three
from mxeon.survey.specs import PUBLISHED, Material, node

PACKAGE = "three-gpu-pathtracer"
IMPORTS = {**three.IMPORTS, f"{PACKAGE}/": f"{PACKAGE}/"}

LOBE = "WebGLPathTracer, diffuseEval"
# Length of a half vector for which the dot product with wo is at most 1 after rounding.
SHORTER = 1.0 - 2.0**-22
# The value of "call" is a WGSL function of WebGPUPathTracer. The value of "scale" is the length of
# the half vector in the GLSL of WebGLPathTracer.
NODES = (
    node("WebGPUPathTracer, eonBrdf", "eon", {"call": "eon"}, forms=PUBLISHED, sampled=True),
    node("WebGPUPathTracer, fonBrdf", "fon", {"call": "fon"}),
    node(LOBE, "burley", {"scale": 1.0}),
    node(f"{LOBE}, shorter wh", "burley", {"scale": SHORTER}),
)

PI = "#define PI 3.141592653589793"
# The surface has no refraction (f0 = 0), so all light reaches the diffuse lobe.
GLSL = """
vec3 diffuse_value(vec3 wo, vec3 wi, vec3 rho, float roughness, float scale)
{
    SurfaceRecord surface;
    surface.color = rho;
    surface.roughness = roughness;
    surface.metalness = 0.0;
    surface.transmission = 0.0;
    surface.eta = 1.0;
    surface.f0 = 0.0;
    vec3 value = vec3(0.0);
    if (wi.z > 0.0) diffuseEval(wo, wi, scale * normalize(wo + wi), surface, value);
    return value;
}
"""


class GpuPathTracerHost(browser.PackageHost):
    name = title = package = PACKAGE
    imports = IMPORTS
    backends = ("",)

    @cached_property
    def _webgl(self) -> webgl.WebGlHost:
        return webgl.WebGlHost()

    def pairs(
        self, material: Material, wo: Array, wi: Array, color: Array, roughness: Array
    ) -> Array:
        if "call" in material:
            return self._execute(material["call"], wo, wi, color, roughness)
        scale = np.full(len(wo), material["scale"])
        arguments = (wo, wi, color, roughness, scale)
        return self._webgl.execute(self._source(), "diffuse_value", *arguments)

    def node(self, material: Material, scene: Scene) -> Array:
        raise NotRun(
            f"{self.name}: its path tracers do not draw here: with three 0.187.0 the wavefront "
            "kernels do not compile, and the megakernel crashes the software device"
        )

    def density(self, wo: Array, wi: Array, roughness: Array) -> Array:
        return self._execute("density", wo, wi, np.zeros_like(wo), roughness)[:, 0]

    def sample(self, wo: Array, u: Array, roughness: Array) -> Array:
        numbers = np.concatenate([u, np.zeros((len(u), 1))], axis=1)
        return self._execute("sample", wo, numbers, np.zeros_like(wo), roughness)

    def close(self) -> None:
        super().close()
        if "_webgl" in vars(self):
            self._webgl.close()

    def _execute(self, call: str, *columns: ArrayLike) -> Array:
        """Values of a WGSL function for rows of arguments, (N, 3)."""
        table = np.column_stack([np.asarray(each, np.float32) for each in columns])
        count = len(table)
        size = math.isqrt(count - 1) + 1  # the answer is a square picture
        rows = np.zeros((size * size, table.shape[1]), np.float32)
        rows[:count] = table
        answer = self.ask({"call": call, "rows": base64.b64encode(rows.tobytes()).decode()})
        return browser.pixels(answer, size).reshape(-1, 3)[:count]

    def _source(self) -> str:
        """GLSL of the package's diffuse lobe, with a function that calls the lobe."""
        folder = self._modules / PACKAGE / "src" / "shader"
        files = ("structs/surface_record_struct", "common/fresnel_functions")
        texts = [_template(folder / f"{file}.glsl.js") for file in files]
        lobes = _template(folder / "bsdf/bsdf_functions.glsl.js")
        begin, end = "float diffuseEval(", "vec3 diffuseDirection("
        if begin not in lobes or end not in lobes:
            raise NotRun(f"{PACKAGE}: no {begin}) in its shader text")
        lobe = begin + lobes.split(begin)[1].split(end)[0]
        return "\n".join([PI, *texts, lobe, GLSL])


def _template(path: Path) -> str:
    """The first template string in a module, which is shader text."""
    try:
        return path.read_text("utf-8").split("`")[1]
    except (OSError, IndexError):
        raise NotRun(f"{PACKAGE}: no shader text in {path}") from None
