# SPDX-License-Identifier: Apache-2.0
"""A path tracer on the OpenGL host that calls the shader functions for value, sample and density.

It shows a model and a sampler over many bounces, on a ball that is closed or cut open around a core.
A distant light is evaluated at every reflection, a uniform environment when a path leaves the
objects. A path ends early only if its weight is 0.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import InputError
from mxeon.hosts.gl import GlHost
from mxeon.shaders import functions as twins

# Calls of a sample and its density, by the sampler's name.
SAMPLERS = {
    "uniform": ("uniform_sample(u1, u2)", "uniform_pdf(wi)"),
    "cosine": ("cosine_sample(u1, u2)", "cosine_pdf(wi)"),
    "ltc0": ("ltc0_sample(wo, u1, u2, r)", "ltc0_pdf(wo, wi, r)"),
    "ltc": ("ltc_sample(wo, u1, u2, r)", "ltc_pdf(wo, wi, r)"),
    "cltc": ("cltc_sample(wo, u1, u2, r)", "cltc_pdf(wo, wi, r)"),
    "eon_cltc": ("eon_cltc_sample(wo, u1, u2, r)", "eon_cltc_pdf(wo, wi, r)"),
    "eon": ("eon_sample(wo, u1, u2, TRACER_GREY, r)", "eon_pdf(wo, wi, TRACER_GREY, r)"),
}
# Call of a value, by the model's name; each lobe of EON is also a model.
SIGMA_MODELS = ("oren_nayar", "qon", "qon_footnote", "qon_fujii")
MODELS = {
    "lambert": "lambert_brdf(wo, wi, rho)",
    **{name: f"{name}_brdf(wo, wi, rho, r)" for name in (*SIGMA_MODELS, "fon", "eon")},
    "eon_approx": "eon_brdf_approx(wo, wi, rho, r)",
    "eon_single": "fon_brdf(wo, wi, rho, r)",
    "eon_multiple": "(eon_brdf(wo, wi, rho, r) - fon_brdf(wo, wi, rho, r))",
}

# Attributes of a Trace that are uniforms of the shader.
UNIFORMS = ("rho", "parameter", "light", "environment", "bounces", "opened", "floor", "eye", "seed")


@dataclass(frozen=True)
class Trace:
    """A picture to trace. World frame: x to the right, y up, z towards the viewer."""

    model: str  # key of `MODELS`
    sampler: str = "cosine"  # key of `SAMPLERS`
    rho: tuple[float, float, float] = (1.0, 1.0, 1.0)  # reflectance of the ball
    parameter: float = 1.0  # sigma or roughness; samplers use the roughness 2 sigma / pi
    # Direction of a distant light of irradiance pi; zeros for none.
    light: tuple[float, float, float] = (0.0, 0.0, 0.0)
    environment: float = 0.0  # radiance of a uniform environment
    bounces: int = 1  # maximum reflections per path
    opened: bool = True  # the ball is a shell, cut open around a core, on a foot
    floor: float = -1.0  # reflectance of a Lambertian floor; negative for none
    eye: tuple[float, float, float] = (0.0, 0.0, 1.0)  # towards the viewer, orthographic
    height: float = 0.0  # height of the frame's center
    half_width: float = 1.0
    size: int = 256  # pixels on a side
    samples: int = 64  # paths per pixel
    seed: int = 0


def program(model: str, sampler: str) -> str:
    """Fragment shader of the path tracer for a model and a sampler."""
    for name, value, known in (("model", model, MODELS), ("sampler", sampler, SAMPLERS)):
        if value not in known:
            raise InputError(f"{name} must be one of {', '.join(known)}; got {value!r}")
    draw, density = SAMPLERS[sampler]
    macros = {
        "BRDF(wo, wi, rho, r)": MODELS[model],
        "SAMPLE(wo, u1, u2, r)": draw,
        "PDF(wo, wi, r)": density,
    }
    defines = [f"#define TRACER_{head} {body}" for head, body in macros.items()]
    tracer = files("tools.paper").joinpath("tracer.glsl").read_text(encoding="utf-8")
    sources = map(partial(twins.source, "glsl"), (twins.ALL, "random"))
    return "\n".join(["#version 430", *sources, *defines, tracer])


def trace(
    host: GlHost, picture: Trace, progress: Callable[[range], Iterable[int]] = iter
) -> NDArray[np.float32]:
    uniforms = {f"tracer_{name}": getattr(picture, name) for name in UNIFORMS}
    sigma = picture.model in SIGMA_MODELS
    uniforms["tracer_roughness"] = picture.parameter * (2.0 / np.pi if sigma else 1.0)
    uniforms["tracer_frame"] = picture.height, picture.half_width, picture.size
    text, size = program(picture.model, picture.sampler), (picture.size, picture.size)
    total = host.accumulate(text, uniforms, size, progress(range(picture.samples)))
    mean: NDArray[np.float32] = total[::-1, :, :3] / np.float32(picture.samples)
    return mean
