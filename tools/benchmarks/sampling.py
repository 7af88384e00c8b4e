# SPDX-License-Identifier: Apache-2.0
"""Samplers of EON: their variance by quadrature, their equal-noise time, and a chi-square test of the exact one.

    python -m tools.benchmarks sampling                       equal-noise time
    python -m tools.benchmarks.sampling                       the tables of docs/sampling.md
    python -m tools.benchmarks.sampling chi-square [SAMPLES]  samples of the exact sampler against its density

Nothing in the tables is random: the variance of one sample is an integral over the hemisphere, by a Gauss-Legendre rule
between the kinks of EON. LTC and CLTC alone have no finite variance: their density falls to 0 along a line on which EON
does not.

Equal-noise time is the variance of a sample times the time of a path. The picture is a ball at REFLECTANCE under one
light, one sample per pixel; the variance of each pixel is an integral over the light. For the scene of figure 1, the
variance is measured over independent pictures of the path tracer at 50 bounces.
"""

import sys
from dataclasses import replace
from functools import partial

import numpy as np
from scipy import stats

from mxeon.hosts import gl
from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.diffuse import eon_brdf
from mxeon.models.sampling import cosine_pdf, eon_cltc_pdf, eon_pdf, eon_sample
from tools.benchmarks.rounds import Group, clock_of, figure, interleave
from tools.benchmarks.tracer import Trace, trace
from tools.paper.samplers import BY_NAME, moments

# --- tables of variance ---------------------------------------------------------------------------

# From 0.01 on: towards 0 the variance of cosine sampling grows without bound, as its logarithm.
COSINES = np.linspace(0.01, 1.0, 100)
ROUGHNESSES = (0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
VIEWS = (1.0, 0.7, 0.3, 0.1)
PRINTED = ("uniform", "cosine", "eon_cltc", "eon")


def lobe(polar, sharpness):
    """Light from around a polar angle in degrees, in the view's plane; > 0 on the view's side."""
    towards = np.array([np.sin(np.radians(polar)), 0.0, np.cos(np.radians(polar))])
    return lambda wi: np.exp(sharpness * (wi @ towards - 1.0))


RADIANCES = {
    "uniform": lambda wi: np.ones(len(wi)),
    "brighter towards the zenith, z^2": lambda wi: wi[:, 2] ** 2,
    "brighter towards the horizon, (1 - z)^2": lambda wi: (1.0 - wi[:, 2]) ** 2,
    "the half on the side of the view": lambda wi: (wi[:, 0] > 0.0) * 1.0,
    "the half opposite": lambda wi: (wi[:, 0] < 0.0) * 1.0,
    "wide lobe at the zenith": lobe(0.0, 10.0),
    "wide lobe, 60 degrees, view's side": lobe(60.0, 10.0),
    "wide lobe, 60 degrees, opposite": lobe(-60.0, 10.0),
    "narrow lobe at the zenith": lobe(0.0, 200.0),
    "narrow lobe, 60 degrees, view's side": lobe(60.0, 200.0),
    "narrow lobe, 60 degrees, opposite": lobe(-60.0, 200.0),
    "narrow lobe, 85 degrees, opposite": lobe(-85.0, 200.0),
}


def print_table(first, columns, rows):
    """A table in Markdown of rows by their first cells."""
    print("\n| " + " | ".join([first, *columns]) + " |")
    print("|---" * (1 + len(columns)) + "|")
    for name, cells in rows.items():
        print("| " + " | ".join([str(name), *cells]) + " |")


def print_throughput():
    """Largest variance and weight over the polar angle, and the largest loss of CLTC without uniform samples."""

    def over_cosines(name, roughness):
        return np.transpose([moments(name, mu, roughness) for mu in COSINES])

    worst = {r: [over_cosines(name, r)[1:].max(axis=1) for name in PRINTED] for r in ROUGHNESSES}
    for column, title in enumerate(("variance, r", "largest weight, r")):
        rows = {r: [f"{each[column]:.3g}" for each in found] for r, found in worst.items()}
        print_table(title, [BY_NAME[name].title for name in PRINTED], rows)
    lost = {r: np.abs(1.0 - over_cosines("cltc", r)[0]).max() for r in ROUGHNESSES}
    print_table("r", ["lost by CLTC alone"], {r: [f"{each:.2g}"] for r, each in lost.items()})


def print_lighting(name):
    """Variance of a sampler relative to the exact one, by light and view."""
    for r in (0.25, 1.0):
        rows = {}
        for title, light in RADIANCES.items():
            ratios = [
                moments(name, mu, r, light)[1] / moments("eon", mu, r, light)[1] for mu in VIEWS
            ]
            rows[title] = [f"{ratio:.2f}" if ratio < 1e6 else "all" for ratio in ratios]
        head = f"{BY_NAME[name].title} / exact, r = {r}"
        print_table(head, [f"mu_o = {mu}" for mu in VIEWS], rows)


def print_color():
    """Largest relative variance that exact sampling for rho 1 or gray leaves in channels of a color, at r = 1."""
    rows = {}
    for rho in ((1e-6, 1e-6, 1e-6), (0.1, 0.1, 0.1), (0.5, 0.5, 0.5), (0.8, 0.2, 0.05)):
        found = []
        for mu in COSINES:
            wo, wi, projected = hemisphere_nodes(mu, 96)
            value, weights = eon_brdf(wo, wi, rho, 1.0) * wi[:, 2:], projected / wi[:, 2]
            for gray in (1.0, np.mean(rho)):
                pdf = eon_pdf(wo, wi, 1.0, rho=gray)[:, np.newaxis]
                weight = value / pdf / (weights @ value)
                found.append(np.max(weights @ ((weight - 1.0) ** 2 * pdf)))
        rows[rho] = [f"{value:.2g}" for value in np.reshape(found, (-1, 2)).max(axis=0)]
    print_table("rho, r = 1", ["sampled for rho = 1", "sampled for the mean of rho"], rows)


# --- chi-square -----------------------------------------------------------------------------------

# Bins have equal area on the disk; mu_o = 1/4 puts the kink of EON, and phi = 90 degrees its other one,
# between bins. The fits' 1.3e-5 is expected to add less than SAMPLES times 1.7e-10 to a statistic whose
# standard deviation is 55.
ROWS, COLUMNS, CHUNK = 48, 32, 1_000_000
MU_O = 0.25
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
    pdf = eon_pdf(WO, np.stack(parts, axis=-1), 1.0) * np.sin(theta)
    return np.einsum("ikjl,ik,jl->ij", pdf, d_theta, d_phi).ravel()


def print_chi_square(samples=1_000_000_000):
    """Chi-square of many samples, and the probability of a larger one; progress on stderr."""
    random, seen = np.random.default_rng(2025), np.zeros(ROWS * COLUMNS, np.int64)
    for done in range(0, samples, CHUNK):
        wi, _ = eon_sample(WO, random.random((min(CHUNK, samples - done), 2)), 1.0)
        row = np.minimum((wi[:, 2] ** 2 * ROWS).astype(int), ROWS - 1)
        turn = np.arctan2(wi[:, 1], wi[:, 0]) / (2.0 * np.pi) % 1.0
        column = np.minimum((turn * COLUMNS).astype(int), COLUMNS - 1)
        seen += np.bincount(row * COLUMNS + column, minlength=seen.size)
        print(f"\r{done / samples:.1%}", end="", file=sys.stderr)
    mean = samples * expected()
    statistic = np.sum((seen - mean) ** 2 / mean)
    probability = stats.chi2.sf(statistic, mean.size - 1)
    print(f"\nchi-square {statistic:.1f} at {mean.size - 1} degrees of freedom")
    print(f"probability of a larger one {probability:.3g}, expected total {mean.sum():.6f}")


# --- equal-noise time -----------------------------------------------------------------------------

REFLECTANCE = 0.8
ROUGHNESS = (0.25, 0.5, 1.0)  # average the variances of three balls
SAMPLERS = {"cosine": "cosine", "CLTC": "eon_cltc", "exact": "eon"}  # the tracer's names
SCENE = "figure 1, 50 bounces"
STEPS = 64
UP, VIEWER, RIGHT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
WINDOW = np.array([-0.8, 0.0, 0.6])
RINGS = 10


def frame(axis):
    """Three axes in columns, the last one `axis`."""
    x = np.cross(UP if abs(axis[1]) < 0.9 else VIEWER, axis)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), axis], axis=1)


def zone(axis, low, high):
    """Directions whose cosine with an axis lies between two, with their solid angles and radiance 1."""
    cosine = low + (high - low) * (np.arange(STEPS) + 0.5) / STEPS
    azimuth = 2.0 * np.pi * (np.arange(2 * STEPS) + 0.5) / (2 * STEPS)
    cosine, azimuth = (grid.ravel() for grid in np.meshgrid(cosine, azimuth, indexing="ij"))
    sine, one = np.sqrt(1.0 - cosine**2), np.ones_like(cosine)
    local = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], axis=-1)
    return local @ frame(axis).T, one * 2.0 * np.pi * (high - low) / len(local), one


def overcast():
    """The overcast sky of the CIE, (1 + 2 y) / 3."""
    wi, solid_angle, _ = zone(UP, 0.0, 1.0)
    return wi, solid_angle, (1.0 + 2.0 * wi[:, 1]) / 3.0


def window():
    """A square window, 30 degrees wide, on the left."""
    half = np.tan(np.radians(15.0))
    side = half * (2.0 * (np.arange(STEPS) + 0.5) / STEPS - 1.0)
    x, y = (grid.ravel() for grid in np.meshgrid(side, side))
    distance, one = np.sqrt(1.0 + x * x + y * y), np.ones_like(x)
    wi = np.stack([x, y, one], axis=-1) / distance[:, np.newaxis]
    return wi @ frame(WINDOW).T, (2.0 * half) ** 2 / (distance**3 * len(wi)), one


# Directions, solid angles and radiances, which serve as the quadrature.
LIGHTS = {
    "uniform": zone(UP, -1.0, 1.0),
    "overcast sky": overcast(),
    "half space": zone(RIGHT, 0.0, 1.0),
    "window": window(),
    "horizon band": zone(UP, 0.0, np.sin(np.radians(10.0))),
    "lamp at the viewer": zone(VIEWER, np.cos(np.radians(10.0)), 1.0),
}


def variances(light, spokes):
    """Variance of one sample by the sampler's name, its mean over balls and points evenly in their pictures."""
    radius = np.sqrt((np.arange(RINGS) + 0.5) / RINGS)
    azimuth = 2.0 * np.pi * (np.arange(spokes) + 0.5) / spokes
    radius, azimuth = (grid.ravel() for grid in np.meshgrid(radius, azimuth, indexing="ij"))
    z = np.sqrt(1.0 - radius**2)
    normals = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
    found = {name: [] for name in SAMPLERS}
    directions, solid_angle, radiance = light
    for normal in normals:
        wi, wo = directions @ frame(normal), VIEWER @ frame(normal)
        above = wi[:, 2] > 0.0
        wi, weight = wi[above], solid_angle[above]
        for roughness in ROUGHNESS:
            value = eon_brdf(wo, wi, REFLECTANCE, roughness)[:, 0] * wi[:, 2] * radiance[above]
            mean = value @ weight
            densities = {
                "cosine": cosine_pdf(wi),
                "CLTC": eon_cltc_pdf(wo, wi, roughness),
                "exact": eon_pdf(wo, wi, roughness, rho=REFLECTANCE),
            }
            for name, pdf in densities.items():
                found[name].append(max(value**2 / pdf @ weight - mean**2, 0.0))
    return {name: float(np.mean(each)) for name, each in found.items()}


def unit(x, y, z):
    length = float(np.linalg.norm((x, y, z)))
    return x / length, y / length, z / length


# A floor, and enough light from everywhere to see into the shadows.
STAGE = {"eye": unit(0.0, 0.42, 1.0), "height": -0.1, "half_width": 1.35}
STAGE |= {"bounces": 8, "floor": 0.35, "environment": 0.12}
FRONT, CLAY = unit(-0.15, 0.6, 1.0), (0.8, 0.38, 0.18)


def traced(samples, **lit):
    """EON at roughness 1 among the objects of figure 1, by the sampler's name."""
    still = {"samples": samples, **STAGE, **lit}
    return {name: Trace(sampler, **still) for name, sampler in SAMPLERS.items()}


# One path per pixel of the scene of figure 1, and one reflection in a uniform environment.
PATHS = traced(1, bounces=50, light=FRONT, rho=CLAY)
REFLECTIONS = traced(16, bounces=1, environment=1.0, rho=(REFLECTANCE,) * 3)


def path_times(host, rounds, stills):
    """Nanoseconds of a path of the tracer in each round, by the sampler's name."""
    runs = {name: partial(trace, host, each) for name, each in stills.items()}
    seconds = interleave(runs, rounds, clock_of(host.identity().device))
    return {n: 1e9 / (stills[n].size ** 2 * stills[n].samples) * s for n, s in seconds.items()}


def measure(rounds=15, size=128, pictures=48, spokes=20):
    host = gl.GlHost()
    device = host.identity().device
    paths, bounces = (
        {name: replace(each, size=size) for name, each in stills.items()}
        for stills in (REFLECTIONS, PATHS)
    )
    table = {title: variances(light, spokes) for title, light in LIGHTS.items()}
    table[SCENE] = {}
    for name, still in bounces.items():
        images = [trace(host, replace(still, seed=seed)) for seed in range(pictures)]
        table[SCENE][name] = float(np.var(images, axis=0, ddof=1, dtype=np.float64).mean())
    paths, bounces = (path_times(host, rounds, stills) for stills in (paths, bounces))
    host.close()
    figures = [figure(f"a path: {n}", "ns", times) for n, times in paths.items()]
    figures += [figure(f"a path, {SCENE}: {n}", "ns", times) for n, times in bounces.items()]
    for title, variance in table.items():
        figures += [figure(f"variance: {title}: {n}", "", [v]) for n, v in variance.items()]
        times = bounces if title == SCENE else paths
        products = {n: v * times[n] for n, v in variance.items()}
        least = np.min([*products.values()], axis=0)  # round by round
        figures += [figure(f"{title}: {n}", "x", v / least) for n, v in products.items()]
    return Group("sampling", f"Equal-noise time of sampling on {device}", tuple(figures))


if __name__ == "__main__":
    if sys.argv[1:2] == ["chi-square"]:
        print_chi_square(*(int(float(each)) for each in sys.argv[2:]))
    else:
        print_throughput()
        for other in ("eon_cltc", "cosine"):
            print_lighting(other)
        print_color()
