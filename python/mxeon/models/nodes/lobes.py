# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's sheens, diffuse nodes (except Oren-Nayar), hair and subsurface scattering.

Hair's inputs are named as in `mxeon.models.hair.chiang_hair_bcsdf`. Subsurface scattering is
evaluated on a plane under a distant light. All points of the plane receive the same light, so the
diffusion profile, whose integral is 1, has no effect. For any radius and anisotropy, the node is
Lambertian with the color of the node.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.models import hair, sheen
from mxeon.models.core.arrays import Array, array_namespace, at_most, cosine, library
from mxeon.models.diffuse import burley_albedo_dir, burley_brdf, lambert_brdf, translucent_btdf
from mxeon.models.hair import TEXT, TINTS, HairForm
from mxeon.models.microfacet import defects, dielectric_albedo_dir
from mxeon.models.nodes.node import Inputs, PbrNode, Variant
from mxeon.models.sheen import conty_kulla_albedo_dir, zeltner_albedo_dir

# The series of I_0 has TERMS terms. The logarithm of I_0 is approximated for arguments above LIMIT,
# and is used for variances below NARROW.
TERMS, LIMIT, NARROW = 10, 12.0, 0.1
LIMITS = (0.001, 1.0)  # range to which MaterialX clamps every roughness


def materialx_longitudinal(
    sin_i: Array, cos_i: Array, sin_o: Array, cos_o: Array, v: Array
) -> Array:
    """Longitudinal scattering M_p as in mx_chiang_hair_bsdf.glsl.

    The series of I_0(x), x = cos_i cos_o / v, stops after ten terms. For x above 12, log I_0(x)
    contains only half of the term 1 / (8 x). The cosine of a tilted direction, and so x, may be
    negative. The series is also used for x below -12. log(2) is rounded to 0.6931.
    """
    a, b = cos_i * cos_o / v, sin_i * sin_o / v
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        log_series = np.log(_series(np.minimum(a, LIMIT)))
        x = np.maximum(a, LIMIT)
        log_large = x + 0.5 * (1.0 / (8.0 * x) - np.log(2.0 * np.pi * x))
        logarithm = np.where(a > LIMIT, log_large, log_series)
        narrow = np.exp(logarithm - b - 1.0 / v + 0.6931 + np.log(0.5 / v))
        wide = np.exp(-b) * _series(a) / (2.0 * v * np.sinh(1.0 / np.maximum(v, NARROW)))
    return np.where(v < NARROW, narrow, wide)


def _series(x: Array) -> Array:
    """Sum of the first TERMS terms of the power series of the Bessel function I_0."""
    value = term = np.ones_like(x)
    for k in range(1, TERMS):
        term = term * np.square(0.5 * x / k)
        value = value + term
    return value


UNIFORM, BESSEL, CLAMPED, TILTED = (
    "N of TRRT+ pi/2 instead of 1/(2 pi)",
    "I_0 from ten terms, and half a term of its logarithm",
    "roughness clamped to [0.001, 1]",
    "the viewer's inclination tilted instead of the light's",
)
FORMS: dict[str, HairForm] = {
    UNIFORM: replace(TEXT, uniform=0.5 * np.pi),
    BESSEL: replace(TEXT, longitudinal=materialx_longitudinal),
    CLAMPED: replace(TEXT, limits=LIMITS),
    TILTED: replace(TEXT, tilts_light=False),
    f"MaterialX's GLSL: {UNIFORM}; {BESSEL}; {CLAMPED}": replace(
        TEXT, uniform=0.5 * np.pi, longitudinal=materialx_longitudinal, limits=LIMITS
    ),
}

# Hair models that the specification permits or that later versions of the specification use.
READINGS: dict[str, HairForm] = {
    "F of the effective index": replace(TEXT, effective=True),
    "no factor 1/pi, as in later versions of the text": replace(TEXT, factor=1.0),
}


def _conty_kulla(mu: Array, roughness: Array) -> Array:
    """Albedo clamped to 1, because the specification does not define an albedo above 1."""
    return at_most(conty_kulla_albedo_dir(mu, roughness), 1.0)


def _tinted(albedo: Callable[[Array, Array], Array]) -> Callable[[Array, Inputs], Array]:
    """A function for the albedo of a lobe with the inputs `color` and `roughness`."""
    return lambda wo, i: albedo(cosine(wo[:, 2]), i["roughness"])[..., np.newaxis] * i["color"]


def _sheen(brdf: Callable[..., Array]) -> Callable[[Array, Array, Inputs], Array]:
    """A function for the BRDF of a lobe with the inputs `color` and `roughness`."""
    return lambda wo, wi, inputs: brdf(wo, wi, inputs["color"], inputs["roughness"])


COLOR_ROUGHNESS = ("color", "roughness")
LOBE_NODES = (
    PbrNode(
        "burley",
        "Burley diffuse",
        "burley_diffuse_bsdf",
        COLOR_ROUGHNESS,
        _sheen(burley_brdf),
        lambda wo, i: burley_albedo_dir(cosine(wo[:, 2]), i["color"], i["roughness"]),
        variants=(
            Variant("MaterialX's fit of its albedo", albedo=defects.burley_albedo),
            Variant(
                "Burley diffuse of roughness 0, without retro-reflection",
                lambda wo, wi, inputs: burley_brdf(wo, wi, inputs["color"], np.zeros(len(wo))),
            ),
            Variant("Lambert", lambda wo, wi, inputs: inputs["color"] / np.pi),
        ),
    ),
    PbrNode(
        "translucent",
        "Lambert transmission",
        "translucent_bsdf",
        ("color",),
        lambda wo, wi, inputs: translucent_btdf(wo, wi, inputs["color"]),
        lambda wo, inputs: inputs["color"] + 0.0 * wo[:, :1],
        transmits=True,
    ),
    PbrNode(
        "conty_kulla",
        "Conty-Kulla sheen",
        "sheen_bsdf",
        COLOR_ROUGHNESS,
        _sheen(sheen.conty_kulla_brdf),
        _tinted(_conty_kulla),
        _tinted(conty_kulla_albedo_dir),
        fixed={"mode": "conty_kulla"},
        layerable=True,
        fitted=True,
        variants=(
            Variant("Zeltner sheen", _sheen(sheen.zeltner_brdf), _tinted(zeltner_albedo_dir)),
            Variant(
                "MaterialX's fit of its albedo",
                albedo=lambda wo, i: np.asarray(defects.conty_kulla_albedo(wo, i) * i["color"]),
            ),
        ),
    ),
    PbrNode(
        "zeltner",
        "Zeltner sheen",
        "sheen_bsdf",
        COLOR_ROUGHNESS,
        _sheen(sheen.zeltner_brdf),
        _tinted(zeltner_albedo_dir),
        fixed={"mode": "zeltner"},
        layerable=True,
        reciprocal=False,
        variants=(
            Variant("Conty-Kulla sheen", _sheen(sheen.conty_kulla_brdf), _tinted(_conty_kulla)),
        ),
    ),
)


def _hair(wo: Array, wi: Array, inputs: Inputs, form: HairForm = TEXT) -> Array:
    values = {name: inputs[name] for name in hair.DEFAULTS if name in inputs}
    return hair.chiang_hair_bcsdf(wo, wi, **values, form=form)


def _albedo(wo: Array, inputs: Inputs, shares: Sequence[Array | float] = (1.0, 1.0, 1.0)) -> Array:
    """Sum of t_p A_p / pi, the integral of the BCSDF over all wi for an untilted cuticle.

    - `shares`: Integrals of M_p N_p of R, TT and TRT, if the cuticle is tilted.
    """
    factors = hair.chiang_hair_attenuation(wo, inputs["ior"], inputs["absorption_coefficient"])
    lobes = enumerate(zip((*TINTS, TINTS[-1]), (*shares, 1.0), strict=True))
    terms = [factors[..., p] * inputs[tint] * share for p, (tint, share) in lobes]
    return sum(terms[1:], terms[0]) / np.pi


def hair_integral(wo: Array, inputs: Inputs) -> Array:
    """Integral of the BCSDF over all wi for any tilt of the cuticle."""
    alpha = np.pi * (inputs["cuticle_angle"] - 0.5)
    if not library(wo) and not np.any(alpha):
        return _albedo(wo, inputs)
    view, _ = hair.section(array_namespace(wo).permute_dims(wo, (1, 0)), inputs["ior"])
    variances = [inputs[name][:, 0] for name in hair.ROUGHNESSES]
    tilted = [hair.tilted_share(view, v, (2.0 - 3.0 * p) * alpha) for p, v in enumerate(variances)]
    return _albedo(wo, inputs, [share[:, np.newaxis] for share in tilted])


def _ggx(wo: Array, inputs: Inputs) -> Array:
    """Albedo of a GGX lobe with mean roughness and tint, as in MaterialX's GLSL environments."""
    alpha = np.mean([inputs[name] for name in hair.ROUGHNESSES], axis=0)
    alpha = np.sqrt(np.clip(alpha, 1e-6, 1.0).prod(axis=-1, keepdims=True))
    tint = np.mean([inputs[name] for name in TINTS], axis=0)
    albedo = dielectric_albedo_dir(wo, 1.0, np.repeat(alpha, 2, axis=-1), inputs["ior"])
    return np.asarray(tint * albedo)


HAIR_NODE = PbrNode(
    "hair",
    "Chiang hair",
    "chiang_hair_bsdf",
    tuple(hair.DEFAULTS),
    _hair,
    _albedo,
    reciprocal=False,
    variants=(
        *(Variant(title, partial(_hair, form=form)) for title, form in FORMS.items()),
        *(
            Variant(title, partial(_hair, form=form), permitted=True)
            for title, form in READINGS.items()
        ),
        Variant("a GGX lobe of the mean roughness and tint, without absorption", albedo=_ggx),
        Variant(
            "no factor 1/pi, as in later versions of the text",
            albedo=lambda wo, i: np.pi * _albedo(wo, i),
            permitted=True,
        ),
    ),
)


STEPS = 32  # integration steps around the circle in MaterialX
FLATTEST = 100.0  # largest radius of the circle in MaterialX
LEAST_RADIUS = 0.1  # smallest radius of the diffusion profile


def circle_blur(mu: Array, radius: Array, body: float = FLATTEST) -> Array:
    """Cosine of the light direction, blurred along a circle as in MaterialX.

    The circle lies in the plane of the light direction and the normal. `mu` (N,) is the cosine,
    `radius` (N, 3) is the mean free path, and `body` is the radius of the circle.
    """
    theta = np.arccos(np.clip(mu, -1.0, 1.0))[:, np.newaxis]
    shape = 1.0 / np.maximum(radius, LEAST_RADIUS)
    turns = -np.pi + (np.arange(STEPS) + 0.5) * 2.0 * np.pi / STEPS
    light, total = np.zeros(radius.shape), np.zeros(radius.shape)
    for turn in turns:
        distance = body * abs(2.0 * np.sin(0.5 * turn))
        profile = (np.exp(-shape * distance) + np.exp(-shape * distance / 3.0)) / distance
        light += profile * np.maximum(np.cos(theta + turn), 0.0)
        total += profile
    return light / total


SUBSURFACE_NODE = PbrNode(
    "subsurface",
    "Subsurface scattering, which is Lambert on a plane",
    "subsurface_bsdf",
    ("color", "radius"),
    lambda wo, wi, inputs: lambert_brdf(wo, wi, inputs["color"]),
    lambda wo, inputs: inputs["color"] + 0.0 * wo[:, :1],
)
