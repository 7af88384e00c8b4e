# SPDX-License-Identifier: Apache-2.0
"""Equal-noise time of the samplers of EON: variance of a sample times the time that it takes.

The picture is a ball at REFLECTANCE under one of eight lights, one sample per pixel. For seven lights
the variance of each pixel is an integral over the light, by `tools.benchmarks.lights`: nothing is random.
For the scene of figure 1 it is that of independent pictures of the path tracer at 50 bounces.

A combined sampler draws from the light or from the BRDF with probability 1/2 each and divides by the
mean of both densities: the balance heuristic of one sample [Veach1995].
"""

from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.hosts import gl
from mxeon.models.diffuse.brdf import eon_brdf
from mxeon.models.sampling import cosine_pdf, eon_cltc_pdf, eon_pdf
from tools.benchmarks import rivals, shaders
from tools.benchmarks.lights import LIGHTS, local, points
from tools.benchmarks.rounds import Group, clock_of, figure, interleave, less, scaled
from tools.paper.renders import CLAY, FRONT, STAGE
from tools.paper.tracer import Trace, trace

REFLECTANCE = 0.8
ROUGHNESS = (0.25, 0.5, 1.0)  # of three balls whose variances are added
SAMPLERS = ("cosine", "CLTC", "exact")
TRACED = {"cosine": "cosine", "CLTC": "eon_cltc", "exact": "eon"}
SCENE = "figure 1, 50 bounces"
FUNCTIONS, PATHS = "functions", "paths"  # what is timed

# The light of the combined samplers that are timed: a cone of 26 degrees about (0.6, 0, 0.8).
LIGHT = """
vec3 light_sample(float u1, float u2)
{
    float z = 1.0 - 0.1 * u1, S = sqrt(1.0 - z * z), phi = 2.0 * EON_PI * u2;
    float x = S * cos(phi);
    return vec3(0.8 * x + 0.6 * z, S * sin(phi), 0.8 * z - 0.6 * x);
}
float light_pdf(vec3 wi)
{
    return 0.6 * wi.x + 0.8 * wi.z > 0.9 ? 1.0 / (0.2 * EON_PI) : 0.0;
}
"""


def densities(wo, wi, roughness):
    """Density of each sampler, by its name."""
    return {
        "cosine": cosine_pdf(wi),
        "CLTC": eon_cltc_pdf(wo, wi, roughness),
        "exact": eon_pdf(wo, wi, roughness, rho=REFLECTANCE),
    }


def pixel_variances(light, normal, roughness):
    """Variance of one sample of a pixel, by the sampler's name, alone and combined."""
    wi = local(normal, light.wi)
    above = wi[:, 2] > 0.0
    wi, weight = wi[above], light.solid_angle[above]
    wo = local(normal, np.array([[0.0, 0.0, 1.0]]))
    value = eon_brdf(wo, wi, REFLECTANCE, roughness)[:, 0] * wi[:, 2] * light.radiance[above]
    mean = value @ weight
    found = {}
    for name, pdf in densities(wo, wi, roughness).items():
        found[name] = value**2 / pdf @ weight - mean**2
        both = 0.5 * (pdf + light.pdf[above])
        found[f"{name} + light"] = value**2 / both @ weight - mean**2
    return {name: max(variance, 0.0) for name, variance in found.items()}


def variances(light, normals):
    """Mean over pixels and balls of the variance of one sample, by the sampler's name."""
    pixels = [pixel_variances(light, normal, r) for normal in normals for r in ROUGHNESS]
    return {name: float(np.mean([each[name] for each in pixels])) for name in pixels[0]}


def traced_variances(host, pictures, size):
    """Mean variance of one path in the scene of figure 1, by the sampler's name."""
    found = {}
    for name, sampler in TRACED.items():
        still = replace(scene(sampler), size=size)
        images = [trace(host, replace(still, seed=seed)) for seed in range(pictures)]
        found[name] = float(np.var(images, axis=0, ddof=1, dtype=np.float64).mean())
    return found


def scene(sampler):
    """The scene of figure 1 for EON at roughness 1, one path per pixel."""
    lit = STAGE | {"bounces": 50, "light": FRONT, "rho": CLAY}
    return Trace("eon", sampler, parameter=1.0, samples=1, **lit)


def reflection(sampler):
    """One reflection among the same objects in a uniform environment: what a sample takes there."""
    lit = STAGE | {"bounces": 1, "environment": 1.0, "rho": (REFLECTANCE,) * 3}
    return Trace("eon", sampler, parameter=1.0, samples=16, **lit)


def statements():
    """GLSL that draws and weighs one sample, by the sampler's name."""
    value = rivals.TWIN.format("eon_brdf")
    mixture = "wi = eon_cltc_sample(wo, u1, u2, roughness);", "eon_cltc_pdf(wo, wi, roughness)"
    found = {}
    for name, (draw, pdf) in zip(SAMPLERS, (rivals.COSINE, mixture, rivals.EON), strict=True):
        add = f"if (wi.z > 0.0) sum += {value} * (wi.z / "
        found[name] = f"{{ {draw} {add}{pdf}); }}"
        choice = f"if (turn < 0.5) wi = light_sample(u1, u2); else {{ {draw} }}"
        both = f"(0.5 * (light_pdf(wi) + {pdf}))"
        found[f"{name} + light"] = f"{{ {choice} {add}{both}); }}"
    return found


def function_times(rounds, invocations, calls):
    """Renderer, and seconds of sample, density and value in each round, by the sampler's name."""
    device = shaders.Device(invocations)
    device.source += LIGHT
    kernels = {name: device.kernel(text) for name, text in statements().items()}
    base = device.kernel(rivals.BASES["draw"])
    runs = {n: partial(device.run, k, calls) for n, k in (kernels | {"base": base}).items()}
    renderer = device.context.info["GL_RENDERER"]
    seconds = interleave(runs, rounds, clock_of(renderer))
    share = 1.0 / (invocations * calls)
    net = {name: less(seconds[name], seconds["base"]) for name in kernels}
    return renderer, {name: [share * each for each in values] for name, values in net.items()}


def path_times(host, rounds, size, made):
    """Seconds of a path of the tracer in each round, by the sampler's name."""
    still = {name: replace(made(sampler), size=size) for name, sampler in TRACED.items()}
    runs = {name: partial(trace, host, each) for name, each in still.items()}
    seconds = interleave(runs, rounds, clock_of(host.identity().device))
    return {
        name: [value / (size * size * still[name].samples) for value in values]
        for name, values in seconds.items()
    }


def with_light(paths, functions):
    """Times of paths, and of those of combined samplers: longer by what their functions add."""
    longer = {
        f"{name} + light": np.add(values, less(functions[f"{name} + light"], functions[name]))
        for name, values in paths.items()
    }
    return paths | longer


def relative(kind, light, variance, times):
    """Figures of variance times time, over the least of those alone, round by round."""
    products = {n: variance[n] * np.asarray(times[n]) for n in variance}
    least = np.min([products[name] for name in SAMPLERS], axis=0)
    return [
        figure(f"{kind}: {light}: {name}", "x", list(np.divide(values, least)))
        for name, values in products.items()
    ]


def measure(rounds=15, invocations=2**14, calls=256, size=128, pictures=48, spokes=20):
    """The `Group` of all lights."""
    renderer, functions = function_times(rounds, invocations, calls)
    host = gl.Host()
    paths = with_light(path_times(host, rounds, size, reflection), functions)
    bounces = path_times(host, rounds, size, scene)
    table = {light.title: variances(light, points(spokes=spokes)) for light in LIGHTS}
    table[SCENE] = traced_variances(host, pictures, size)
    host.close()
    figures = [scaled(f"{FUNCTIONS}: {n}", "ns", values, 1e9) for n, values in functions.items()]
    figures += [scaled(f"{PATHS}: {n}", "ns", values, 1e9) for n, values in paths.items()]
    figures += [scaled(f"{PATHS}, {SCENE}: {n}", "ns", v, 1e9) for n, v in bounces.items()]
    for light, variance in table.items():
        figures += [figure(f"variance: {light}: {n}", "", [v]) for n, v in variance.items()]
        figures += relative(FUNCTIONS, light, variance, functions)
        figures += relative(PATHS, light, variance, bounces if light == SCENE else paths)
    return Group("noise", f"Equal-noise time of sampling on {renderer}", tuple(figures))
