# SPDX-License-Identifier: Apache-2.0
"""OpenPBR's base: a metal and a dielectric over EON, mixed, whose facets have one roughness.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
- `rho` (..., C): `base_color` per channel, of the metal too, in [0, 1]; a number is one channel.
- `roughness` (...): `base_diffuse_roughness`, that of EON, in [0, 1].
- `specular_roughness`: Root of alpha of all facets, in [0.1, 1]: one number for all pairs.
- `specular_ior`: That of the dielectric, in [1, 4]: one number for all pairs.
- `metalness` (...): `base_metalness`, m above, in [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from mxeon.models.coat import dielectric_over_eon_albedo_dir, dielectric_over_eon_brdf
from mxeon.models.coat.curves import (
    checked_scalar,
    clipped,
    coat_of,
    of_one_coat,
    unpack_cosine,
)
from mxeon.models.core.arguments import (
    checked,
    checked_color,
    checked_colors,
    checked_directions,
)
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import any_array
from mxeon.models.core.shapes import lead_shape
from mxeon.models.microfacet import generalized_schlick_brdf
from mxeon.models.microfacet.fresnel import fresnel_schlick_avg

EDGE = 1.0, 1.0, 5.0  # color82, color90 and exponent of the metal's curve


@of_one_coat
def openpbr_base_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    specular_roughness: float,
    specular_ior: float,
    metalness: ArrayLike,
) -> Array:
    """BRDF of OpenPBR's base: a metal and a dielectric over EON, mixed.

        f = (1 - m) f_dielectric_over_eon + m f_metal

    Result (..., C): 1/sr. The weights and `specular_color` are 1, and nothing is anisotropic,
    transmits or scatters below the surface. The metal's curve is Schlick's. Accuracy: that of
    `dielectric_over_eon_brdf`. [MaterialX2026], sections `layer`, `mix` and Energy Compensation;
    [Portsmouth2025], Eq. (19).

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> openpbr_base_brdf(wo, wi, [0.7, 0.1], 0.5, 0.5, 1.5, 0.25).round(5)
        array([0.56487, 0.13156])
    """
    share = _share(wo, wi, rho, roughness, metalness)
    alpha = _alpha(specular_roughness, specular_ior)
    missing = coat_of(alpha, specular_ior).at(unpack_cosine(wo))[0][..., np.newaxis]
    metal = generalized_schlick_brdf(wo, wi, rho, *EDGE[:2], alpha, EDGE[2], compensate=False)
    metal = metal * (1.0 + fresnel_schlick_avg(rho, *EDGE) * missing)
    glossy = dielectric_over_eon_brdf(wo, wi, rho, roughness, alpha, specular_ior)
    return (1.0 - share) * glossy + share * metal


@of_one_coat
def openpbr_base_albedo_dir(
    mu: ArrayLike,
    rho: ArrayLike,
    roughness: ArrayLike,
    specular_roughness: float,
    specular_ior: float,
    metalness: ArrayLike,
) -> Array:
    """Directional albedo of `openpbr_base_brdf`.

        E = (1 - m) E_dielectric_over_eon + m (rho E_ss + (1 - rho) W) (1 + F_ss (1 - E_ss) / E_ss)

    W is the facets' mean of (1 - c)^5.

    Result (..., C): 1 where rho is 1. Accuracy: error below 2e-7.

        >>> openpbr_base_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.5, 1.5, 0.25).round(5)
        array([[0.74305, 1.     ],
               [0.68378, 1.     ]])
    """
    cosine, color, share = _albedo_inputs(mu, rho, roughness, metalness)
    alpha = _alpha(specular_roughness, specular_ior)
    glossy = dielectric_over_eon_albedo_dir(mu, rho, roughness, alpha, specular_ior)
    coat = coat_of(alpha, specular_ior)
    missing, edge = coat.at(cosine)[0], coat.edge_at(cosine)
    metal = color / (1.0 + missing) + (1.0 - color) * edge
    metal = metal * (1.0 + fresnel_schlick_avg(rho, *EDGE) * missing)
    return (1.0 - share) * glossy + share * metal


@any_array
def _alpha(specular_roughness: ArrayLike, specular_ior: ArrayLike) -> float:
    """alpha of the facets; raise ValueError unless both numbers are in their ranges."""
    checked_scalar("specular_ior", specular_ior)
    return cast(float, checked_scalar("specular_roughness", specular_roughness) ** 2)


@any_array
def _share(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, metalness: ArrayLike
) -> Array:
    """Share of the metal, (..., 1); raise ValueError unless all arguments broadcast."""
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    numbers = {
        "roughness": checked("roughness", roughness),
        "metalness": checked("metalness", metalness),
    }
    lead_shape(vectors | {"rho": checked_color("rho", rho)}, numbers)
    return numbers["metalness"][..., np.newaxis]


@any_array
def _albedo_inputs(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, metalness: ArrayLike
) -> tuple[Array, Array, Array]:
    """The viewer's cosine, the color, and the share of the metal, checked, with an axis for channels."""
    numbers = {"mu": mu, "roughness": roughness, "metalness": metalness}
    (color,), (cosine, _, share) = checked_colors({"rho": rho}, **numbers)
    return clipped(cosine), color, share
