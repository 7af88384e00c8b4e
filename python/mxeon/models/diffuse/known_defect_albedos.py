# SPDX-License-Identifier: Apache-2.0
"""Directional albedos of the wrong variants of models, and wrong albedos of right ones."""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_colors
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.edges import at_most
from mxeon.models.core.namespaces import any_array
from mxeon.models.diffuse import formulas
from mxeon.models.diffuse.albedo import eon_albedo_dir, fon_albedo_dir
from mxeon.models.diffuse.qon_albedo import qon_albedo_dir


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
    lobe = (qon_albedo_dir(m, rough) - formulas.qon_a(rough)) / formulas.qon_b(rough)
    degrees = 180.0 / np.pi * s
    return (formulas.qon_a(degrees) + formulas.qon_b(degrees) * lobe) * color


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
