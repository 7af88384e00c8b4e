# SPDX-License-Identifier: Apache-2.0
"""Diffuse transmission, as in [MaterialX2026], section `translucent_bsdf`."""

from __future__ import annotations

from mxeon.models.core.arguments import checked_transmitted, checked_triples
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.evaluation import evaluate
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.diffuse.formulas import lambert_brdf


@any_array
def translucent_btdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike) -> Array:
    """BTDF of Lambert's transmission.

        f = rho / pi

    - `wo` (..., 3): Direction to the viewer, unit vector to 1e-6, normal +z, z >= 0.
    - `wi` (..., 3): Direction to the light, unit vector to 1e-6, z <= 0.
    - `rho` (..., C): Diffuse transmittance per channel, in [0, 1]; a number is one channel.

    Result (..., C): BTDF in 1/sr. Its integral over the lower hemisphere times |mu_i| is rho.
    Raises `ValueError` if an argument leaves its range. [MaterialX2026], section
    `translucent_bsdf`, Lambertian transmittance equation.

        >>> translucent_btdf([0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.2, 0.8]).round(6)
        array([0.063662, 0.254648])
    """
    light = checked_transmitted("wi", checked_triples("wi", wi))
    xp = array_namespace(light)
    mirrored = xp.stack([light[..., 0], light[..., 1], -light[..., 2]], axis=-1)
    return evaluate(lambert_brdf, wo, mirrored, rho)
