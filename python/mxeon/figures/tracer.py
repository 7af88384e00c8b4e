# SPDX-License-Identifier: Apache-2.0
"""A path tracer on the OpenGL host, which uses the shader twins for value, sampling and density.

It shows what a model and a sampler do over many bounces: a ball, alone or opened around a core.
The estimate needs no choice of lights: a distant light is met at every reflection, and a uniform
surrounding where a path leaves the objects. Nothing ends a path early but a weight of 0.
"""

from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from mxeon.errors import InputError
from mxeon.shaders import functions as twins

# How a draw and its density are called, by the sampler's name.
SAMPLERS = {
    "uniform": ("uniform_sample(u1, u2)", "uniform_pdf(wi)"),
    "cosine": ("cosine_sample(u1, u2)", "cosine_pdf(wi)"),
    "ltc0": ("ltc0_sample(wo, u1, u2, r)", "ltc0_pdf(wo, wi, r)"),
    "ltc": ("ltc_sample(wo, u1, u2, r)", "ltc_pdf(wo, wi, r)"),
    "cltc": ("cltc_sample(wo, u1, u2, r)", "cltc_pdf(wo, wi, r)"),
    "eon_cltc": ("eon_cltc_sample(wo, u1, u2, r)", "eon_cltc_pdf(wo, wi, r)"),
    "eon": ("eon_sample(wo, u1, u2, TRACER_GREY, r)", "eon_pdf(wo, wi, TRACER_GREY, r)"),
}
# How a value is called, by the model's name; the lobes of EON are models too.
SIGMA_MODELS = ("oren_nayar", "qon", "qon_footnote", "qon_fujii")
MODELS = {
    "lambert": "lambert_brdf(wo, wi, rho)",
    **{name: f"{name}_brdf(wo, wi, rho, r)" for name in (*SIGMA_MODELS, "fon", "eon")},
    "eon_approx": "eon_brdf_approx(wo, wi, rho, r)",
    "eon_single": "fon_brdf(wo, wi, rho, r)",
    "eon_multiple": "(eon_brdf(wo, wi, rho, r) - fon_brdf(wo, wi, rho, r))",
}

# Attributes of a Trace that the shader takes as they are.
UNIFORMS = ("rho", "parameter", "light", "environment", "bounces", "opened", "floor", "eye", "seed")


@dataclass(frozen=True)
class Trace:
    """A picture to trace. World frame: x to the right, y up, z towards the viewer.

    Attributes
    ----------
    model, sampler : str
        Keys of `MODELS` and `SAMPLERS`.
    rho : tuple of 3 floats
        Reflectance of the ball.
    parameter : float
        The model's sigma or roughness, as the ball has it. Samplers take 2 sigma / pi for one.
    light : tuple of 3 floats
        Unit vector towards a distant light of irradiance pi; zeros for none.
    environment : float
        Radiance of a uniform surrounding.
    bounces : int
        Reflections that a path may have, at least 1.
    opened : bool
        Whether the ball is a shell, cut open around a core, on a foot.
    floor : float
        Reflectance of a Lambertian floor; negative for none.
    eye : tuple of 3 floats
        Unit vector towards the viewer, who sees without perspective.
    height, half_width : float
        Height of the point that the frame is centred on, and half of what the frame holds.
    size, samples, seed : int
        Pixels on a side, paths per pixel, and which random numbers they take.
    """

    model: str
    sampler: str = "cosine"
    rho: tuple[float, float, float] = (1.0, 1.0, 1.0)
    parameter: float = 1.0
    light: tuple[float, float, float] = (0.0, 0.0, 0.0)
    environment: float = 0.0
    bounces: int = 1
    opened: bool = True
    floor: float = -1.0
    eye: tuple[float, float, float] = (0.0, 0.0, 1.0)
    height: float = 0.0
    half_width: float = 1.0
    size: int = 256
    samples: int = 64
    seed: int = 0


def program(model, sampler):
    """Fragment shader of the path tracer for a model and a sampler.

    Raises
    ------
    ValueError
        If one of them is unknown; lists the known ones.
    """
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
    tracer = files("mxeon.figures").joinpath("tracer.glsl").read_text(encoding="utf-8")
    return "\n".join(["#version 430", twins.source("glsl"), *defines, tracer])


def trace(host, picture, progress=iter):
    """Linear radiance that arrives at the viewer.

    Parameters
    ----------
    host : mxeon.shaders.hosts.gl.Host
    picture : Trace
    progress : callable
        Wraps the sequence of passes, one path per pixel each.

    Returns
    -------
    ndarray, shape (size, size, 3), float32
        Row 0 at the top.

    Raises
    ------
    ValueError
        If the model or the sampler is unknown; lists the known ones.
    """
    uniforms = {f"tracer_{name}": getattr(picture, name) for name in UNIFORMS}
    sigma = picture.model in SIGMA_MODELS
    uniforms["tracer_roughness"] = picture.parameter * (2.0 / np.pi if sigma else 1.0)
    uniforms["tracer_frame"] = picture.height, picture.half_width, picture.size
    text, size = program(picture.model, picture.sampler), (picture.size, picture.size)
    total = host.accumulate(text, uniforms, size, progress(range(picture.samples)))
    return total[::-1, :, :3] / np.float32(picture.samples)
