# SPDX-License-Identifier: Apache-2.0
"""UsdPreviewSurface 2.5.

    f = clearcoat f_coat + (1 - clearcoat E[f_coat]) (f_specular + (1 - E[f_specular]) f_below)
    f_below = lerp(transparent, diffuse_weight f_diffuse, opacity)

The reflectance of the specular workflow is `specularColor` at normal incidence and white at grazing
incidence. The metalness workflow blends the reflectance with `diffuseColor`. Without metalness, the
reflectance is ((1 - ior) / (1 + ior))^2 at normal incidence and white at grazing incidence. The
specification does not define layering; here layering is albedo scaling. Each name in the argument
`but` replaces a formula. [UsdPreviewSurface2019].
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.microfacet.fresnel import artistic_ior
from mxeon.models.nodes.node import BLACK, GRAY
from mxeon.models.shading_model import UP
from mxeon.models.surfaces import lobes
from mxeon.models.surfaces.lobes import ONES, Frame, Light, Parameters, Values, lerp

FRAME: Values = {"normal": UP}
DEFAULTS: Values = {
    "diffuseColor": GRAY,
    "emissiveColor": BLACK,
    "useSpecularWorkflow": 0,
    "specularColor": BLACK,
    "metallic": 0.0,
    "roughness": 0.5,
    "clearcoat": 0.0,
    "clearcoatRoughness": 0.01,
    "opacity": 1.0,
    "opacityThreshold": 0.0,
    "ior": 1.5,
    "displacement": 0.0,
    "occlusion": 1.0,
}
parameters = partial(lobes.filled, {**DEFAULTS, **FRAME})


def surface(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Scattered radiance, (N, 3): f cos(theta_i), or the radiance in a white environment."""
    frame = Frame(p["normal"], np.array([[1.0, 0.0, 0.0]]))
    alpha = np.repeat(np.square(p["roughness"]), 2, axis=1)
    metallic, color, specular = p["metallic"], p["diffuseColor"], p["useSpecularWorkflow"] != 0.0
    r0 = lobes.f0_from_ior(p["ior"])
    diffuse = np.where(specular, 1.0, 1.0 - metallic)
    opacity = np.where(p["opacityThreshold"] > 0.0, 1.0, p["opacity"])
    f_clear = light.through(1.0)
    if "reflection taken twice" in but:
        glass = {"ior": p["ior"], "roughness": np.zeros((1, 2)), "tint": ONES}
        f_clear = f_clear * (1.0 - light.albedo(lobes.DIELECTRIC, frame, **glass))
    f_below = lerp(
        f_clear, diffuse * light.response(lobes.EON, frame, color=color, roughness=0.0), opacity
    )

    def over(f0: Array, f90: Array) -> Array:
        """A specular lobe layered over `f_below`."""
        inputs = lobes.schlick_inputs(f0, f90, alpha)
        return light.layered(lobes.SCHLICK, frame, 1.0, f_below, **inputs)

    f90 = lerp(ONES, color, metallic)
    if "metal by artist-friendly indices" in but:
        n, k = artistic_ior(color, color)
        f_metal = light.response(lobes.CONDUCTOR, frame, ior=n, extinction=k, roughness=alpha)
        f_metalness = lerp(over(lerp(f90 * r0, f90, metallic), f90), f_metal, metallic)
    else:
        f_metalness = over(lerp(r0, color, metallic), f90)
    f_base = np.where(specular, over(p["specularColor"], ONES), f_metalness)
    rough = np.repeat(np.square(p["clearcoatRoughness"]), 2, axis=1)
    coat = lobes.schlick_inputs(r0 * ONES, ONES, rough)
    return light.layered(lobes.SCHLICK, frame, p["clearcoat"], f_base, **coat)


def emission(light: Light, p: Parameters, but: Collection[str] = ()) -> Array:
    """Emitted radiance toward the viewer, (N, 3)."""
    return np.broadcast_to(p["emissiveColor"], light.wo.shape)
