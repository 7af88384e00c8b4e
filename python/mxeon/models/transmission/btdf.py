# SPDX-License-Identifier: Apache-2.0
"""BTDF of the microfacet nodes of pbrlib, in 1/sr and without the cosine.

wo lies above the surface and wi below it. Indices of refraction are those below relative to those
above: a view from inside a solid has the inverse of the node's index. alpha 0 is a delta function,
which has no value; it counts as 0, and so does an index of 1, which bends nothing.

Two forms differ by the square of the index. Radiance is scaled as light enters another medium; light
that is counted in energy, or paths that are traced from the view, are not.
"""

from __future__ import annotations

from collections.abc import Callable

from mxeon.models.core.arguments import (
    checked,
    checked_directions,
    checked_roughness,
    checked_switch,
    checked_transmitted,
    checked_vector,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.edges import guarded, least_normal
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import channel_count
from mxeon.models.microfacet import ggx_formulas as ggx
from mxeon.models.microfacet.lobe import DIELECTRIC
from mxeon.models.transmission.refraction import LEAST, Facet


@any_array
def dielectric_btdf(
    wo: ArrayLike,
    wi: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    radiance: bool = True,
) -> Array:
    """Transmission of `dielectric_bsdf`, scatter modes T and RT.

        f = tint |wo . wh| |wi . wh| (1 - F) D G2 / (mu_o |mu_i| (wo . wh + ior wi . wh)^2)

    - `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z,
      tangent +x; wo has z >= 0, wi has z <= 0.
    - `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
    - `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is
      isotropic.
    - `ior` (...): Index of refraction of the side of wi relative to that of wo, in [0, 1e50].
    - `radiance`: Whether the value is of radiance from wi to wo, as the specification has it; else
      it is times ior^2, the form that is integrated over wi to the transmitted share of the light
      from wo.

    Result (..., C): BTDF in 1/sr, at least 0, unbounded at grazing and as alpha vanishes. `ior` 0
    disables the Fresnel curve: F is 1, and nothing passes. The specification does not say that the
    two directions lie on either side of the microfacet, [Walter2007] does; without that condition
    light passes between directions that no facet joins. Raises `ValueError` if an argument leaves
    its range. [MaterialX2026], Microfacet BTDF; dielectric_bsdf; [Walter2007], Eq. (21).

        >>> from mxeon.models.transmission.refraction import refraction_direction
        >>> wo = [0.6, 0.0, 0.8]
        >>> wi = refraction_direction(wo, [0.0, 0.0, 1.0], 1.5)
        >>> dielectric_btdf(wo, wi, 1.0, [0.3, 0.3], 1.5).round(6)
        array([10.066984])
    """
    vectors = {"tint": checked_vector("tint", tint)}
    return evaluate_btdf(DIELECTRIC.at, wo, wi, roughness, ior, vectors, {}, radiance=radiance)


def evaluate_btdf(
    at: Callable[..., Array],
    wo: ArrayLike,
    wi: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    vectors: dict[str, Numbers],
    numbers: dict[str, Numbers],
    *,
    radiance: bool = True,
    anywhere: bool = False,
) -> Array:
    """Values of a BTDF, shape (..., C); `vectors` and `numbers` are checked inputs of the curve.

    - `at`: `at(cosine, ior=ior, **material)`, shape (C, ...): F at the cosine on the side of wo.
    - `anywhere`: Whether directions count that lie on one side of the microfacet.
    """
    directions = {"wo": checked_directions("wo", wo), "wi": checked_transmitted("wi", wi)}
    pairs = {"roughness": checked_roughness(roughness)}
    checked_switch("radiance", radiance)
    checked_switch("anywhere", anywhere)

    def value(wo: Array, wi: Array, roughness: Array, ior: Array, **material: Array) -> Array:
        facet = Facet.of(wo, wi, ior, anywhere)
        F = at(facet.cosine_o, ior=ior, **material)
        G2 = ggx.visibility(wo[2], -wi[2], ggx.mean_alpha(roughness))
        lobe = ggx.ndf(facet.normal, roughness) * G2
        if radiance:
            bends = ior > max(LEAST, least_normal(wo))  # nothing passes an index of 0
            lobe = lobe / guarded(array_namespace(ior).maximum(ior, LEAST), bends, 1.0) ** 2
        f = (1.0 - F) * (4.0 * lobe * facet.cosine_o * facet.jacobian)
        return f * material["tint"] if "tint" in material else f

    return evaluate_material(
        value,
        directions | pairs | vectors,
        {"ior": checked("ior", ior), **numbers},
        channel_count(vectors),
    )
