# SPDX-License-Identifier: Apache-2.0
"""Autodesk Standard Surface 1.0.1 by the formulas in the section "Closures".

    coat_layer   = coat f_coat + lerp(1, coat_color (1 - E[f_coat]), coat) (emission + f_mixture)
    f_mixture    = metalness f_metal + (1 - metalness) f_reflection
    f_reflection = s f_specular + (1 - s E[f_specular]) f_transmission,  s = specular specular_color
    f_transmission = transmission transmission_color f_btdf + (1 - transmission) f_sheen_layer
    f_sheen_layer = sheen sheen_color f_sheen + (1 - sheen E[f_sheen]) f_base

The specification does not define how two roughnesses follow from roughness and anisotropy. Here
MaterialX's node `roughness_anisotropy` computes the two roughnesses. Each name in the argument
`but` replaces a formula. [StandardSurface2020].
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.fresnel import artistic_ior, fresnel_dielectric
from mxeon.models.microfacet.ggx import roughness_anisotropy
from mxeon.models.nodes.node import WHITE
from mxeon.models.shading_model import ALONG, UP
from mxeon.models.surfaces import lobes
from mxeon.models.surfaces.lobes import ONES, Frame, Light, Parameters, Values, lerp

FRAME: Values = {"normal": UP, "tangent": ALONG, "coat_normal": UP}
DEFAULTS: Values = {
    "base": 0.8,
    "base_color": WHITE,
    "diffuse_roughness": 0.0,
    "metalness": 0.0,  # default in the reference code; missing from the specification's table
    "specular": 1.0,
    "specular_color": WHITE,
    "specular_roughness": 0.2,
    "specular_IOR": 1.5,
    "specular_anisotropy": 0.0,
    "specular_rotation": 0.0,
    "transmission": 0.0,
    "transmission_color": WHITE,
    "transmission_depth": 0.0,
    "transmission_scatter": (0.0, 0.0, 0.0),
    "transmission_scatter_anisotropy": 0.0,
    "transmission_dispersion": 0.0,
    "transmission_extra_roughness": 0.0,
    "subsurface": 0.0,
    "subsurface_color": WHITE,
    "subsurface_radius": WHITE,
    "subsurface_scale": 1.0,
    "subsurface_anisotropy": 0.0,
    "sheen": 0.8,
    "sheen_color": WHITE,
    "sheen_roughness": 0.3,
    "coat": 0.0,
    "coat_color": WHITE,
    "coat_roughness": 0.1,
    "coat_anisotropy": 0.0,
    "coat_rotation": 0.0,
    "coat_IOR": 1.5,
    "coat_affect_color": 0.0,
    "coat_affect_roughness": 0.0,
    "thin_film_thickness": 0.0,
    "thin_film_IOR": 1.5,
    "emission": 0.0,
    "emission_color": WHITE,
    "opacity": WHITE,
    "thin_walled": False,
}
parameters = partial(lobes.filled, {**DEFAULTS, **FRAME})


def roughened(p: Parameters, roughness: Array) -> Array:
    """Roughness of a lobe below a rough coat."""
    return lerp(roughness, 1.0, p["coat"] * p["coat_affect_roughness"] * p["coat_roughness"])


def alphas(roughness: Array, anisotropy: Array) -> Array:
    rough, stretch = np.broadcast_arrays(roughness[:, 0], anisotropy[:, 0])
    return np.asarray(roughness_anisotropy(rough, stretch))


def surface(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Scattered radiance, (N, 3): f cos(theta_i), or the radiance in a white environment."""
    turn = -2.0 * np.pi if "rotation clockwise" in but else 2.0 * np.pi
    frame = Frame(p["normal"], p["tangent"]).turned(turn * p["specular_rotation"])
    coat_frame = Frame(p["coat_normal"], p["tangent"]).turned(turn * p["coat_rotation"])
    coat, metalness, thin = p["coat"], p["metalness"], p["thin_walled"] != 0.0
    film = {"thinfilm_thickness": p["thin_film_thickness"], "thinfilm_ior": p["thin_film_IOR"]}
    film = film if np.any(p["thin_film_thickness"]) else {}
    alpha = alphas(roughened(p, p["specular_roughness"]), p["specular_anisotropy"])

    color, edge = p["base"] * p["base_color"], p["specular"] * p["specular_color"]
    f_metal = np.zeros(light.wo.shape)
    if np.any(metalness):
        n, k = artistic_ior(*np.broadcast_arrays(color, edge))
        metal = {"ior": n, "extinction": k, "roughness": alpha, **film}
        f_metal = light.response(lobes.CONDUCTOR, frame, **metal)

    gamma = 1.0 + coat * p["coat_affect_color"]
    f_diffuse = p["base"] * light.response(
        lobes.QON, frame, color=p["base_color"] ** gamma, roughness=p["diffuse_roughness"]
    )
    below = p["subsurface_color"] ** gamma
    f_subsurface = np.where(
        thin, light.diffused(below), light.response(lobes.QON, frame, color=below, roughness=0.0)
    )
    f_sheen_layer = lerp(f_diffuse, f_subsurface, p["subsurface"])
    if np.any(p["sheen"]):
        fibers = {"color": ONES, "roughness": p["sheen_roughness"]}
        E_sheen = light.albedo(lobes.CONTY_KULLA, frame, **fibers)
        if "tinted light below the sheen" in but:
            E_sheen = p["sheen_color"] * E_sheen
        f_sheen = p["sheen_color"] * light.response(lobes.CONTY_KULLA, frame, **fibers)
        f_sheen_layer = p["sheen"] * f_sheen + (1.0 - p["sheen"] * E_sheen) * f_sheen_layer

    glass = {"ior": p["specular_IOR"], "roughness": alpha, "tint": ONES}
    f_btdf = light.through(p["transmission_color"])
    if "reflection taken twice" in but:
        rough = np.clip(p["specular_roughness"] + p["transmission_extra_roughness"], 0.0, 1.0)
        wide = {**glass, "roughness": alphas(roughened(p, rough), p["specular_anisotropy"])}
        f_btdf = f_btdf * (1.0 - light.albedo(lobes.DIELECTRIC, frame, **wide))
    f_transmission = lerp(f_sheen_layer, f_btdf, p["transmission"])
    f_specular, E_specular = light.both(lobes.DIELECTRIC, frame, **glass, **film)
    reflected = p["specular"] if "no tint of what specular light leaves" in but else edge
    f_reflection = edge * f_specular + (1.0 - reflected * E_specular) * f_transmission

    f_mixture = lerp(f_reflection, f_metal, metalness)
    if not np.any(coat):
        return f_mixture
    layer = {
        "ior": p["coat_IOR"],
        "roughness": alphas(p["coat_roughness"], p["coat_anisotropy"]),
        "tint": ONES,
    }
    f_coat, E_coat = light.both(lobes.DIELECTRIC, coat_frame, **layer)
    passed = lerp(1.0, p["coat_color"] * (1.0 - E_coat), coat)
    if "a partial coat as a product" in but:
        passed = lerp(1.0, p["coat_color"], coat) * (1.0 - coat * E_coat)
    return coat * f_coat + passed * f_mixture


def emission(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Emitted radiance toward the viewer, (N, 3)."""
    frame = Frame(p["coat_normal"], p["tangent"])
    alpha = alphas(p["coat_roughness"], p["coat_anisotropy"])
    passed = 1.0 - light.albedo(
        lobes.DIELECTRIC, frame, ior=p["coat_IOR"], roughness=alpha, tint=ONES
    )
    mu = light.wo[:, 2:]
    if "Schlick's factor of the coat" in but:
        passed = (1.0 - lobes.f0_from_ior(p["coat_IOR"])) * (1.0 - (1.0 - mu) ** 5)
    if "a Fresnel factor of the coat" in but:
        passed = 1.0 - fresnel_dielectric(mu, p["coat_IOR"])
    emitted = p["emission"] * p["emission_color"]
    return np.broadcast_to(lerp(1.0, p["coat_color"] * passed, p["coat"]) * emitted, light.wo.shape)
