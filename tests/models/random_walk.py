# SPDX-License-Identifier: Apache-2.0
"""A random walk of light in a half space below a surface that transmits diffusely: what is measured
against the equations of subsurface scattering."""

import numpy as np


def distances(albedo, anisotropy, count, seed=1):
    """Distances from where light enters a half space to where it leaves it.

    Parameters
    ----------
    albedo : float
        Single-scattering albedo, in [0, 1).
    anisotropy : float
        Mean cosine of Henyey and Greenstein's phase function, in (-1, 1).
    count : int
        Number of paths.
    seed : int

    Returns
    -------
    ndarray
        In mean free paths, one for each path that leaves: their number over `count` is the diffuse
        reflectance.
    """
    rng = np.random.default_rng(seed)
    # The light below a diffuse surface.
    down = np.repeat([[0.0], [0.0], [-1.0]], count, axis=1)
    cosines, azimuths = np.sqrt(1.0 - rng.random(count)), 2.0 * np.pi * rng.random(count)
    points, ways = np.zeros((3, count)), _turned(down, cosines, azimuths)
    ended = []
    while points.shape[1]:
        points = points - np.log1p(-rng.random(points.shape[1])) * ways
        outside = points[2] >= 0.0
        left, way = points[:, outside], ways[:, outside]
        ended.append(np.hypot(*(left - way * (left[2] / way[2]))[:2]))
        stays = ~outside & (rng.random(len(outside)) < albedo)
        points, ways = points[:, stays], ways[:, stays]
        cosine = _scattered(rng.random(points.shape[1]), anisotropy)
        ways = _turned(ways, cosine, 2.0 * np.pi * rng.random(points.shape[1]))
    return np.concatenate(ended)


def reflectance_of_h(albedo):
    """Reflectance of an isotropic half space under a uniform sky, by Chandrasekhar's H function."""
    x, w = np.polynomial.legendre.leggauss(64)
    mu, weights = (0.5 * (x + 1.0)) ** 2, 0.5 * (x + 1.0) * w
    h = np.ones(len(mu))
    for _ in range(400):
        integral = (mu * weights * h / (mu + mu[:, np.newaxis])).sum(axis=1)
        h = 1.0 / (np.sqrt(1.0 - albedo) + 0.5 * albedo * integral)
    return 1.0 - 2.0 * np.sqrt(1.0 - albedo) * (h * mu * weights).sum()


def _scattered(u, g):
    """Cosines drawn from the phase function."""
    if g == 0.0:
        return 1.0 - 2.0 * u
    return (1.0 + g * g - ((1.0 - g * g) / (1.0 - g + 2.0 * g * u)) ** 2) / (2.0 * g)


def _turned(ways, cosine, azimuth):
    """Directions that deviate from others by a cosine, at an azimuth."""
    x, y, z = ways
    sign = np.where(z < 0.0, -1.0, 1.0)
    a = -1.0 / (sign + z)
    first = np.array([1.0 + sign * x * x * a, sign * x * y * a, -sign * x])
    second = np.array([x * y * a, sign + y * y * a, -y])
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine * cosine))
    return sine * np.cos(azimuth) * first + sine * np.sin(azimuth) * second + cosine * ways
