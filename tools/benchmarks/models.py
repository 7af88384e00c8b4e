# SPDX-License-Identifier: Apache-2.0
"""EON in NumPy over many pairs: mxeon's blocks against the printed formula as it is.

Memory beyond arguments and result is the growth of the resident peak in a process of its own.
"""

import subprocess
import sys
from functools import partial

import numpy as np

from mxeon.models import eon_brdf, threads
from tools.benchmarks.rounds import Check, Group, figure, interleave, ratio, scaled

C1 = 0.5 - 2.0 / (3.0 * np.pi)
C2 = 2.0 / 3.0 - 28.0 / (15.0 * np.pi)

# The printed forms lose digits where they cancel, as 1e-16 / mu: compared above this cosine.
COMPARED = 1e-3
TOLERANCE = 1e-11
PAIRS = (10_000, 100_000, 1_000_000, 10_000_000, 30_000_000)
GOALS = {1_000_000: 3.0, 10_000_000: 3.5}


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


def arguments(count, material):
    """Random pairs with one material for all, or one per pair."""
    rng = np.random.default_rng(1)
    wo, wi = directions(count, rng), directions(count, rng)
    if material == "one":
        return wo, wi, np.array([0.2, 0.5, 0.8]), np.float64(0.7)
    return wo, wi, rng.random((count, 3)), rng.random(count)


def on_threads(count, *arguments):
    """`eon_brdf` on so many threads."""
    with threads(count):
        return eon_brdf(*arguments)


def rivals(pairs):
    """Every way to the same values."""
    ways = {"naive": partial(naive_eon_brdf, *pairs)}
    for count in (1, 2):
        ways[f"blocks, {count} thread{'s'[: count - 1]}"] = partial(on_threads, count, *pairs)
    return ways


def compare(count, material, rounds):
    """Figures and checks of one number of pairs."""
    ways = rivals(arguments(count, material))
    exact = ways["naive"]()
    checks, label = [], f"{count:.0e} pairs, {material} material"
    for name, way in ways.items():
        error = np.pi * float(np.abs(way() - exact).max())
        checks.append(Check(f"{name}, {label}", error, TOLERANCE))
    seconds = interleave(ways, rounds)
    times = {n: scaled(f"{n}, {label}", "ns", s, 1e9 / count) for n, s in seconds.items()}
    goals = {"blocks, 2 threads": GOALS.get(count)}
    ratios = [
        ratio(f"naive / {n}, {label}", seconds["naive"], s, goals.get(n), at_least=True)
        for n, s in seconds.items()
        if n != "naive"
    ]
    return [*times.values(), *ratios], checks


def extra_memory(way, count):
    """MiB by which the resident peak of a new process grows beyond arguments and result."""
    code = f"from tools.benchmarks.models import peak; print(peak({way!r}, {count}))"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return float(done.stdout)


def peak(way, count):
    """Growth of this process's resident peak in one call, without the result; MiB."""
    rivals(arguments(8, "one"))[way]()
    pairs = arguments(count, "one")
    before = reset_memory()
    result = rivals(pairs)[way]()
    return max(0.0, peak_memory() - before - result.nbytes / 2**20)


def reset_memory():
    """Resident MiB after the peak is set back to it."""
    with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
        file.write("5")
    return peak_memory()


def peak_memory():
    """Peak of this process's resident memory, MiB."""
    with open("/proc/self/status", encoding="ascii") as file:
        line = next(line for line in file if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024.0


def measure(rounds=7, pairs=PAIRS):
    """The `Group` of both kinds of material over the numbers of pairs."""
    figures, checks = [], []
    for material in ("one", "own"):
        for count in pairs:
            found, right = compare(count, material, rounds if count < 1e7 else 3)
            figures, checks = figures + found, checks + right
    for way in rivals(arguments(8, "one")):
        for count in pairs:
            memory = extra_memory(way, count)
            figures.append(figure(f"extra memory, {way}, {count:.0e} pairs", "MiB", [memory]))
    return Group("models", "NumPy reference, per pair", tuple(figures), tuple(checks))
