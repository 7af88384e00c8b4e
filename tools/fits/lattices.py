# SPDX-License-Identifier: Apache-2.0
"""Errors of sums over a uniform environment, for several sets of points.

A lobe's albedo is the mean of F G2 / G1 over incident directions, which are sampled from visible
normals. Energy compensation divides a white lobe's albedo by E_ss. MaterialX uses a Fibonacci
lattice, but permits other point sets of low discrepancy. Errors with n points are proportional to
1 / n, so the script prints n times the largest error.

    python -m tools.fits.lattices
"""

import numpy as np

from mxeon.models.microfacet.ggx import ggx_albedo_dir, smith_g1, smith_lambda
from mxeon.models.sampling import ggx_sample

COSINES = np.concatenate([[0.01, 0.03], np.linspace(0.05, 1.0, 20)])
ALPHAS = np.linspace(0.05, 1.0, 20)


def fibonacci(count):
    """MaterialX's Fibonacci points: i / n, and multiples of the golden ratio modulo 1."""
    i = np.arange(count)
    return (i + 0.5) / count, (i * (np.sqrt(5.0) - 1.0) / 2.0 + 0.5) % 1.0


def r2(count):
    """Roberts' R2 points: multiples of 1 / x and of 1 / x^2, modulo 1, where x^3 = x + 1."""
    steps = 1.3247179572447460 ** -np.arange(1.0, 3.0)
    return tuple((0.5 + np.arange(1, count + 1) * step) % 1.0 for step in steps)


def hammersley(count):
    """Hammersley points with the coordinates i / n and the mirrored binary digits of i."""
    i, mirrored = np.arange(count), np.zeros(count)
    for digit in range(count.bit_length()):
        mirrored += ((i >> digit) & 1) * 0.5 ** (digit + 1)
    return (i + 0.5) / count, mirrored


LATTICES = {"Fibonacci": fibonacci, "R2": r2, "Hammersley": hammersley}


def error(lattice, count, alpha):
    """Largest relative error of a white lobe's albedo, with and without swapped coordinates."""
    numbers, found = lattice(count), 0.0
    wo = np.stack([np.sqrt(1.0 - COSINES**2), 0.0 * COSINES, COSINES], axis=-1)[:, None]
    for u in (numbers, numbers[::-1]):
        wi, _ = ggx_sample(wo, np.stack(u, axis=-1), [alpha, alpha])
        lit = np.maximum(wi[..., 2], 0.0)
        smith = wo[..., 2] * smith_lambda(lit, alpha) + lit * smith_lambda(wo[..., 2], alpha)
        weight = 2.0 * wo[..., 2] * lit / smith / smith_g1(wo, [alpha, alpha])
        exact = ggx_albedo_dir(COSINES, alpha)
        found = max(found, float(np.abs(weight.mean(axis=1) / exact - 1.0).max()))
    return found


if __name__ == "__main__":
    for name, lattice in LATTICES.items():
        for count in (64, 256, 1024):
            worst = max((error(lattice, count, alpha), alpha) for alpha in ALPHAS)
            print(f"{name}, {count}: {count * worst[0]:.2f} at alpha {worst[1]:.2f}")
