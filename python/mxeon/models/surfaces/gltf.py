# SPDX-License-Identifier: Apache-2.0
"""glTF 2.0's metallic-roughness material with the extensions KHR_materials_*.

    material = mix(dielectric, metal, metallic)
    dielectric = f_specular + (1 - E[f_specular]) mix(f_diffuse, baseColor f_btdf, transmission)
    f = clearcoat f_coat + (1 - clearcoat E[f_coat]) (f_sheen + (1 - max(sheenColor) E_sheen) material)

Specular lobes have a Schlick curve and alpha = roughness^2. The specification permits any layering
operator. Here the operator is albedo scaling. Parameters have the names of MaterialX's node, such
as `base_color` for the specification's `baseColorFactor`. Each name in the argument `but` replaces
a formula. [glTF2021], sections 3.9 and B, and the extensions.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.fresnel import fresnel_schlick
from mxeon.models.nodes.node import BLACK, WHITE
from mxeon.models.shading_model import ALONG, UP
from mxeon.models.surfaces import lobes
from mxeon.models.surfaces.lobes import ONES, Frame, Light, Parameters, Values, lerp

FRAME: Values = {"normal": UP, "tangent": ALONG, "clearcoat_normal": UP}
DEFAULTS: Values = {
    "base_color": WHITE,
    "metallic": 1.0,
    "roughness": 1.0,
    "occlusion": 1.0,
    "transmission": 0.0,
    "specular": 1.0,
    "specular_color": WHITE,
    "ior": 1.5,
    "alpha": 1.0,
    "alpha_mode": 0,
    "alpha_cutoff": 0.5,
    "iridescence": 0.0,
    "iridescence_ior": 1.3,
    "iridescence_thickness": 400.0,
    "sheen_color": BLACK,
    "sheen_roughness": 0.0,
    "clearcoat": 0.0,
    "clearcoat_roughness": 0.0,
    "emissive": BLACK,
    "emissive_strength": 1.0,
    "thickness": 0.0,
    "attenuation_distance": np.inf,
    "attenuation_color": WHITE,
    "anisotropy_strength": 0.0,
    "anisotropy_rotation": 0.0,
    "dispersion": 0.0,
}
parameters = partial(lobes.filled, {**DEFAULTS, **FRAME})
CLEARCOAT_F0 = 0.04


def alphas(p: Parameters) -> Array:
    """alpha along tangent and bitangent, (N, 2). `anisotropy_strength` raises alpha_x."""
    across = np.square(p["roughness"])
    along = lerp(across, 1.0, np.square(p["anisotropy_strength"]))
    return np.concatenate(np.broadcast_arrays(along, across), axis=1)


def surface(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Scattered radiance, (N, 3): f cos(theta_i), or the radiance in a white environment."""
    plain = Frame(p["normal"], p["tangent"])
    sign = -1.0 if "rotation clockwise" in but else 1.0
    frame, alpha = plain.turned(sign * p["anisotropy_rotation"]), alphas(p)
    film = {"thinfilm_thickness": p["iridescence_thickness"], "thinfilm_ior": p["iridescence_ior"]}
    covered = p["iridescence"]

    def reflected(f0: Array, f90: Array) -> tuple[Array, Array]:
        """Values and albedos of a specular lobe. A thin film covers a fraction of the lobe."""
        inputs = lobes.schlick_inputs(f0, f90, alpha)
        f, E = light.both(lobes.SCHLICK, frame, **inputs)
        if not np.any(covered):
            return f, E
        f_wet, E_wet = light.both(lobes.SCHLICK, frame, **inputs, **film)
        return lerp(f, f_wet, covered), lerp(E, E_wet, covered)

    f_metal, _ = reflected(p["base_color"], ONES)
    f0 = np.minimum(lobes.f0_from_ior(p["ior"]) * p["specular_color"], 1.0) * p["specular"]
    f_specular, E_specular = reflected(f0, p["specular"] * ONES)
    f_btdf = light.through(1.0)
    if "reflection taken twice" in but:
        glass = {"ior": p["ior"], "roughness": alpha, "tint": ONES}
        f_btdf = f_btdf * (1.0 - light.albedo(lobes.DIELECTRIC, frame, **glass))
    f_diffuse = light.response(lobes.EON, plain, color=p["base_color"], roughness=0.0)
    below = lerp(f_diffuse, p["base_color"] * f_btdf, p["transmission"])
    material = lerp(f_specular + (1.0 - E_specular) * below, f_metal, p["metallic"])

    intensity = p["sheen_color"].max(axis=1, keepdims=True)
    if np.any(intensity):
        fibers = {"color": ONES, "roughness": np.square(p["sheen_roughness"])}
        share = p["sheen_color"] if "tinted light below the sheen" in but else intensity
        E_sheen = share * light.albedo(lobes.CONTY_KULLA, plain, **fibers)
        f_sheen = p["sheen_color"] * light.response(lobes.CONTY_KULLA, plain, **fibers)
        material = f_sheen + (1.0 - E_sheen) * material
    upper = Frame(p["clearcoat_normal"], p["tangent"])
    rough = np.repeat(np.square(p["clearcoat_roughness"]), 2, axis=1)
    return light.layered(
        lobes.DIELECTRIC, upper, p["clearcoat"], material, ior=1.5, roughness=rough, tint=ONES
    )


def emission(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Emitted radiance toward the viewer, (N, 3), below the clearcoat."""
    emitted = np.broadcast_to(p["emissive"] * p["emissive_strength"], light.wo.shape)
    if "emission above the clearcoat" in but:
        return emitted
    mu = (light.wo * p["clearcoat_normal"]).sum(axis=1)
    f0 = np.full((1, 3), CLEARCOAT_F0)
    return (1.0 - p["clearcoat"] * fresnel_schlick(mu, f0, ONES, ONES, 5.0)) * emitted
