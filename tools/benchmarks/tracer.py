# SPDX-License-Identifier: Apache-2.0
"""A path tracer on the OpenGL host that calls the shader functions for value, sample and density of EON.

It shows a sampler over many bounces, on a ball that is cut open around a core.
A distant light is evaluated at every reflection, a uniform environment when a path leaves the
objects. A path ends early only if its weight is 0.
"""

from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.gl import GlHost
from mxeon.shaders import functions as twins

# Calls of a sample and its density, by the sampler's name.
SAMPLERS = {
    "cosine": ("cosine_sample(u1, u2)", "cosine_pdf(wi)"),
    "eon_cltc": ("eon_cltc_sample(wo, u1, u2, r)", "eon_cltc_pdf(wo, wi, r)"),
    "eon": ("eon_sample(wo, u1, u2, TRACER_GREY, r)", "eon_pdf(wo, wi, TRACER_GREY, r)"),
}

# Attributes of a Trace that are uniforms of the shader.
UNIFORMS = ("rho", "roughness", "light", "environment", "bounces", "floor", "eye", "seed")


@dataclass(frozen=True)
class Trace:
    """A picture of EON to trace. World frame: x to the right, y up, z towards the viewer."""

    sampler: str  # key of `SAMPLERS`
    rho: tuple[float, float, float]  # reflectance of the ball
    bounces: int  # maximum reflections per path
    samples: int  # paths per pixel
    environment: float  # radiance of a uniform environment
    floor: float  # reflectance of a Lambertian floor; negative for none
    eye: tuple[float, float, float]  # towards the viewer, orthographic
    height: float  # height of the frame's center
    half_width: float
    # Direction of a distant light of irradiance pi; zeros for none.
    light: tuple[float, float, float] = (0.0, 0.0, 0.0)
    roughness: float = 1.0
    size: int = 256  # pixels on a side
    seed: int = 0


def trace(host: GlHost, picture: Trace) -> NDArray[np.float32]:
    """The traced linear picture (size, size, 3): a ball, cut open so that it lights itself."""
    draw, density = SAMPLERS[picture.sampler]
    defines = [f"#define TRACER_SAMPLE(wo, u1, u2, r) {draw}"]
    defines += [f"#define TRACER_PDF(wo, wi, r) {density}"]
    tracer = files("tools.benchmarks").joinpath("tracer.glsl").read_text(encoding="utf-8")
    sources = (twins.source("glsl", each) for each in (twins.ALL, "random"))
    text = "\n".join(["#version 430", *sources, *defines, tracer])
    uniforms = {f"tracer_{name}": getattr(picture, name) for name in UNIFORMS}
    uniforms["tracer_frame"] = picture.height, picture.half_width, picture.size
    size = picture.size, picture.size
    total = host.accumulate(text, uniforms, size, range(picture.samples))
    mean: NDArray[np.float32] = total[::-1, :, :3] / np.float32(picture.samples)
    return mean
