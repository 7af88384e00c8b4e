# SPDX-License-Identifier: Apache-2.0
"""Views, random numbers and quadratures of the hemisphere, for the tests of samplers."""

from functools import lru_cache

import numpy as np
import pytest
from scipy import special  # importing scipy.stats is slow

from tools.paper.samplers import SAMPLERS

COSINES = (1.0, 0.9, 0.5, 0.1, 1e-3, 0.0)
ROUGHNESS = (0.0, 0.01, 0.4, 1.0)
SCENES = [(mu, r) for mu in COSINES for r in ROUGHNESS]

every_sampler = pytest.mark.parametrize("sampler", SAMPLERS)
every_scene = pytest.mark.parametrize(("mu", "roughness"), SCENES)

gauss_legendre = lru_cache(np.polynomial.legendre.leggauss)


def rule(edges, count):
    """Gauss-Legendre nodes and weights between adjacent edges, shape (panels, count)."""
    x, w = gauss_legendre(count)
    edges = np.asarray(edges)[:, np.newaxis]
    half = 0.5 * np.diff(edges, axis=0)
    return edges[:-1] + half * (1.0 + x), half * w


def directions(theta, phi):
    """Unit vectors for all combinations of two angles, shape (*theta, *phi, 3)."""
    theta = theta.reshape(theta.shape + (1,) * phi.ndim)
    parts = (np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta) + 0.0 * phi)
    return np.stack(parts, axis=-1)


def hemisphere(mu, count=64):
    """Quadrature directions and solid angles. Panels end where EON has kinks for a view at `mu`."""
    kink = np.minimum(np.arccos(mu), 0.5 * np.pi)  # a rounded angle may exceed a right angle
    theta, dtheta = rule(np.unique([0.0, kink, 0.5 * np.pi]), count)
    phi, dphi = rule(0.5 * np.pi * np.arange(-1, 4), count)
    weights = (dtheta * np.sin(theta))[:, :, np.newaxis, np.newaxis] * dphi
    return directions(theta, phi).reshape(-1, 3), weights.ravel()


def sphere(nodes):
    """Directions and solid angles over the full sphere, relative to a fiber along +x."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    phi = 2.0 * np.pi * (np.arange(2 * nodes) + 0.5) / (2 * nodes)
    sine, angle = (each.ravel() for each in np.meshgrid(x, phi))
    cosine = np.sqrt(1.0 - sine * sine)
    wi = np.stack([sine, cosine * np.cos(angle), cosine * np.sin(angle)], axis=-1)
    return wi, np.tile(w, 2 * nodes) * np.pi / nodes


def uniforms(count, seed):
    return np.random.default_rng(seed).random((count, 2))


def binned(wi, edges, count):
    """Number of directions below the horizon, and in each bin of polar angle and azimuth."""
    row = np.digitize(np.arccos(np.clip(wi[:, 2], -1.0, 1.0)), edges[1:-1])
    column = np.floor((np.arctan2(wi[:, 1], wi[:, 0]) / (2.0 * np.pi) % 1.0) * count).astype(int)
    bins = np.where(wi[:, 2] < 0.0, 0, 1 + row * count + np.minimum(column, count - 1))
    return np.bincount(bins, minlength=1 + count * (len(edges) - 1))


def probability(sample, pdf, wo, u, count=12, nodes=24):
    """p-value of a chi-square test of a sampler's samples against the density `pdf`.

    All directions below the horizon share one bin.
    """
    # All bins have the same projected area.
    edges = np.arccos(np.sqrt(np.linspace(1.0, 0.0, 9)))
    counts = binned(sample(wo, u)[0], edges, count)
    theta, dtheta = rule(edges, nodes)
    phi, dphi = rule(2.0 * np.pi * np.arange(count + 1) / count, nodes)
    density = pdf(wo, directions(theta, phi))
    bins = np.einsum("ikjl,ik,jl->ij", density, dtheta * np.sin(theta), dphi)
    mean = len(u) * np.append(1.0 - bins.sum(), bins)
    # Pool all bins with fewer than 10 expected samples, whose statistic is not chi-square.
    likely = mean >= 10.0
    statistic = np.sum((counts - mean)[likely] ** 2 / mean[likely])
    rest = mean[~likely].sum()
    if rest >= 10.0:
        statistic += (counts[~likely].sum() - rest) ** 2 / rest
    return special.chdtrc(likely.sum() + (rest >= 10.0) - 1, statistic)
