# SPDX-License-Identifier: Apache-2.0
"""OpenPBR Surface 1.1.1 by the equations of the section "Reduction to a mixture of lobes".

    f_surface        = F f_fuzz + lerp(1, 1 - E[white f_fuzz], F) f_coated-base
    f_coated-base    = C f_coat + lerp(1, T_coat (1 - E[f_coat]), C) Delta f_base
    f_base           = lerp(f_dielectric-base, f_conductor, M)
    f_dielectric-base = f_specular + (1 - E[f_specular]) lerp(lerp(f_diffuse, f_SSS, S), f_T, T)

The coat absorbs along the refracted path, T_coat = coat_color^((1/mu_i + 1/mu_o) / 2). The coat
also darkens the base by Delta = (1 - K) / (1 - E_base K), K = lerp(F(mu_o), 1 - (1 - <F>) / eta^2,
r_base), and increases the roughness of the base's lobes to r'^4 = r^4 + 2 r_coat^4. On a plane,
f_SSS is the Lambertian lobe with the specified color. In a rasterizer's environment, f_T is the
fraction `transmission_color` of the light, and T_coat is the coat's color at normal incidence.

Each name in the argument `but` replaces a formula. `mxeon.conformance.specs.surface_texts` states
which of these replacements the specification permits. [OpenPBR2026].
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.fresnel import fresnel_dielectric, fresnel_dielectric_avg
from mxeon.models.shading_model import ALONG, UP
from mxeon.models.surfaces import lobes
from mxeon.models.surfaces.lobes import ONES, Frame, Light, Parameters, Values, lerp

LIGHT_GRAY = (0.8, 0.8, 0.8)
FRAME: Values = {
    "geometry_normal": UP,
    "geometry_tangent": ALONG,
    "geometry_coat_normal": UP,
    "geometry_coat_tangent": ALONG,
}
DEFAULTS: Values = {
    "base_weight": 1.0,
    "base_color": LIGHT_GRAY,
    "base_diffuse_roughness": 0.0,
    "base_metalness": 0.0,
    "specular_weight": 1.0,
    "specular_color": (1.0, 1.0, 1.0),
    "specular_roughness": 0.3,
    "specular_roughness_anisotropy": 0.0,
    "specular_ior": 1.5,
    "transmission_weight": 0.0,
    "transmission_color": (1.0, 1.0, 1.0),
    "transmission_depth": 0.0,
    "transmission_scatter": (0.0, 0.0, 0.0),
    "transmission_scatter_anisotropy": 0.0,
    "transmission_dispersion_scale": 0.0,
    "transmission_dispersion_abbe_number": 20.0,
    "subsurface_weight": 0.0,
    "subsurface_color": LIGHT_GRAY,
    "subsurface_radius": 1.0,
    "subsurface_radius_scale": (1.0, 0.5, 0.25),
    "subsurface_scatter_anisotropy": 0.0,
    "coat_weight": 0.0,
    "coat_color": (1.0, 1.0, 1.0),
    "coat_roughness": 0.0,
    "coat_roughness_anisotropy": 0.0,
    "coat_ior": 1.6,
    "coat_darkening": 1.0,
    "fuzz_weight": 0.0,
    "fuzz_color": (1.0, 1.0, 1.0),
    "fuzz_roughness": 0.5,
    "emission_luminance": 0.0,
    "emission_color": (1.0, 1.0, 1.0),
    "thin_film_weight": 0.0,
    "thin_film_thickness": 0.5,
    "thin_film_ior": 1.4,
    "geometry_opacity": 1.0,
    "geometry_thin_walled": False,
}
MOST_REFLECTIVE = 1.0 - 1e-5  # MaterialX's limit; a reflectance of 1 needs an infinite IOR
parameters = partial(lobes.filled, {**DEFAULTS, **FRAME})


def alphas(roughness: Array, anisotropy: Array) -> Array:
    """alpha along tangent and bitangent, (N, 2). Without a clamp to 1, the mean square is r^4."""
    along = np.square(roughness) * np.sqrt(2.0 / (1.0 + np.square(1.0 - anisotropy)))
    both = np.concatenate([along, (1.0 - anisotropy) * along], axis=-1)
    return np.asarray(np.minimum(both, 1.0))


def base_alphas(p: Parameters) -> Array:
    """alphas of the base. A coat of roughness r_coat raises r^4 to min(1, r^4 + 2 r_coat^4)."""
    r, coat = p["specular_roughness"], p["coat_roughness"]
    rough = np.minimum(1.0, r**4 + 2.0 * coat**4) ** 0.25
    return alphas(lerp(r, rough, p["coat_weight"]), p["specular_roughness_anisotropy"])


def specular_eta(p: Parameters) -> Array:
    """Relative index of refraction of the base. Below a coat, an index less than 1 is inverted."""
    below = p["specular_ior"] / p["coat_ior"]
    return lerp(p["specular_ior"], np.maximum(below, 1.0 / below), p["coat_weight"])


def modulated_eta(p: Parameters) -> Array:
    """Relative index of refraction for the base's reflectance times `specular_weight`."""
    eta = specular_eta(p)
    scaled = np.minimum(p["specular_weight"] * lobes.f0_from_ior(eta), MOST_REFLECTIVE)
    epsilon = np.sign(eta - 1.0) * np.sqrt(scaled)
    return (1.0 + epsilon) / (1.0 - epsilon)


def darkening(light: Light, p: Parameters, but: Collection[str]) -> Array:
    """Factor Delta by which reflections inside the coat darken the base."""
    eta, color = p["coat_ior"], p["base_color"]
    if "the base's albedo without base_weight" not in but:
        color = p["base_weight"] * color
    metal = p["specular_weight"] * color
    dielectric = lerp(color, p["subsurface_color"], p["subsurface_weight"])
    albedo = lerp(dielectric, metal, p["base_metalness"])
    average = fresnel_dielectric_avg(eta)
    if "the Fresnel average at the normal" in but:
        average = lobes.f0_from_ior(eta)
    rough = 1.0 - (1.0 - average) / np.square(eta)
    smooth = fresnel_dielectric(light.wo[:, 2:], eta)
    r = p["specular_roughness"]
    scaled = np.clip(p["specular_weight"] * lobes.f0_from_ior(specular_eta(p)), 0.0, 1.0)
    blur = lerp(lerp(1.0, r, scaled), r, p["base_metalness"])
    K = rough if "a rough base" in but else lerp(smooth, rough, blur)
    factor = (1.0 - K) / (1.0 - albedo * K)
    return lerp(1.0, factor, p["coat_weight"] * p["coat_darkening"])


def coat_transmittance(light: Light, p: Parameters, but: Collection[str]) -> Array:
    """T_coat, the fraction of the light that remains after two passes through the coat's medium."""

    def path(mu: Array) -> Array:
        return 1.0 / np.sqrt(1.0 - (1.0 - np.square(mu)) / np.square(p["coat_ior"]))

    if "absorption at the normal" in but or light.wi is None:
        return np.broadcast_to(p["coat_color"], light.wo.shape)
    return p["coat_color"] ** (0.5 * (path(light.wo[:, 2:]) + path(light.wi[:, 2:])))


def surface(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Scattered radiance, (N, 3): f cos(theta_i), or the radiance in a white environment."""
    frames = Frame(p["geometry_normal"], p["geometry_tangent"])
    coat_frame = Frame(p["geometry_coat_normal"], p["geometry_coat_tangent"])
    F, C, M = p["fuzz_weight"], p["coat_weight"], p["base_metalness"]
    T, S, thin = p["transmission_weight"], p["subsurface_weight"], p["geometry_thin_walled"] != 0.0
    film = {
        "thinfilm_thickness": 1000.0 * p["thin_film_thickness"],
        "thinfilm_ior": p["thin_film_ior"],
    }
    covered = p["thin_film_weight"]

    alpha = base_alphas(p)
    color0 = p["base_weight"] * p["base_color"]
    metal = lobes.schlick_inputs(color0, ONES, alpha, p["specular_color"])
    f_conductor = p["specular_weight"] * light.response(lobes.SCHLICK, frames, **metal)
    if np.any(covered * M):
        wet = p["specular_weight"] * light.response(lobes.SCHLICK, frames, **metal, **film)
        f_conductor = lerp(f_conductor, wet, covered)

    glass = {"ior": modulated_eta(p), "roughness": alpha, "tint": p["specular_color"]}
    f_specular, E_specular = light.response(lobes.DIELECTRIC, frames, **glass), np.zeros(1)
    if np.any(M < 1.0):
        E_specular = light.albedo(lobes.DIELECTRIC, frames, **glass)
        if np.any(covered):
            wet = light.albedo(lobes.DIELECTRIC, frames, **glass, **film)
            E_specular = lerp(E_specular, wet, covered)
            wet = light.response(lobes.DIELECTRIC, frames, **glass, **film)
            f_specular = lerp(f_specular, wet, covered)
        if "no tint of what specular light leaves" in but:
            E_specular = light.albedo(lobes.DIELECTRIC, frames, **{**glass, "tint": ONES})

    f_diffuse = p["base_weight"] * light.response(
        lobes.EON, frames, color=p["base_color"], roughness=p["base_diffuse_roughness"]
    )
    f_subsurface = light.response(lobes.EON, frames, color=p["subsurface_color"], roughness=0.0)
    color, g = p["subsurface_color"], p["subsurface_scatter_anisotropy"]
    shares = [0.5 * (1.0 - g) * np.ones(3), 0.5 * (1.0 + g) * np.ones(3)]
    if "the color twice" in but:
        most = 1.0 if "factors clamped to 1" in but else np.inf
        shares = [0.5 * np.minimum(2.0 * share * color, most) for share in shares]
    diffuse = lobes.QON if "Oren-Nayar without compensation" in but else lobes.EON
    f_wall = light.response(diffuse, frames, color=ONES, roughness=p["base_diffuse_roughness"])
    sheet = color * (shares[0] * f_wall + light.diffused(shares[1]))
    f_subsurface = np.where(thin, sheet, f_subsurface)
    tint = np.where((p["transmission_depth"] > 0.0) & ~thin, ONES, p["transmission_color"])
    if "no color of a thin wall with a depth" in but:
        tint = np.where(p["transmission_depth"] > 0.0, ONES, p["transmission_color"])
    f_transmitted = light.through(tint)
    if "reflection taken twice" in but:
        white = {**glass, "tint": ONES}
        f_transmitted = f_transmitted * (1.0 - light.albedo(lobes.DIELECTRIC, frames, **white))
    f_below = lerp(lerp(f_diffuse, f_subsurface, S), f_transmitted, T)
    f_dielectric = f_specular + (1.0 - E_specular) * f_below

    f_base = lerp(f_dielectric, f_conductor, M)
    if not np.any(C):
        f_coated = f_base
    else:
        coat = {
            "ior": p["coat_ior"],
            "roughness": alphas(p["coat_roughness"], p["coat_roughness_anisotropy"]),
            "tint": ONES,
        }
        f_coat, E_coat = light.both(lobes.DIELECTRIC, coat_frame, **coat)
        T_coat = coat_transmittance(light, p, but)
        passed = lerp(1.0, T_coat * (1.0 - E_coat), C)
        if "a partial coat as a product" in but:
            passed = lerp(1.0, T_coat, C) * (1.0 - C * E_coat)
        f_coated = C * f_coat + passed * darkening(light, p, but) * f_base

    if not np.any(F):
        return f_coated
    normal = lerp(p["geometry_normal"], p["geometry_coat_normal"], C)
    if "the fuzz along geometry_normal" in but:
        normal = p["geometry_normal"]
    fuzz_frame = Frame(normal / np.linalg.norm(normal, axis=1, keepdims=True), lobes.PLAIN.tangent)
    fuzz = {"color": p["fuzz_color"], "roughness": p["fuzz_roughness"]}
    white_fuzz = fuzz if "tinted light below the fuzz" in but else {**fuzz, "color": ONES}
    E_fuzz = light.albedo(lobes.ZELTNER, fuzz_frame, **white_fuzz)
    f_fuzz = light.response(lobes.ZELTNER, fuzz_frame, **fuzz)
    return F * f_fuzz + lerp(1.0, 1.0 - E_fuzz, F) * f_coated


def emission(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Emitted radiance toward the viewer in nits, (N, 3), seen through coat and fuzz."""
    emitted = p["emission_luminance"] * p["emission_color"]
    C, F = p["coat_weight"], p["fuzz_weight"]
    T_coat = np.sqrt(p["coat_color"]) if "the transmittance of one way" in but else p["coat_color"]
    if "a Fresnel factor of the coat" in but:
        T_coat = T_coat * (1.0 - fresnel_dielectric(light.wo[:, 2:], p["coat_ior"]))
    if "Schlick's factor of the coat" in but:
        T_coat = T_coat * (1.0 - lobes.f0_from_ior(p["coat_ior"]))
        T_coat = T_coat * (1.0 - (1.0 - light.wo[:, 2:]) ** 5)
    glow = lerp(1.0, T_coat, C) * emitted
    if "no fuzz above" in but or not np.any(F):
        return np.broadcast_to(glow, light.wo.shape)
    E_fuzz = light.albedo(lobes.ZELTNER, color=ONES, roughness=p["fuzz_roughness"])
    return lerp(1.0, 1.0 - E_fuzz, F) * glow
