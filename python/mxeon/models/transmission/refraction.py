# SPDX-License-Identifier: Apache-2.0
"""Geometry of refraction at a surface or a microfacet.

An index of refraction is that of the far side relative to the side of the first direction.
"""

from __future__ import annotations

from mxeon.models.core.arguments import checked, checked_directions, checked_transmitted
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import guarded, least_normal, root, trimmed
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, array_namespace

LEAST = 1e-50  # index below which all light counts as reflected; its square divides


@any_array
def refraction_direction(wo: ArrayLike, normal: ArrayLike, ior: ArrayLike) -> Array:
    """Direction on the far side into which light along `wo` is refracted, and that refracts into it.

        cos_t = sqrt(1 - (1 - cos_o^2) / ior^2),  wi = -wo / ior + (cos_o / ior - cos_t) normal

    - `wo` (..., 3): Direction that leaves the surface, unit vector to 1e-6, normal +z, z >= 0.
    - `normal` (..., 3): Normal of the surface or microfacet, unit vector to 1e-6, z >= 0.
    - `ior` (...): Index of the far side relative to that of wo, in [0, 1e50].

    Result (..., 3): Unit vectors; (0, 0, 0) at total internal reflection, and where wo lies behind
    the normal. [MaterialX2026], Reflection and Transmission; [Walter2007], Eq. (40).

        >>> refraction_direction([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], [1.5, 0.5]).round(6)
        array([[-0.4     , -0.      , -0.916515],
               [ 0.      ,  0.      ,  0.      ]])
    """
    vectors = {"wo": checked_directions("wo", wo), "normal": checked_directions("normal", normal)}
    return evaluate_material(refracted, vectors, {"ior": checked("ior", ior)}, 3)


@any_array
def transmission_half_vector(wo: ArrayLike, wi: ArrayLike, ior: ArrayLike) -> Array:
    """Normal of the microfacet that refracts one direction into the other.

        wh = +-(wo + ior wi) / |wo + ior wi|, on the side of wo

    - `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z; wo
      has z >= 0, wi z <= 0.
    - `ior` (...): Index of the side of wi relative to that of wo, in [0, 1e50].

    Result (..., 3): Unit vectors; (0, 0, 0) where no microfacet refracts one into the other. The
    sign of the specification's vector points into the side of the smaller index, which no term of
    its BTDF tells apart. Where both directions lie on one side of the vector no facet joins them.
    [MaterialX2026], Microfacet BTDF; [Walter2007], Eq. (16).

        >>> wi = refraction_direction([0.6, 0.0, 0.8], [0.0, 0.6, 0.8], 1.5)
        >>> transmission_half_vector([0.6, 0.0, 0.8], wi, 1.5).round(6)
        array([-0. ,  0.6,  0.8])
    """
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_transmitted("wi", wi)}
    numbers = {"ior": checked("ior", ior)}
    return evaluate_material(lambda wo, wi, ior: Facet.of(wo, wi, ior).normal, vectors, numbers, 3)


def refracted(wo: Array, normal: Array, ior: Array) -> Array:
    """`refraction_direction` on float64 arrays, components first."""
    xp = array_namespace(wo, normal, ior)
    bends = ior > max(LEAST, least_normal(wo))
    inverse = 1.0 / guarded(xp.maximum(ior, LEAST), bends, 1.0)
    cosine = xp.sum(wo * normal, axis=0)
    squared = 1.0 - inverse * inverse * (1.0 - cosine) * (1.0 + cosine)
    passes = (squared > 0.0) & (cosine > 0.0) & bends
    scale = inverse * cosine - root(xp.maximum(squared, 0.0))
    wi = scale * normal - inverse * wo
    return xp.where(passes, wi, 0.0)


class Facet:
    """The microfacet between directions on either side of it, on float64 arrays, components first.

    - `normal`: Unit vector on the side of wo; 0 where there is no such facet.
    - `cosine_o`, `cosine_i`: |wo . wh| and |wi . wh|; 0 where there is none.
    - `jacobian`: |d wh / d wi|, the solid angle of normals for that of wi.
    """

    def __init__(self, normal: Array, cosine_o: Array, cosine_i: Array, jacobian: Array) -> None:
        self.normal, self.cosine_o, self.cosine_i = normal, cosine_o, cosine_i
        self.jacobian = jacobian

    @classmethod
    def of(cls, wo: Array, wi: Array, ior: Array, anywhere: bool = False) -> Facet:
        """The facet between wo and wi; `anywhere` keeps vectors with both directions on one side.

        |wo + n wi|^2 (d wh / d wi) = n^2 |wi . wh|: [Walter2007], Eq. (17).
        """
        xp = array_namespace(wo, wi, ior)
        total = wo + ior * wi
        length = root(xp.sum(total * total, axis=0))
        side_o, side_i = xp.sum(wo * total, axis=0), xp.sum(wi * total, axis=0)
        real = (length > 0.0) & (anywhere | ((side_o * side_i < 0.0) & (side_o * total[2] > 0.0)))
        scale = xp.where(real, 1.0, 0.0) / xp.where(length > 0.0, length, 1.0)
        normal = total * (scale * xp.where(total[2] < 0.0, -1.0, 1.0))
        cosine_o, cosine_i = (trimmed(xp.abs(side) * scale, 1.0) for side in (side_o, side_i))
        return cls(normal, cosine_o, cosine_i, (ior * scale) ** 2 * cosine_i)
