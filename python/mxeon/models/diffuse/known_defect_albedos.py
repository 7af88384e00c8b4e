# SPDX-License-Identifier: Apache-2.0
"""Directional albedos of the wrong variants of models, and wrong albedos of right ones."""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked_colors
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.diffuse import formulas
from mxeon.models.diffuse.albedo import eon_albedo_dir, fon_albedo_dir
from mxeon.models.diffuse.qon_albedo import qon_albedo_dir


def qon_tinted_twice_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of `qon_tinted_twice_brdf`.

    Parameters
    ----------
    mu : array_like, shape (...)
        Cosine of the polar angle, dimensionless, in [0, 1].
    rho : array_like, shape (..., C)
        Reflectance per channel, dimensionless, in [0, 1].
    sigma : array_like, shape (...)
        Slope deviation of the facets, radian, in [0, pi/2].

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless, in [0, 1].

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Examples
    --------
    >>> qon_tinted_twice_albedo_dir(0.5, [0.5, 1.0], 0.0).round(6)
    array([0.25, 1.  ])
    """
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    albedo: Array = np.square(color) * qon_albedo_dir(m, s)
    return albedo


def qon_degrees_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of `qon_degrees_brdf`.

    Errors as those of `qon_tinted_twice_albedo_dir`.
    Result as that of `qon_tinted_twice_albedo_dir`.

    Parameters
    ----------
    mu, rho, sigma
        As those of `qon_tinted_twice_albedo_dir`.

    Examples
    --------
    >>> qon_degrees_albedo_dir(1.0, [0.5, 1.0], 0.0).round(6)
    array([0.5, 1. ])
    """
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    rough = 0.5 * np.pi
    lobe = (qon_albedo_dir(m, rough) - formulas.qon_a(rough)) / formulas.qon_b(rough)
    degrees = np.degrees(s)
    return np.asarray((formulas.qon_a(degrees) + formulas.qon_b(degrees) * lobe) * color)


def eon_rho_cubed_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of `eon_rho_cubed_brdf`.

        E = rho (E_EON + (1 - rho) E_FON)

    Errors as those of `qon_tinted_twice_albedo_dir`.
    Result as that of `qon_tinted_twice_albedo_dir`.

    Parameters
    ----------
    mu, rho, roughness
        As those of `mxeon.albedo.eon_albedo_dir`.

    Examples
    --------
    >>> eon_rho_cubed_albedo_dir(0.5, [0.5, 1.0], 1.0).round(6)
    array([0.447959, 1.      ])
    """
    (color,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    return color * (eon_albedo_dir(mu, rho, roughness) + (1.0 - color) * fon_albedo_dir(m, r))


def fon_white_lobe_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of `fon_white_lobe_brdf`.

        E = 1 - (1 - rho) E_FON

    Errors as those of `qon_tinted_twice_albedo_dir`.

    Parameters
    ----------
    mu, rho, roughness
        As those of `mxeon.albedo.eon_albedo_dir`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless, in [0, 1]; not 0 where rho is 0.

    Examples
    --------
    >>> fon_white_lobe_albedo_dir(1.0, [0.0, 1.0], 1.0).round(6)
    array([0.223478, 1.      ])
    """
    (color,), (m, r) = checked_colors({"rho": rho}, mu=mu, roughness=roughness)
    return 1.0 - (1.0 - color) * fon_albedo_dir(m, r)


def qon_fitted_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of QON as MaterialX fits it: a quotient of polynomials.

    Errors as those of `qon_tinted_twice_albedo_dir`.

    Parameters
    ----------
    mu : array_like, shape (...)
        Cosine of the polar angle, dimensionless, in [0, 1].
    rho : array_like, shape (..., C)
        Reflectance per channel, dimensionless, in [0, 1].
    sigma : array_like, shape (...)
        In radian, in [0, pi/2].

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless, in [0, 1]; off by up to 0.068 at rho 1.

    Notes
    -----
    Coefficients of MaterialX 1.39.5, `mx_microfacet_diffuse.glsl`, which clamps the quotient to 1.

    Examples
    --------
    >>> qon_fitted_albedo_dir(0.5, [0.5, 1.0], 1.0).round(6)
    array([0.374198, 0.748396])
    """
    (color,), (m, s) = checked_colors({"rho": rho}, mu=mu, sigma=sigma)
    over = 1.0 - 0.4297 * s - 0.7632 * m * s + 1.4385 * s**2
    under = 1.0 - 0.6076 * s - 0.4993 * m * s + 2.0315 * s**2
    return np.asarray(np.minimum(over / under, 1.0) * color)
