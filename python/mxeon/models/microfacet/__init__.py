# SPDX-License-Identifier: Apache-2.0
"""BRDF of the microfacet nodes of pbrlib, in 1/sr and without the cosine.

All functions broadcast, work on the closed domain and evaluate in blocks. alpha 0 is a mirror: a
delta function, which has no value; it counts as 0. Where both directions graze the surface the
value grows beyond bounds and counts as 0; value times cosine is 0 there for any finite choice.
The compensation takes (1 - E_ss) / E_ss from a table that the first call computes, to 1e-10; the exact
quadrature is `mxeon.albedo.ggx_albedo_dir`.

In retroreflective mode wo is replaced by its mirror image about the normal.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x, z >= 0.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
- `retroreflective`: Whether light returns towards where it comes from.
- `compensate`: Whether the energy compensation enters; without it the value is reciprocal.

Result (..., C): BRDF in 1/sr, at least 0, unbounded at grazing and as alpha vanishes. Raises
`ValueError`, which names the first bad element, if an argument leaves its range or the shapes do
not broadcast.
"""

from __future__ import annotations

from mxeon.models.core.arguments import checked, checked_switch, checked_vector
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import any_array
from mxeon.models.microfacet.lobe import (
    CONDUCTOR,
    DIELECTRIC,
    SCHLICK,
    Lobe,
    evaluate_lobe,
    uncompensated,
)


@any_array
def dielectric_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    retroreflective: bool = False,
    compensate: bool = True,
) -> Array:
    """Reflection of `dielectric_bsdf`, scatter mode R, with its energy compensation.

        f = tint D F G2 / (4 mu_o mu_i) (1 + F_ss (1 - E_ss) / E_ss)

    - `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
    - `ior` (...): Index of refraction relative to the exterior medium, in [0, 1e50].

    `ior` 0 disables the Fresnel curve, F = 1, which is what the equations give in its limit. Below
    1 light comes from the denser side and F is 1 beyond the critical angle. Of negative numbers the
    specification says nothing, stock MaterialX squares them; here they are refused. Accuracy:
    relative error of the compensation's factor below 1e-10, of the rest 2e-14 at alpha >= 0.05.
    [MaterialX2026], Microfacet BRDF; Energy Compensation; dielectric_bsdf.

        >>> dielectric_brdf([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], 1.0, [0.3, 0.3], 1.5).round(6)
        array([0.060074])
    """
    vectors = {"tint": checked_vector("tint", tint)}
    numbers = {"ior": checked("ior", ior)}

    return evaluate_lobe(
        _lobe(compensate), DIELECTRIC, wo, wi, roughness, vectors, numbers, retroreflective
    )


@any_array
def conductor_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    retroreflective: bool = False,
    compensate: bool = True,
) -> Array:
    """Reflection of `conductor_bsdf` with its energy compensation.

        f = D F G2 / (4 mu_o mu_i) (1 + F_ss (1 - E_ss) / E_ss)

    - `ior`, `extinction` (..., C): Complex index of refraction per channel, in [0, 1e50]; a number
      is one channel.

    [MaterialX2026], Microfacet BRDF; Energy Compensation; conductor_bsdf.

        >>> wo, wi, gold = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], ([0.183, 1.373], [3.424, 1.770])
        >>> conductor_brdf(wo, wi, [0.3, 0.3], *gold).round(6)
        array([1.472308, 0.543655])
    """
    vectors = {
        "ior": checked_vector("ior", ior),
        "extinction": checked_vector("extinction", extinction),
    }

    return evaluate_lobe(
        _lobe(compensate), CONDUCTOR, wo, wi, roughness, vectors, {}, retroreflective
    )


@any_array
def generalized_schlick_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    roughness: ArrayLike,
    exponent: ArrayLike,
    retroreflective: bool = False,
    compensate: bool = True,
) -> Array:
    """Reflection of `generalized_schlick_bsdf`, scatter mode R, with its energy compensation.

        f = D F G2 / (4 mu_o mu_i) (1 + F_ss (1 - E_ss) / E_ss)

    - `color0`, `color82`, `color90` (..., C): Reflectance along the normal, multiplier at
      acos(1/7), and reflectance at grazing, per channel, in [0, 1]; a number is one channel.
    - `exponent` (...): Exponent of the Schlick curve, in [0, 1e50].

    Result (..., C): BRDF in 1/sr, unbounded at grazing and as alpha vanishes; below 0 where the
    curve is. The specification does not clamp the Fresnel curve, and neither does this function:
    see `mxeon.models.fresnel_schlick`. [MaterialX2026], Microfacet BRDF; Energy Compensation;
    generalized_schlick_bsdf.

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> generalized_schlick_brdf(wo, wi, [0.9, 0.2], 0.5, 1.0, [0.3, 0.3], 5.0).round(6)
        array([1.382929, 0.278522])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    vectors = {name: checked_vector(name, value) for name, value in colors.items()}
    numbers = {"exponent": checked("exponent", exponent)}

    return evaluate_lobe(
        _lobe(compensate), SCHLICK, wo, wi, roughness, vectors, numbers, retroreflective
    )


def _lobe(compensate: bool) -> Lobe:
    """The lobe of the specification, with or without its energy compensation."""
    return Lobe() if checked_switch("compensate", compensate) else Lobe(factor=uncompensated)
