# SPDX-License-Identifier: Apache-2.0
"""Sampling of the hemisphere that knows no material, and the frame turned towards wo.

Directions leave the surface, local frame with the normal +z. Random numbers `u` lie in [0, 1).
"""

import numpy as np

from mxeon.models.arguments import checked, checked_directions, lead_shape


def uniform_sample(u):
    """Direction sampled uniformly on the hemisphere, and its density.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        Independent uniform random numbers, in [0, 1).

    Returns
    -------
    wi : ndarray, shape (..., 3), float64
        Unit vectors, z = u[..., 0].
    pdf : ndarray, shape (...), float64
        1/(2 pi), in 1/sr.

    Raises
    ------
    ValueError
        If `u` leaves its range or its last axis is not 2; names the first bad element.

    References
    ----------
    [Portsmouth2025], Listing 4.

    Examples
    --------
    >>> wi, pdf = uniform_sample([0.8, 0.0])
    >>> wi.round(12), round(float(pdf), 6)
    (array([0.6, 0. , 0.8]), 0.159155)
    """
    u1, u2 = numbers(u)
    wi = direction(np.sqrt((1.0 - u1) * (1.0 + u1)), 2.0 * np.pi * u2, u1)
    return wi, uniform_density(wi)


def uniform_pdf(wi):
    """Density of `uniform_sample` at `wi`, in solid angle.

    Parameters
    ----------
    wi : array_like, shape (..., 3)
        Unit vectors on or above the horizon.

    Returns
    -------
    ndarray, shape (...), float64
        1/(2 pi), in 1/sr.

    Raises
    ------
    ValueError
        If a direction is not unit or points below the horizon; names the first such element.

    Examples
    --------
    >>> round(float(uniform_pdf([0.0, 0.6, 0.8])), 6)
    0.159155
    """
    return uniform_density(checked_directions("wi", wi))


def cosine_sample(u):
    """Direction sampled proportionally to its cosine with the normal, and its density.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        Independent uniform random numbers, in [0, 1).

    Returns
    -------
    wi : ndarray, shape (..., 3), float64
        Unit vectors, z > 0.
    pdf : ndarray, shape (...), float64
        z / pi, in 1/sr.

    Raises
    ------
    ValueError
        If `u` leaves its range or its last axis is not 2; names the first bad element.

    References
    ----------
    [Portsmouth2025], Eq. (21).

    Examples
    --------
    >>> wi, pdf = cosine_sample([0.36, 0.0])
    >>> wi.round(12), round(float(pdf), 6)
    (array([0.6, 0. , 0.8]), 0.254648)
    """
    u1, u2 = numbers(u)
    wi = direction(np.sqrt(u1), 2.0 * np.pi * u2, np.sqrt(1.0 - u1))
    return wi, wi[..., 2] / np.pi


def cosine_pdf(wi):
    """Density of `cosine_sample` at `wi`, in solid angle.

    Parameters
    ----------
    wi : array_like, shape (..., 3)
        Unit vectors on or above the horizon.

    Returns
    -------
    ndarray, shape (...), float64
        z / pi, in 1/sr.

    Raises
    ------
    ValueError
        If a direction is not unit or points below the horizon; names the first such element.

    Examples
    --------
    >>> round(float(cosine_pdf([0.6, 0.0, 0.8])), 6)
    0.254648
    """
    return np.float64(checked_directions("wi", wi)[..., 2]) / np.pi


def checked_draw(wo, u, **numbers):
    """Checked arguments of a sampler, in this order, as float64 arrays whose shapes broadcast."""
    return _broadcastable({"wo": checked_directions("wo", wo), "u": checked_pairs(u)}, numbers)


def checked_pdf(wo, wi, **numbers):
    """Checked arguments of a density, in this order, as float64 arrays whose shapes broadcast."""
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    return _broadcastable(vectors, numbers)


def _broadcastable(vectors, numbers):
    numbers = {name: checked(name, value) for name, value in numbers.items()}
    lead_shape(vectors, numbers)
    arrays = (*vectors.values(), *numbers.values())
    return [np.asarray(array, np.float64) for array in arrays]


def checked_pairs(u):
    """Checked random numbers of shape (..., 2), as a float64 array."""
    u = np.asarray(checked("u", u), np.float64)
    if u.shape[-1:] != (2,):
        raise ValueError(f"u must have shape (..., 2); got shape {u.shape}")
    return u


def numbers(u):
    """The two random numbers of each pair, checked, as float64 arrays of shape (...)."""
    u = checked_pairs(u)
    return u[..., 0], u[..., 1]


def direction(radius, phi, z):
    """Vectors (radius cos(phi), radius sin(phi), z)."""
    return vector(radius * np.cos(phi), radius * np.sin(phi), z)


def vector(*components):
    """Components, broadcast against each other, put together along a last axis."""
    return np.stack(np.broadcast_arrays(*components), axis=-1)


def azimuth(wo):
    """Cosine and sine of the azimuth of `wo`, and the sine of its polar angle.

    A `wo` along the normal has no azimuth; any would do, and it is given 0.
    """
    sine = np.hypot(wo[..., 0], wo[..., 1])
    tilted = sine > 0.0
    length = np.where(tilted, sine, 1.0)
    return np.where(tilted, wo[..., 0] / length, 1.0), wo[..., 1] / length, sine


def turned(w, cosine, sine):
    """`w` turned about the normal by the angle that has this cosine and sine."""
    x, y = w[..., 0], w[..., 1]
    return vector(cosine * x - sine * y, sine * x + cosine * y, w[..., 2])


def uniform_density(wi):
    """1/(2 pi) in the shape of `wi` without its last axis."""
    return np.full(wi.shape[:-1], 0.5 / np.pi)
