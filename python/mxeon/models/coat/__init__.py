# SPDX-License-Identifier: Apache-2.0
"""EON under the reflection of a dielectric, isotropic: value and albedos.

The dielectric reflects E_r of the light, and EON gets the rest, as `layer` of the specification says:

    f = f_r + (1 - E_r(mu_o)) f_EON,  E = E_r + (1 - E_r) E_EON

E_r, with the energy compensation, is at most the albedo of facets that reflect everything, and so at
most 1. This is no varnish: what EON returns passes freely, while below an interface light is reflected
and refracted on its way out. The albedo is up to 2.2 times that of light that walks below the same
interface, and 1.04 to 1.84 times at index 1.5 and rho 0.2: tools/fits/varnish_walk.py. `varnished` has
both in closed form.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
- `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
- `rho` (..., C): Reflectance of EON per channel, in [0, 1]; a number is one channel.
- `roughness` (...): That of EON, in [0, 1].
- `alpha`: GGX roughness of the dielectric, in [0.01, 1]: one number for all pairs.
- `ior`: Its index of refraction, in [1, 4]: one number for all pairs.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from mxeon.models.coat.curves import clipped, coat_of, of_one_coat, unpack_cosine
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_most
from mxeon.models.core.namespaces import array_namespace, library, like
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.diffuse.albedo import eon_albedo_dir
from mxeon.models.diffuse.brdf import eon_brdf
from mxeon.models.diffuse.formulas import C1, fon_loss
from mxeon.models.microfacet import dielectric_brdf

AVERAGED = 32  # nodes of the average over the viewer's cosine


@of_one_coat
def dielectric_over_eon_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """BRDF of an isotropic `dielectric_bsdf` layered over EON.

        f = f_r + (1 - E_r(mu_o)) f_EON

    Result (..., C): 1/sr. Accuracy: E_r and the energy compensation, which the first call for a
    dielectric tabulates, have an error below 2e-7. The value is not reciprocal, as neither of both
    is. A layer is no varnish: EON's light is not reflected on its way out, and at index 1.5 the
    albedo is up to 1.8 times that of `varnished_brdf` (docs/research.md). [MaterialX2026],
    sections `layer` and Energy Compensation; [Portsmouth2025], Eq. (19).

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> dielectric_over_eon_brdf(wo, wi, [0.7, 0.1], 0.5, 0.3, 1.5).round(5)
        array([0.23317, 0.08236])
    """
    coat = coat_of(alpha, ior)
    bare = dielectric_brdf(wo, wi, 1.0, alpha, ior, compensate=False)
    missing, reflected = (each[..., np.newaxis] for each in coat.at(unpack_cosine(wo)))
    base = eon_brdf(wo, wi, rho, roughness)
    return bare * (1.0 + coat.average * missing) + (1.0 - reflected) * base


@of_one_coat
def dielectric_over_eon_albedo_dir(
    mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Directional albedo of `dielectric_over_eon_brdf`.

        E = E_r + (1 - E_r) E_EON

    Result (..., C): 1 where rho is 1. Accuracy: error below 2e-7.

        >>> dielectric_over_eon_albedo_dir([0.1, 1.0], [0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([[0.7426 , 1.     ],
               [0.68356, 1.     ]])
    """
    base = eon_albedo_dir(mu, rho, roughness)
    height = cast(Array, mu) if library(mu) else np.asarray(mu, np.float64)
    reflected = coat_of(alpha, ior).at(clipped(height))[1][..., np.newaxis]
    return reflected + (1.0 - reflected) * base


@of_one_coat
def dielectric_over_eon_albedo_avg(
    rho: ArrayLike, roughness: ArrayLike, alpha: float, ior: float
) -> Array:
    """Average of `dielectric_over_eon_albedo_dir` over the viewer's directions, weighted by the cosine.

    Result (..., C). Accuracy: error below 2e-7. EON's albedo falls from its value at grazing by
    what FON loses: of the light that the dielectric passes, the mean loss counts.

        >>> dielectric_over_eon_albedo_avg([0.7, 1.0], 0.5, 0.3, 1.5).round(5)
        array([0.69645, 1.     ])
    """
    coat = coat_of(alpha, ior)
    number = coat.alpha
    xp, (x, weight) = array_namespace(number), unit_rule(AVERAGED)
    if library(number):
        x, weight = like(x, cast(Array, number)), like(weight, cast(Array, number))
    extent = xp.asinh(1.0 / number)
    mu = at_most(number * xp.sinh(extent * x**3), 1.0)
    weight = weight * 2.0 * mu * number * xp.cosh(extent * x**3) * extent * 3.0 * x * x
    reflected = coat.at(mu)[1]
    passed = xp.sum(weight * (1.0 - reflected))
    share = xp.sum(weight * (1.0 - reflected) * fon_loss(mu)) / (passed * C1)
    grazing, upright = (eon_albedo_dir(each, rho, roughness) for each in (0.0, 1.0))
    return (1.0 - passed) + passed * (grazing + share * (upright - grazing))
