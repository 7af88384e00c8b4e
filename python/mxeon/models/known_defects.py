# SPDX-License-Identifier: Apache-2.0
"""Wrong variants of EON and QON that renderers in the field implement, to recognise them by."""

import numpy as np

from mxeon.models import formulas
from mxeon.models.albedo import eon_albedo_dir, fon_albedo_dir, qon_albedo_dir
from mxeon.models.brdf import qon_brdf
from mxeon.models.evaluation import evaluate
from mxeon.models.formulas import cosines


def eon_clamped_brdf(wo, wi, rho, roughness):
    """Reflection of EON with dot(wo, wi) kept above 1e-8 before s is formed.

        s = max(dot(wo, wi), 1e-8) - mu_o mu_i

    Parameters
    ----------
    wo, wi, rho, roughness
        As those of `mxeon.models.eon_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        In 1/sr; too bright where dot(wo, wi) < 0, and right elsewhere.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Notes
    -----
    MaterialX's GLSL node clamps the product, for the needs of other nodes, and passes it on.

    Examples
    --------
    >>> eon_clamped_brdf([0.8, 0.0, 0.6], [-0.8, 0.0, 0.6], [0.2, 0.8], 1.0).round(6)
    array([0.033311, 0.156407])
    """
    return evaluate(_eon_clamped, wo, wi, rho, roughness=roughness)


def eon_rho_cubed_brdf(wo, wi, rho, roughness):
    """Reflection of EON whose multiple-scattering lobe carries rho^3 for rho^2.

    Parameters
    ----------
    wo, wi, rho, roughness
        As those of `mxeon.models.eon_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        In 1/sr; too dark, and right where rho is 0 or 1.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Notes
    -----
    The OSL closure of Blender's Cycles applies its albedo weight to the lobe once too often.

    Examples
    --------
    >>> eon_rho_cubed_brdf([0.8, 0.0, 0.6], [-0.8, 0.0, 0.6], [0.2, 0.8], 1.0).round(6)
    array([0.018131, 0.095069])
    """
    return evaluate(_eon_rho_cubed, wo, wi, rho, roughness=roughness)


def fon_white_lobe_brdf(wo, wi, rho, roughness):
    """Reflection of FON plus the multiple-scattering lobe of a white surface.

    Parameters
    ----------
    wo, wi, rho, roughness
        As those of `mxeon.models.eon_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        In 1/sr; too bright, and right where rho is 1.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Notes
    -----
    The MDL target forgets to tint the lobe: a black surface reflects 0.22 at roughness 1.

    Examples
    --------
    >>> fon_white_lobe_brdf([0.8, 0.0, 0.6], [-0.8, 0.0, 0.6], [0.0, 0.8], 1.0).round(6)
    array([0.048519, 0.119705])
    """
    return evaluate(_fon_white_lobe, wo, wi, rho, roughness=roughness)


def qon_tinted_twice_brdf(wo, wi, rho, sigma):
    """Reflection of QON that is multiplied by its own colour once more.

    Parameters
    ----------
    wo, wi, rho, sigma
        As those of `mxeon.models.qon_brdf`.

    Returns
    -------
    ndarray, shape (..., C), float64
        In 1/sr; too dark, and right where rho is 0 or 1.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Notes
    -----
    OpenPBR's thin-walled lobe in MaterialX 1.39.5, issue 3027 of MaterialX.

    Examples
    --------
    >>> qon_tinted_twice_brdf([0.8, 0.0, 0.6], [0.8, 0.0, 0.6], [0.5, 1.0], 0.0).round(6)
    array([0.079577, 0.31831 ])
    """
    return rho * qon_brdf(wo, wi, rho, sigma)


def qon_tinted_twice_albedo_dir(mu, rho, sigma):
    """Directional albedo of `qon_tinted_twice_brdf`.

    Parameters
    ----------
    mu, rho, sigma
        As those of `mxeon.models.known_defects.qon_fitted_albedo_dir`.

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


def eon_rho_cubed_albedo_dir(mu, rho, roughness):
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
    single = fon_albedo_dir(mu, roughness)[..., np.newaxis]
    return rho * (eon_albedo_dir(mu, rho, roughness) + (1.0 - np.asarray(rho)) * single)


def fon_white_lobe_albedo_dir(mu, rho, roughness):
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


def qon_fitted_albedo_dir(mu, rho, sigma):
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
        Dimensionless; off by up to 0.063 at rho 1.

    Notes
    -----
    Coefficients of MaterialX 1.39.5, `mx_microfacet_diffuse.glsl`.

    Examples
    --------
    >>> qon_fitted_albedo_dir(0.5, [0.5, 1.0], 1.0).round(6)
    array([0.374198, 0.748396])
    """
    mu, sigma = np.asarray(mu), np.asarray(sigma)
    over = 1.0 - 0.4297 * sigma - 0.7632 * mu * sigma + 1.4385 * sigma**2
    under = 1.0 - 0.6076 * sigma - 0.4993 * mu * sigma + 2.0315 * sigma**2
    return (over / under)[..., np.newaxis] * rho


def _eon_clamped(wo, wi, rho, r):
    mu_o, mu_i, s = cosines(wo, wi)
    s = np.maximum(s + mu_o * mu_i, 1e-8) - mu_o * mu_i
    return formulas.eon_of(mu_o, mu_i, s, rho, r, formulas.multiple_weight(rho, r))


def _eon_rho_cubed(wo, wi, rho, r):
    return formulas.eon_of(*cosines(wo, wi), rho, r, rho * formulas.multiple_weight(rho, r))


def _fon_white_lobe(wo, wi, rho, r):
    mu_o, mu_i, _ = cosines(wo, wi)
    lost = formulas.loss(mu_o) * formulas.loss(mu_i)
    white = r / (np.pi * formulas.fon_d(r) * (formulas.C1 - formulas.C2)) * lost
    return formulas.fon(wo, wi, rho, r) + white
