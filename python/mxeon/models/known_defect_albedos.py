# SPDX-License-Identifier: Apache-2.0
"""Directional albedos of the wrong variants of models, and wrong albedos of right ones."""

import numpy as np

from mxeon.models import formulas
from mxeon.models.albedo import eon_albedo_dir, fon_albedo_dir, qon_albedo_dir
from mxeon.models.arrays import Array, ArrayLike


def qon_tinted_twice_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of `qon_tinted_twice_brdf`.

    Parameters
    ----------
    mu, rho, sigma
        As those of `mxeon.models.known_defect_albedos.qon_fitted_albedo_dir`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless, in [0, 1].

    Examples
    --------
    >>> qon_tinted_twice_albedo_dir(0.5, [0.5, 1.0], 0.0).round(6)
    array([0.25, 1.  ])
    """
    return np.square(rho) * qon_albedo_dir(mu, sigma)[..., np.newaxis]


def qon_degrees_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of `qon_degrees_brdf`.

    Parameters
    ----------
    mu, rho, sigma
        As those of `mxeon.models.known_defect_albedos.qon_fitted_albedo_dir`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless, in [0, 1].

    Examples
    --------
    >>> qon_degrees_albedo_dir(1.0, [0.5, 1.0], 0.0).round(6)
    array([0.5, 1. ])
    """
    rough = 0.5 * np.pi
    lobe = (qon_albedo_dir(mu, rough) - formulas.qon_a(rough)) / formulas.qon_b(rough)
    sigma = np.degrees(np.asarray(sigma, np.float64))
    white: Array = np.asarray(formulas.qon_a(sigma) + formulas.qon_b(sigma) * lobe)
    return white[..., np.newaxis] * np.asarray(rho, np.float64)


def eon_rho_cubed_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of `eon_rho_cubed_brdf`.

        E = rho (E_EON + (1 - rho) E_FON)

    Parameters
    ----------
    mu, rho, roughness
        As those of `mxeon.albedo.eon_albedo_dir`.

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
    >>> eon_rho_cubed_albedo_dir(0.5, [0.5, 1.0], 1.0).round(6)
    array([0.447959, 1.      ])
    """
    fon = fon_albedo_dir(mu, roughness)[..., np.newaxis]
    return np.asarray(rho) * (eon_albedo_dir(mu, rho, roughness) + (1.0 - np.asarray(rho)) * fon)


def fon_white_lobe_albedo_dir(mu: ArrayLike, rho: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of `fon_white_lobe_brdf`.

        E = 1 - (1 - rho) E_FON

    Parameters
    ----------
    mu, rho, roughness
        As those of `mxeon.albedo.eon_albedo_dir`.

    Returns
    -------
    ndarray, shape (..., C), float64
        Dimensionless, in [0, 1]; not 0 where rho is 0.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Examples
    --------
    >>> fon_white_lobe_albedo_dir(1.0, [0.0, 1.0], 1.0).round(6)
    array([0.223478, 1.      ])
    """
    return 1.0 - (1.0 - np.asarray(rho)) * fon_albedo_dir(mu, roughness)[..., np.newaxis]


def qon_fitted_albedo_dir(mu: ArrayLike, rho: ArrayLike, sigma: ArrayLike) -> Array:
    """Directional albedo of QON as MaterialX fits it: a quotient of polynomials.

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
    mu, sigma = np.asarray(mu, np.float64), np.asarray(sigma, np.float64)
    over = 1.0 - 0.4297 * sigma - 0.7632 * mu * sigma + 1.4385 * sigma**2
    under = 1.0 - 0.6076 * sigma - 0.4993 * mu * sigma + 2.0315 * sigma**2
    white: Array = np.minimum(over / under, 1.0)
    return white[..., np.newaxis] * np.asarray(rho, np.float64)
