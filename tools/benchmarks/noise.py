# SPDX-License-Identifier: Apache-2.0
"""Equal-noise time of the samplers of EON: the variance of a sample times the time of a path.

The picture is a ball at REFLECTANCE under one light, one sample per pixel. The variance of each pixel is an
integral over the light, so nothing is random. For the scene of figure 1 it is that of independent pictures
of the path tracer at 50 bounces.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.hosts import gl
from mxeon.models.diffuse.brdf import eon_brdf
from mxeon.models.sampling import cosine_pdf, eon_cltc_pdf, eon_pdf
from tools.benchmarks.rounds import Group, clock_of, figure, interleave, scaled
from tools.paper.renders import CLAY, FRONT, STAGE
from tools.paper.tracer import Trace, trace

REFLECTANCE = 0.8
ROUGHNESS = (0.25, 0.5, 1.0)  # of three balls whose variances are averaged
SAMPLERS = {"cosine": "cosine", "CLTC": "eon_cltc", "exact": "eon"}  # the tracer's names
SCENE = "figure 1, 50 bounces"
STEPS = 64
UP, VIEWER, RIGHT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
WINDOW = np.array([-0.8, 0.0, 0.6])


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
    """A square of 30 degrees on the left."""
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


def normals(rings=10, spokes=20):
    """Normals of the ball at points that lie evenly in its picture."""
    radius = np.sqrt((np.arange(rings) + 0.5) / rings)
    azimuth = 2.0 * np.pi * (np.arange(spokes) + 0.5) / spokes
    radius, azimuth = (grid.ravel() for grid in np.meshgrid(radius, azimuth, indexing="ij"))
    z = np.sqrt(1.0 - radius**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def pixel_variances(light, normal, roughness):
    """Variance of one sample of a pixel, by the sampler's name."""
    directions, solid_angle, radiance = light
    wi = directions @ frame(normal)
    above = wi[:, 2] > 0.0
    wi, weight, radiance = wi[above], solid_angle[above], radiance[above]
    wo = VIEWER @ frame(normal)
    value = eon_brdf(wo, wi, REFLECTANCE, roughness)[:, 0] * wi[:, 2] * radiance
    densities = {
        "cosine": cosine_pdf(wi),
        "CLTC": eon_cltc_pdf(wo, wi, roughness),
        "exact": eon_pdf(wo, wi, roughness, rho=REFLECTANCE),
    }
    mean = value @ weight
    return {name: max(value**2 / p @ weight - mean**2, 0.0) for name, p in densities.items()}


def variances(light, spokes):
    """Mean over pixels and balls of the variance of one sample, by the sampler's name."""
    pixels = [pixel_variances(light, n, r) for n in normals(spokes=spokes) for r in ROUGHNESS]
    return {name: float(np.mean([each[name] for each in pixels])) for name in SAMPLERS}


def scene(sampler):
    """The scene of figure 1 for EON at roughness 1, one path per pixel."""
    lit = STAGE | {"bounces": 50, "light": FRONT, "rho": CLAY}
    return Trace("eon", sampler, parameter=1.0, samples=1, **lit)


def reflection(sampler):
    """One reflection among the same objects in a uniform environment: what a sample takes there."""
    lit = STAGE | {"bounces": 1, "environment": 1.0, "rho": (REFLECTANCE,) * 3}
    return Trace("eon", sampler, parameter=1.0, samples=16, **lit)


def traced_variances(host, pictures, size):
    """Mean variance of one path in the scene of figure 1, by the sampler's name."""
    found = {}
    for name, sampler in SAMPLERS.items():
        still = replace(scene(sampler), size=size)
        images = [trace(host, replace(still, seed=seed)) for seed in range(pictures)]
        found[name] = float(np.var(images, axis=0, ddof=1, dtype=np.float64).mean())
    return found


def path_times(host, rounds, size, made):
    """Nanoseconds of a path of the tracer in each round, by the sampler's name."""
    still = {name: replace(made(sampler), size=size) for name, sampler in SAMPLERS.items()}
    runs = {name: partial(trace, host, each) for name, each in still.items()}
    seconds = interleave(runs, rounds, clock_of(host.identity().device))
    return {n: np.array(v) * 1e9 / (size**2 * still[n].samples) for n, v in seconds.items()}


def measure(rounds=15, size=128, pictures=48, spokes=20):
    """The `Group` of all lights."""
    host = gl.Host()
    device = host.identity().device
    paths = path_times(host, rounds, size, reflection)
    bounces = path_times(host, rounds, size, scene)
    table = {title: variances(light, spokes) for title, light in LIGHTS.items()}
    table[SCENE] = traced_variances(host, pictures, size)
    host.close()
    figures = [scaled(f"a path: {n}", "ns", values, 1.0) for n, values in paths.items()]
    figures += [scaled(f"a path, {SCENE}: {n}", "ns", v, 1.0) for n, v in bounces.items()]
    for title, variance in table.items():
        figures += [figure(f"variance: {title}: {n}", "", [v]) for n, v in variance.items()]
        times = bounces if title == SCENE else paths
        products = {n: v * times[n] for n, v in variance.items()}
        least = np.min([*products.values()], axis=0)  # round by round
        figures += [figure(f"{title}: {n}", "x", list(v / least)) for n, v in products.items()]
    return Group("noise", f"Equal-noise time of sampling on {device}", tuple(figures))
