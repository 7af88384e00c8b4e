# SPDX-License-Identifier: Apache-2.0
"""EON over many pairs: mxeon's blocks against the printed formula over whole arrays.

    python benchmarks/models.py [PAIRS ...]

Prints one JSON line per number of pairs and kind of material (one for all pairs, or one per pair):
nanoseconds per pair of three channels, medians of interleaved rounds, and their ratio. The values
are compared in the same run.
"""

import json
import platform
import statistics
import sys
import time

import numpy as np

from mxeon import geometry
from mxeon.models import eon_brdf

ROUNDS = 5
C1 = 0.5 - 2.0 / (3.0 * np.pi)
C2 = 2.0 / 3.0 - 28.0 / (15.0 * np.pi)

# The printed forms lose digits where they cancel, as 1e-16 / mu: compared above this cosine.
COMPARED = 1e-3
TOLERANCE = 1e-11


def naive_fon_albedo(mu, r):
    """[Portsmouth2025], Eqs. (8), (12), (13), as printed."""
    S = np.sqrt(1.0 - mu**2)
    g = S * (np.arccos(mu) - S * mu) + 2.0 / 3.0 * (S / mu * (1.0 - S**3) - S)
    return (1.0 + r / np.pi * g) / (1.0 + C1 * r)


def naive_eon_brdf(wo, wi, rho, r):
    """[Portsmouth2025], Eqs. (10), (11), (16), (19), as printed."""
    mu_o, mu_i = wo[..., 2], wi[..., 2]
    s = np.sum(wo * wi, axis=-1) - mu_o * mu_i
    quotient = np.where(s > 0.0, s / np.maximum(mu_o, mu_i), s)
    a = 1.0 / (1.0 + C1 * r)
    single = rho / np.pi * (a + r * a * quotient)[..., np.newaxis]
    average = np.asarray((1.0 + C2 * r) * a)
    lost = (1.0 - naive_fon_albedo(mu_o, r)) * (1.0 - naive_fon_albedo(mu_i, r)) / (1.0 - average)
    average = average[..., np.newaxis]
    tint = rho**2 * average / (1.0 - rho * (1.0 - average))
    return single + tint / np.pi * lost[..., np.newaxis]


def directions(count, rng):
    """Unit vectors with uniform cosines above `COMPARED`."""
    mu, phi = rng.uniform(COMPARED, 1.0, count), rng.uniform(0.0, 2.0 * np.pi, count)
    S = np.sqrt(1.0 - mu * mu)
    return np.stack([S * np.cos(phi), S * np.sin(phi), mu], axis=-1)


def seconds(function, arguments):
    """Time of one call, and its result."""
    start = time.perf_counter()
    result = function(*arguments)
    return time.perf_counter() - start, result


def compare(count, material, arguments):
    """One row of the result."""
    naive, blocked = [], []
    for _ in range(ROUNDS):
        elapsed, expected = seconds(naive_eon_brdf, arguments)
        naive.append(elapsed)
        elapsed, value = seconds(eon_brdf, arguments)
        blocked.append(elapsed)
        error = np.pi * float(np.abs(np.subtract(value, expected, out=value)).max())
        if error > TOLERANCE:
            raise SystemExit(f"values differ by {error:.1e} / pi, more than {TOLERANCE:.0e} / pi")
    return {
        "benchmark": "eon_brdf",
        "pairs": count,
        "material": material,
        "naive_ns": round(1e9 * statistics.median(naive) / count, 1),
        "mxeon_ns": round(1e9 * statistics.median(blocked) / count, 1),
        "ratio": round(statistics.median(naive) / statistics.median(blocked), 2),
        "largest_difference": error,
        "workers": geometry.WORKERS,
        "numpy": np.__version__,
        "machine": platform.machine(),
    }


def main(counts):
    """Print one line per number of pairs and material."""
    for count in counts:
        rng = np.random.default_rng(1)
        wo, wi = directions(count, rng), directions(count, rng)
        uniform = (wo, wi, np.array([0.2, 0.5, 0.8]), np.float64(0.7))
        print(json.dumps(compare(count, "one for all", uniform)), flush=True)
        textured = (wo, wi, rng.random((count, 3)), rng.random(count))
        print(json.dumps(compare(count, "one per pair", textured)), flush=True)


if __name__ == "__main__":
    main([int(float(count)) for count in sys.argv[1:]] or [1_000_000, 10_000_000])
