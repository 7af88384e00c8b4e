# SPDX-License-Identifier: Apache-2.0
"""Values per second of the models in NumPy (float64, one thread) and in `jax.jit` (float32)."""

import sys
import time
from functools import partial

import numpy as np

from mxeon.models import conductor_brdf, dielectric_brdf, eon_brdf, generalized_schlick_brdf
from mxeon.models.sheen import zeltner_brdf
from tools.benchmarks.rounds import Check, Figure, Group, interleave

VALUES = 1_000_000  # pairs of directions
COLORS, R = np.array([0.2, 0.5, 0.8]), 0.7  # color and roughness of the material ONE
GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)
ROUNDINGS = 3e-6  # tolerance of pi f cos in float32
ONE, OWN, JIT = "one material", "a material each", "jax.jit, float32"
SECONDS = {ONE: 0.5, OWN: 3.0}  # goals for a million pairs of directions in microfacet models


def models(wo, wi, material):
    """Functions that evaluate each model for pairs of directions, by model and material."""
    rng, count = np.random.default_rng(2), len(wo)
    colors, alpha, r = COLORS, np.array([0.3, 0.3]), R
    (n, k), ior = GOLD, 1.5
    if material == OWN:
        colors, alpha, r = rng.random((count, 3)), rng.random((count, 2)), rng.random(count)
        n, k = rng.uniform(0.1, 3.0, (count, 3)), rng.uniform(0.5, 6.0, (count, 3))
        ior = rng.uniform(1.0, 3.0, count)
    functions = {
        "EON": partial(eon_brdf, wo, wi, colors, r),
        "Schlick": partial(generalized_schlick_brdf, wo, wi, colors, 1.0, 1.0, alpha, 5.0),
        "sheen": partial(zeltner_brdf, wo, wi, colors, r),
        "conductor": partial(conductor_brdf, wo, wi, alpha, n, k),
        "dielectric": partial(dielectric_brdf, wo, wi, colors, alpha, ior),
    }
    return {(name, material): each for name, each in functions.items()}


def traced(wo, wi):
    """Functions that evaluate each model with one material, compiled by JAX if JAX is installed."""
    try:
        import jax
    except ImportError:
        print("benchmarks: left out: JAX is not installed: pip install jax", file=sys.stderr)
        return {}
    view, light = (jax.numpy.asarray(w, jax.numpy.float32) for w in (wo, wi))
    schlick = partial(generalized_schlick_brdf, color0=COLORS, color82=1.0, color90=1.0)
    functions = {
        "EON": partial(eon_brdf, rho=COLORS, roughness=R),
        "Schlick": partial(schlick, roughness=0.3, exponent=5.0),
        "sheen": partial(zeltner_brdf, color=COLORS, roughness=R),
    }

    def evaluated(function):
        return function(view, light).block_until_ready()

    return {(name, JIT): partial(evaluated, jax.jit(each)) for name, each in functions.items()}


def measure(rounds=3, pairs=VALUES):
    """Measure values per second and seconds per million pairs."""
    z, phi = np.random.default_rng(1).random((2, 2, pairs)) * [[[1.0]], [[2.0 * np.pi]]]
    S = np.sqrt(1.0 - z * z)
    wo, wi = np.stack([S * np.cos(phi), S * np.sin(phi), z], axis=-1)
    functions = models(wo, wi, ONE) | models(wo, wi, OWN) | traced(wo, wi)
    seconds = interleave(functions, rounds, time.process_time)
    figures = [
        Figure(f"{name}, {variant}", "million values/s", 1e-6 * pairs / times)
        for (name, variant), times in seconds.items()
    ]
    for name in ("conductor", "dielectric"):
        for variant, goal in SECONDS.items():
            million = 1e6 / pairs * seconds[name, variant]
            figures.append(Figure(f"{name}, {variant}, a million pairs", "s", million, goal))
    checks = []
    if ("EON", JIT) in functions:
        difference = np.array(functions["EON", JIT]()) - eon_brdf(wo, wi, COLORS, R)
        error = float(np.abs(np.pi * wi[:, 2:] * difference).max())
        checks.append(Check(f"EON, {JIT}", error, ROUNDINGS))
    return Group("NumPy models", figures, checks)
