# SPDX-License-Identifier: Apache-2.0
"""Terms of the microfacet nodes of pbrlib: distribution, masking and shadowing.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x,
  z >= 0; `wh` is the normal of a microfacet.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.

Accuracy: relative error below 2e-14. Raises `ValueError`, which names the first bad element, if an
argument leaves its range or the shapes do not broadcast.
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked, checked_directions, checked_roughness
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.microfacet import ggx_formulas as formulas


@any_array
def ggx_ndf(wh: ArrayLike, roughness: ArrayLike) -> Array:
    """Density D of microfacet normals, anisotropic GGX.

        D = 1 / (pi alpha_x alpha_y ((h_x / alpha_x)^2 + (h_y / alpha_y)^2 + h_z^2)^2)

    Result (...): 1/sr; its integral times h_z over the hemisphere is 1. Where an alpha is 0, D is a
    delta function, which has no value; it counts as 0. [MaterialX2026], GGX Normal Distribution
    Function.

        >>> ggx_ndf([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]], [0.5, 0.25]).round(6)
        array([2.546479, 0.588591])
    """
    vectors = {
        "wh": checked_directions("wh", wh),
        "roughness": checked_roughness(roughness),
    }
    values = evaluate_material(
        lambda wh, roughness: formulas.ndf(wh, roughness)[np.newaxis], vectors, {}, 1
    )
    return values[..., 0][()]


@any_array
def smith_g1(wo: ArrayLike, roughness: ArrayLike) -> Array:
    """Masking G1 of anisotropic GGX: the visible part of the microfacets.

        G1 = 2 mu_o / (mu_o + |(alpha_x x, alpha_y y, z)|)

    Result (...): in [0, 1]; 0 at grazing, but 1 at alpha 0. [Heitz2014], Eqs. (43), (86).

        >>> smith_g1([0.6, 0.0, 0.8], [[0.5, 0.25], [0.0, 0.0]]).round(6)
        array([0.967118, 1.      ])
    """
    vectors = {
        "wo": checked_directions("wo", wo),
        "roughness": checked_roughness(roughness),
    }

    def value(wo: Array, roughness: Array) -> Array:
        length = formulas.stretched_length(wo, roughness)
        masking = 2.0 * wo[2] * formulas.reciprocal(wo[2] + length)
        return array_namespace(wo).where(length > 0.0, masking, 1.0)[np.newaxis]

    return evaluate_material(value, vectors, {}, 1)[..., 0][()]


@any_array
def smith_g2(mu_o: ArrayLike, mu_i: ArrayLike, alpha: ArrayLike) -> Array:
    """Masking and shadowing G2 of the specification, height-correlated Smith.

        G2 = 2 mu_o mu_i / (lambda_o mu_i + lambda_i mu_o),
        lambda = sqrt(alpha^2 + (1 - alpha^2) mu^2)

    - `mu_o`, `mu_i`: Cosines of the polar angles, in [0, 1].
    - `alpha`: In [0, 1]; of anisotropic roughness sqrt(alpha_x alpha_y).

    Result: in [0, 1]; 0 where a direction grazes. [MaterialX2026], Height-Correlated Smith
    Masking-Shadowing.

        >>> smith_g2(0.8, [0.6, 0.0], 0.5).round(6)
        array([0.881115, 0.      ])
    """
    numbers = {
        "mu_o": checked("mu_o", mu_o),
        "mu_i": checked("mu_i", mu_i),
        "alpha": checked("alpha", alpha),
    }

    def value(mu_o: Array, mu_i: Array, alpha: Array) -> Array:
        return (4.0 * mu_o * mu_i * formulas.visibility(mu_o, mu_i, alpha))[np.newaxis]

    return evaluate_material(value, {}, numbers, 1)[..., 0][()]


@any_array
def smith_g2_anisotropic(wo: ArrayLike, wi: ArrayLike, roughness: ArrayLike) -> Array:
    """Masking and shadowing G2 that belongs to anisotropic GGX, height-correlated Smith.

        G2 = 2 mu_o mu_i / (l_o mu_i + l_i mu_o),  l = |(alpha_x x, alpha_y y, z)|

    Result (...): in [0, 1]; 0 where a direction grazes. The specification takes `smith_g2` at
    sqrt(alpha_x alpha_y) instead. Both agree where alpha_x and alpha_y do. [Heitz2014], Eqs. (86),
    (99).

        >>> smith_g2_anisotropic([0.6, 0.0, 0.8], [[0.0, 0.8, 0.6], [1.0, 0.0, 0.0]], [0.5, 0.25]).round(6)
        array([0.942466, 0.      ])
    """
    vectors = {
        "wo": checked_directions("wo", wo),
        "wi": checked_directions("wi", wi),
        "roughness": checked_roughness(roughness),
    }

    def value(wo: Array, wi: Array, roughness: Array) -> Array:
        visibility = formulas.visibility_anisotropic(wo, wi, roughness)
        G2: Array = 4.0 * wo[2] * wi[2] * visibility
        return G2[np.newaxis]

    return evaluate_material(value, vectors, {}, 1)[..., 0][()]
