# SPDX-License-Identifier: Apache-2.0
"""Random directions for tests, with fixed seeds and grazing angles."""

import numpy as np


def direction(mu, phi=0.0):
    """Unit vector at azimuth phi whose cosine with the normal is mu."""
    mu, phi = np.broadcast_arrays(np.asarray(mu, float), np.asarray(phi, float))
    S = np.sqrt((1.0 - mu) * (1.0 + mu))
    return np.stack([S * np.cos(phi), S * np.sin(phi), mu], axis=-1)


def directions(shape, seed, least=0.0):
    """Random unit vectors whose cosine with the normal is at least `least`."""
    share, turn = np.random.default_rng(seed).random((2, *np.atleast_1d(shape)))
    return direction(least + (1.0 - least) * share, 2.0 * np.pi * turn)


def pairs(count, seed):
    """Random `wo`, `wi`, RGB `rho` and roughness. Half of the cosines are near grazing."""
    rng = np.random.default_rng(seed)
    mu = rng.random((2, count))
    grazing = rng.random((2, count)) < 0.5
    mu = np.where(grazing, 10.0 ** rng.uniform(-9.0, 0.0, (2, count)), mu)
    wo, wi = direction(mu, rng.uniform(0.0, 2.0 * np.pi, (2, count)))
    return wo, wi, rng.random((count, 3)), rng.random(count)


def parameter(row, fraction):
    """Tuple with a model's parameter at a fraction of the maximum; empty if there is none."""
    return (row.largest * fraction,) if row.parameter else ()
