# SPDX-License-Identifier: Apache-2.0
"""Chi-square of many samples of the exact sampler against its density, over 48 x 32 bins.

    python tools/benchmarks/sampling_chi_square.py [SAMPLES]

The default is 1e9, six minutes on one core. The bins have equal area on the disk; mu_o = 1/4 puts
the kink of EON, and phi = 90 degrees its other one, between bins. The fits' 1.3e-5 is expected to
add less than SAMPLES times 1.7e-10 to a statistic whose standard deviation is 55.
"""

import sys

import numpy as np
from scipy import stats

from mxeon.models.sampling import eon_pdf, eon_sample

ROWS, COLUMNS, CHUNK = 48, 32, 1_000_000
MU_O, ROUGHNESS = 0.25, 1.0
WO = np.array([np.sqrt(1.0 - MU_O**2), 0.0, MU_O])


def expected():
    """Probability of each bin, by Gauss-Legendre quadrature in the polar angle and the azimuth."""
    x, weight = np.polynomial.legendre.leggauss(16)
    theta = np.arccos(np.sqrt(np.arange(ROWS + 1) / ROWS))[:, np.newaxis]
    phi = 2.0 * np.pi * np.arange(COLUMNS + 1)[:, np.newaxis] / COLUMNS
    (theta, d_theta), (phi, d_phi) = (
        (edge[:-1] + 0.5 * np.diff(edge, axis=0) * (1.0 + x), 0.5 * np.diff(edge, axis=0) * weight)
        for edge in (theta, phi)
    )
    theta, d_theta = theta[:, :, np.newaxis, np.newaxis], -d_theta
    parts = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta) + 0.0 * phi
    pdf = eon_pdf(WO, np.stack(parts, axis=-1), ROUGHNESS) * np.sin(theta)
    return np.einsum("ikjl,ik,jl->ij", pdf, d_theta, d_phi).ravel()


def counted(samples):
    """Samples in each bin; progress on stderr."""
    random, seen = np.random.default_rng(2025), np.zeros(ROWS * COLUMNS, np.int64)
    for done in range(0, samples, CHUNK):
        wi, _ = eon_sample(WO, random.random((min(CHUNK, samples - done), 2)), ROUGHNESS)
        row = np.minimum((wi[:, 2] ** 2 * ROWS).astype(int), ROWS - 1)
        turn = np.arctan2(wi[:, 1], wi[:, 0]) / (2.0 * np.pi) % 1.0
        column = np.minimum((turn * COLUMNS).astype(int), COLUMNS - 1)
        seen += np.bincount(row * COLUMNS + column, minlength=seen.size)
        print(f"\r{done / samples:.1%}", end="", file=sys.stderr)
    return seen


def main(samples):
    """Print the statistic, and how often chance alone exceeds it."""
    mean, seen = samples * expected(), counted(samples)
    statistic = np.sum((seen - mean) ** 2 / mean)
    probability = stats.chi2.sf(statistic, mean.size - 1)
    print(f"\nchi-square {statistic:.1f} at {mean.size - 1} degrees of freedom")
    print(f"probability of a larger one {probability:.3g}, expected total {mean.sum():.6f}")


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000_000)
