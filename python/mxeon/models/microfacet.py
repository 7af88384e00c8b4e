# SPDX-License-Identifier: Apache-2.0
"""BRDF of the microfacet nodes of pbrlib, in 1/sr and without the cosine.

All functions broadcast, work on the closed domain and evaluate in blocks. alpha 0 is a mirror: a
delta function, which has no value; it counts as 0. Where both directions graze the surface the
value grows beyond bounds and counts as 0; value times cosine is 0 there for any finite choice.

In retroreflective mode wo is replaced by its mirror image about the normal.
"""

from collections.abc import Callable, Mapping

import numpy as np

from mxeon.models import fresnel_formulas as fresnel
from mxeon.models import ggx_formulas as ggx
from mxeon.models.arguments import channel_count, checked, checked_directions, checked_pairs
from mxeon.models.arrays import Array, ArrayLike, Numbers
from mxeon.models.evaluation import evaluate_material
from mxeon.models.ggx_albedo import albedo

# Fresnel reflectance of a cosine, and its average, with the parameters bound.
Fresnel = tuple[Callable[[Array], Array], Callable[[], Array]]


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

    Parameters
    ----------
    wo, wi : array_like, shape (..., 3)
        Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x, z >= 0.
    tint : array_like, shape (..., C)
        Color per channel, dimensionless, in [0, 1]; a number is one channel.
    roughness : array_like, shape (..., 2)
        alpha along tangent and bitangent, dimensionless, in [0, 1].
    ior : array_like, shape (...)
        Index of refraction relative to the exterior medium, in [0, 1e50].
    retroreflective : bool
        Whether light returns towards where it comes from.
    compensate : bool
        Whether the energy compensation enters; without it the value is reciprocal.

    Returns
    -------
    ndarray, shape (..., C), float64
        BRDF in 1/sr, at least 0, unbounded at grazing and as alpha vanishes.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    `ior` 0 disables the Fresnel curve, F = 1, which is what the equations give in its limit. Below 1
    light comes from the denser side and F is 1 beyond the critical angle. Of negative numbers the
    specification says nothing, stock MaterialX squares them; here they are refused.

    References
    ----------
    [MaterialX2026], Microfacet BRDF; Energy Compensation; dielectric_bsdf.

    Examples
    --------
    >>> dielectric_brdf([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], 1.0, [0.3, 0.3], 1.5).round(6)
    array([0.060074])
    """
    vectors = {"tint": np.atleast_1d(checked("tint", tint))}
    numbers = {"ior": checked("ior", ior)}

    def bound(tint: Array, ior: Array) -> Fresnel:
        return (
            lambda c: fresnel.dielectric(c, ior)[np.newaxis],
            lambda: fresnel.dielectric_avg(ior)[np.newaxis],
        )

    return _brdf(wo, wi, roughness, vectors, numbers, bound, retroreflective, compensate)


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

    Parameters
    ----------
    wo, wi : array_like, shape (..., 3)
        Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x, z >= 0.
    roughness : array_like, shape (..., 2)
        alpha along tangent and bitangent, dimensionless, in [0, 1].
    ior, extinction : array_like, shape (..., C)
        Complex index of refraction per channel, in [0, 1e50]; a number is one channel.
    retroreflective : bool
        Whether light returns towards where it comes from.
    compensate : bool
        Whether the energy compensation enters; without it the value is reciprocal.

    Returns
    -------
    ndarray, shape (..., C), float64
        BRDF in 1/sr, at least 0, unbounded at grazing and as alpha vanishes.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    References
    ----------
    [MaterialX2026], Microfacet BRDF; Energy Compensation; conductor_bsdf.

    Examples
    --------
    >>> wo, wi, gold = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], ([0.183, 1.373], [3.424, 1.770])
    >>> conductor_brdf(wo, wi, [0.3, 0.3], *gold).round(6)
    array([1.472308, 0.543655])
    """
    vectors = {
        "ior": np.atleast_1d(checked("ior", ior)),
        "extinction": np.atleast_1d(checked("extinction", extinction)),
    }

    def bound(ior: Array, extinction: Array) -> Fresnel:
        return (
            lambda c: fresnel.conductor(c, ior, extinction),
            lambda: fresnel.conductor_avg(ior, extinction),
        )

    return _brdf(wo, wi, roughness, vectors, {}, bound, retroreflective, compensate)


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

    Parameters
    ----------
    wo, wi : array_like, shape (..., 3)
        Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x, z >= 0.
    color0, color82, color90 : array_like, shape (..., C)
        Reflectance along the normal, multiplier at acos(1/7), and reflectance at grazing, per
        channel, dimensionless, in [0, 1]; a number is one channel.
    roughness : array_like, shape (..., 2)
        alpha along tangent and bitangent, dimensionless, in [0, 1].
    exponent : array_like, shape (...)
        Exponent of the Schlick curve, in [0, 1e50].
    retroreflective : bool
        Whether light returns towards where it comes from.
    compensate : bool
        Whether the energy compensation enters; without it the value is reciprocal.

    Returns
    -------
    ndarray, shape (..., C), float64
        BRDF in 1/sr, unbounded at grazing and as alpha vanishes; below 0 where the curve is.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    The specification does not clamp the Fresnel curve, and neither does this function: see
    `mxeon.models.fresnel_schlick`.

    References
    ----------
    [MaterialX2026], Microfacet BRDF; Energy Compensation; generalized_schlick_bsdf.

    Examples
    --------
    >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
    >>> generalized_schlick_brdf(wo, wi, [0.9, 0.2], 0.5, 1.0, [0.3, 0.3], 5.0).round(6)
    array([1.382929, 0.278522])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    vectors = {name: np.atleast_1d(checked(name, value)) for name, value in colors.items()}
    numbers = {"exponent": checked("exponent", exponent)}

    def bound(color0: Array, color82: Array, color90: Array, exponent: Array) -> Fresnel:
        return (
            lambda c: fresnel.schlick(c, color0, color82, color90, exponent),
            lambda: fresnel.schlick_avg(color0, color82, color90, exponent),
        )

    return _brdf(wo, wi, roughness, vectors, numbers, bound, retroreflective, compensate)


def compensation(mu_o: Array, roughness: Array, F_ss: Array) -> Array:
    """1 + F_ss (1 - E_ss) / E_ss at alpha = sqrt(alpha_x alpha_y): Energy Compensation."""
    E_ss = albedo(mu_o, mean_alpha(roughness))
    return 1.0 + F_ss * ((1.0 - E_ss) / E_ss)


def mean_alpha(roughness: Array) -> Array:
    """alpha = sqrt(alpha_x alpha_y): Height-Correlated Smith Masking-Shadowing."""
    alpha: Array = np.sqrt(roughness[0]) * np.sqrt(roughness[1])
    return alpha


def _brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    roughness: ArrayLike,
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    bound: Callable[..., Fresnel],
    retroreflective: bool,
    compensate: bool,
) -> Array:
    """Microfacet BRDF with the Fresnel curve that `bound` makes of the material's parameters."""
    directions = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    lobe = {"roughness": checked_pairs("roughness", roughness)}
    channels = channel_count(vectors)

    def value(wo: Array, wi: Array, roughness: Array, **material: Array) -> Array:
        if retroreflective:
            wo = np.stack([-wo[0], -wo[1], wo[2]])
        F, F_ss = bound(**material)
        wh, cosine = ggx.half_vector(wo, wi)
        visibility = ggx.visibility(wo[2], wi[2], mean_alpha(roughness))
        f = F(cosine) * (ggx.ndf(wh, roughness) * visibility)
        if compensate:
            f = f * compensation(wo[2], roughness, F_ss())
        return f * material["tint"] if "tint" in material else f

    return evaluate_material(value, directions | lobe | dict(vectors), numbers, channels)
