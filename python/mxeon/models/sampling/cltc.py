# SPDX-License-Identifier: Apache-2.0
"""Clipped linearly transformed cosines, and the paper's importance sampling of EON with them.

Of the clamped cosine, CLTC keeps only what its matrix maps above the horizon, d x + z >= 0. The
rest has the shape of a lune. See `mxeon.models.sampling.ltc` for the matrix and its density.
"""

import numpy as np

from mxeon.models.sampling.hemisphere import (
    checked_draw,
    checked_pdf,
    numbers,
    uniform_sample,
    vector,
)
from mxeon.models.sampling.ltc import coefficients, density, transformed


def cltc_sample(wo, u, roughness):
    """Direction sampled by the clipped transformed cosine, and its density.

    Parameters
    ----------
    wo : array_like, shape (..., 3)
        Unit vectors on or above the horizon.
    u : array_like, shape (..., 2)
        Independent uniform random numbers, in [0, 1).
    roughness : array_like, shape (...)
        Dimensionless, in [0, 1].

    Returns
    -------
    wi : ndarray, shape (..., 3), float64
        Unit vectors on or above the horizon.
    pdf : ndarray, shape (...), float64
        1/sr.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Notes
    -----
    As a sampler of EON it is biased: `wh` is cut at its own horizon, so directions remain that it
    never draws and that EON reflects into.

    Side of the cut: the lune d x + z < 0 lies at x > 0 where d < 0, as in Listing 3, and at x < 0
    where d > 0. The fitted d is positive for mu_o > 0.99991, and there the listing keeps the
    wrong side; this function keeps the right one.

    References
    ----------
    [Portsmouth2025], Eqs. (26) and (27), Listing 3.

    Examples
    --------
    >>> wi, pdf = cltc_sample([0.6, 0.0, 0.8], [0.25, 0.5], 1.0)
    >>> bool(np.isclose(pdf, cltc_pdf([0.6, 0.0, 0.8], wi, 1.0), rtol=1e-14))
    True
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    matrix = coefficients(wo[..., 2], roughness)
    kept = kept_part(matrix[3])
    wi, pdf = transformed(wo, clipped_cosine(numbers(u), matrix[3], kept), matrix)
    # On the edge of the lune d x + z is zero up to rounding, of either sign.
    wi[..., 2] = np.maximum(wi[..., 2], 0.0)
    return wi, pdf / kept


def cltc_pdf(wo, wi, roughness):
    """Density of `cltc_sample` at `wi`, in solid angle.

    Parameters
    ----------
    wo, wi : array_like, shape (..., 3)
        Unit vectors on or above the horizon.
    roughness : array_like, shape (...)
        Dimensionless, in [0, 1].

    Returns
    -------
    ndarray, shape (...), float64
        1/sr; 0 for the directions that it never draws.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    References
    ----------
    [Portsmouth2025], Eqs. (23), (24) and (27), Listing 3.

    Examples
    --------
    >>> round(float(cltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
    0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    matrix = coefficients(wo[..., 2], roughness)
    pdf = density(wo, wi, matrix)
    return pdf / kept_part(matrix[3])


def eon_cltc_sample(wo, u, roughness):
    """Direction sampled by the paper's mixture of `cltc` and `uniform`, and its density.

    Parameters
    ----------
    wo : array_like, shape (..., 3)
        Unit vectors on or above the horizon.
    u : array_like, shape (..., 2)
        Independent uniform random numbers, in [0, 1).
    roughness : array_like, shape (...)
        Dimensionless, in [0, 1].

    Returns
    -------
    wi : ndarray, shape (..., 3), float64
        Unit vectors on or above the horizon.
    pdf : ndarray, shape (...), float64
        Of the mixture, in 1/sr.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    Notes
    -----
    Listing 4 takes the uniform lobe for u1 <= P_u and divides u1 by P_u: 0/0 at roughness 0 and
    u1 = 0. Here the uniform lobe has u1 < P_u, which a zero P_u never meets.

    References
    ----------
    [Portsmouth2025], Section 4, Listing 4.

    Examples
    --------
    >>> wi, pdf = eon_cltc_sample([0.0, 0.0, 1.0], [0.0, 0.0], 0.0)
    >>> wi, round(float(pdf), 6)
    (array([0., 0., 1.]), 0.31831)
    """
    wo, u, roughness = checked_draw(wo, u, roughness=roughness)
    u1, u2 = numbers(u)
    share = _uniform_share(wo[..., 2], roughness)
    uniform = u1 < share
    # Stretch each side of `share` over [0, 1); rounding may reach 1, which is not in there.
    part = np.where(uniform, u1, u1 - share) / np.where(uniform, share, 1.0 - share)
    again = vector(np.minimum(part, np.nextafter(1.0, 0.0)), u2)
    clipped, _ = cltc_sample(wo, again, roughness)
    wi = np.where(uniform[..., np.newaxis], uniform_sample(again)[0], clipped)
    return wi, eon_cltc_pdf(wo, wi, roughness)


def eon_cltc_pdf(wo, wi, roughness):
    """Density of `eon_cltc_sample` at `wi`, in solid angle.

    Parameters
    ----------
    wo, wi : array_like, shape (..., 3)
        Unit vectors on or above the horizon.
    roughness : array_like, shape (...)
        Dimensionless, in [0, 1].

    Returns
    -------
    ndarray, shape (...), float64
        1/sr.

    Raises
    ------
    ValueError
        If an argument leaves its range; names it and the first bad element.

    References
    ----------
    [Portsmouth2025], Section 4, Listing 4.

    Examples
    --------
    >>> round(float(eon_cltc_pdf([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], 0.0)), 6)
    0.31831
    """
    wo, wi, roughness = checked_pdf(wo, wi, roughness=roughness)
    share = _uniform_share(wo[..., 2], roughness)
    return share * (0.5 / np.pi) + (1.0 - share) * cltc_pdf(wo, wi, roughness)


# [Portsmouth2025], Listing 4: mu and roughness in [0, 1]; the paper states no error.
def _uniform_share(mu, r):
    """Probability P_u with which the mixture draws uniformly."""
    return r**0.1 * (0.162925 + (-0.372058 + (0.538233 - 0.290822 * mu) * mu) * mu)


def kept_part(d):
    """Part of the clamped cosine that is left when the lune d x + z < 0 is cut away."""
    return 0.5 * (1.0 + 1.0 / np.sqrt(1.0 + d * d))


def clipped_cosine(u, d, kept):
    """Directions under a clamped cosine with d x + z >= 0, by [Portsmouth2025], Listing 3."""
    radius, phi = np.sqrt(u[0]), 2.0 * np.pi * u[1]
    x, y = radius * np.cos(phi), radius * np.sin(phi)
    # Squeeze the disk's chord at y onto the part of it that is kept.
    x = np.sqrt(1.0 - y * y) * (1.0 - kept) + x * kept
    x = np.where(d > 0.0, x, -x)
    # Rounding may leave x^2 + y^2 > 1 on the rim.
    return vector(x, y, np.sqrt(np.maximum(1.0 - (x * x + y * y), 0.0)))
