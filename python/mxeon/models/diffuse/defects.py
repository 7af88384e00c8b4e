# SPDX-License-Identifier: Apache-2.0
"""Wrong variants of diffuse models that renderers implement, and their albedos, to recognize them by."""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked, checked_colors, checked_triples
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, at_most
from mxeon.models.core.evaluation import evaluate
from mxeon.models.diffuse import (
    C1,
    C2,
    burley_brdf,
    eon_albedo_dir,
    eon_brdf_approx_mu,
    eon_brdf_mu,
    eon_multiple_weight,
    fon_a,
    fon_albedo_dir,
    fon_brdf_mu,
    fon_loss_mu,
    fon_quotient,
    fon_scale,
    of_cosines,
    qon_a,
    qon_albedo_dir,
    qon_b,
    qon_brdf,
    qon_brdf_mu,
)

DEGREE = 180.0 / np.pi
FLOOR = 0.1  # least reflectance that Babylon.js passes to EON


@any_array
def eon_clamped_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflection of EON with dot(wo, wi) kept above 1e-8 before s is formed.

        s = max(dot(wo, wi), 1e-8) - mu_o mu_i

    Result (..., C): in 1/sr; too bright where dot(wo, wi) < 0, and correct elsewhere. MaterialX's
    GLSL node clamps the product, for the needs of other nodes, and passes it on.
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
        s = array_namespace(s).maximum(s + mu_o * mu_i, 1e-8) - mu_o * mu_i
        return eon_brdf_mu(mu_o, mu_i, s, rho, roughness)

    return evaluate(of_cosines(formula), wo, wi, rho, roughness=roughness)


@any_array
def burley_cosine_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflection of Burley's diffuse model at roughness^2, multiplied by mu_i.

    Result (..., C): in 1/sr; not reciprocal, and a white surface reflects two thirds of the light.
    LuxCoreRender's disney: `DisneyDiffuse` squares the roughness, and both `Evaluate` and
    `DisneyEvaluate` multiply by the cosine of the light.
    """
    value = burley_brdf(wo, wi, rho, checked("roughness", roughness) ** 2)
    return value * checked_triples("wi", wi)[..., 2:]


@any_array
def burley_schlick_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike
) -> Array:
    """Reflection of Burley's diffuse model with wrong retro-reflection.

        f = rho / pi ((1 - F_o / 2) (1 - F_i / 2) + R (F_o + F_i + F_o F_i (R - 1))),
        R = 1/2 + 2 roughness F_i^2,  F = (1 - mu)^5

    Result (..., C): in 1/sr; not reciprocal. It is Lambert at roughness 0, and Burley where mu_o
    and mu_i are 1. The GLSL of three-gpu-pathtracer. Burley's R is 2 roughness (wi . wh)^2.
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
        F_o, F_i = (1.0 - mu_o) ** 5, (1.0 - mu_i) ** 5
        smooth = (1.0 - 0.5 * F_o) * (1.0 - 0.5 * F_i)
        R = 0.5 + 2.0 * roughness * F_i**2
        return rho / np.pi * (smooth + R * (F_o + F_i + F_o * F_i * (R - 1.0)))

    return evaluate(of_cosines(formula), wo, wi, rho, roughness=roughness)


@any_array
def eon_rho_cubed_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflection of EON whose multiple-scattering lobe carries rho^3 for rho^2.

    Result (..., C): in 1/sr; too dark, and correct where rho is 0 or 1. The OSL closure of
    Blender's Cycles applies its albedo weight to the lobe once too often.
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
        single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s)
        weight = rho * eon_multiple_weight(rho, roughness)
        multi_scatter = weight * (fon_loss_mu(mu_o) * fon_loss_mu(mu_i))
        return fon_scale(rho, roughness) * (single_scatter + multi_scatter)

    return evaluate(of_cosines(formula), wo, wi, rho, roughness=roughness)


@any_array
def fon_white_lobe_brdf(
    wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike
) -> Array:
    """Reflection of FON plus the multiple-scattering lobe of a white surface.

    Result (..., C): in 1/sr; too bright, and correct where rho is 1. The MDL target forgets to tint
    the lobe: a black surface reflects 0.22 at roughness 1.
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
        losses = fon_loss_mu(mu_o) * fon_loss_mu(mu_i)
        white = roughness * fon_a(roughness) / (np.pi * (C1 - C2)) * losses
        return fon_brdf_mu(mu_o, mu_i, s, rho, roughness) + white

    return evaluate(of_cosines(formula), wo, wi, rho, roughness=roughness)


@any_array
def eon_floor_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Reflection of EON whose shape is that of a reflectance of at least 0.1.

        f = rho f_EON(max(rho, 0.1)) / max(rho, 0.1)

    Result (..., C): in 1/sr; too bright where rho lies between 0 and 0.1, and correct elsewhere.
    Babylon.js 9.34.0 divides EON by the reflectance, which it keeps above 0.1; its albedo is the
    paper's quartic.
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, roughness: Array) -> Array:
        floor = array_namespace(rho).maximum(rho, FLOOR)
        return rho / floor * eon_brdf_approx_mu(mu_o, mu_i, s, floor, roughness)

    return evaluate(of_cosines(formula), wo, wi, rho, roughness=roughness)


@any_array
def qon_tinted_twice_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Reflection of QON that is multiplied by its own color once more.

    OpenPBR's thin-walled lobe in MaterialX 1.39.5, issue 3027 of MaterialX.
    """
    value: Array = checked("rho", rho) * qon_brdf(wo, wi, rho, sigma)
    return value


@any_array
def qon_degrees_brdf(wo: ArrayLike, wi: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Reflection of QON that takes the number of degrees for radians.

    `sigma` is in radian, and 180 sigma / pi enters. From a few degrees on it is the limit of large sigma, and correct at
    0. LuxCoreRender's roughmatte: its manual has degrees, its code radians.
    """

    def formula(mu_o: Array, mu_i: Array, s: Array, rho: Array, sigma: Array) -> Array:
        return qon_brdf_mu(mu_o, mu_i, s, rho, DEGREE * sigma)

    return evaluate(of_cosines(formula), wo, wi, rho, sigma=sigma)


@any_array
def qon_tinted_twice_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of `qon_tinted_twice_brdf`."""
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    return color * color * qon_albedo_dir(m, s)


@any_array
def qon_degrees_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of `qon_degrees_brdf`."""
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    rough = 0.5 * np.pi
    lobe = (qon_albedo_dir(m, rough) - qon_a(rough)) / qon_b(rough)
    return (qon_a(DEGREE * s) + qon_b(DEGREE * s) * lobe) * color


@any_array
def eon_rho_cubed_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of `eon_rho_cubed_brdf`.

    E = rho (E_EON + (1 - rho) E_FON)
    """
    (color,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    return color * (eon_albedo_dir(mu, rho, roughness) + (1.0 - color) * fon_albedo_dir(m, r))


@any_array
def fon_white_lobe_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of `fon_white_lobe_brdf`.

        E = 1 - (1 - rho) E_FON

    Result (..., C): in [0, 1]; not 0 where rho is 0.
    """
    (color,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    return 1.0 - (1.0 - color) * fon_albedo_dir(m, r)


@any_array
def qon_fitted_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of QON as MaterialX fits it: a quotient of polynomials.

    It is off by up to 0.068 at rho 1. Coefficients of MaterialX 1.39.5,
    `mx_microfacet_diffuse.glsl`, which clamps the quotient to 1.
    """
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    over = 1.0 - 0.4297 * s - 0.7632 * m * s + 1.4385 * s**2
    under = 1.0 - 0.6076 * s - 0.4993 * m * s + 2.0315 * s**2
    return at_most(over / under, 1.0) * color
