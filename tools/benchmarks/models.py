# SPDX-License-Identifier: Apache-2.0
"""The NumPy models on one thread: values a second beside Mitsuba's LLVM variant and `jax.jit`.

Mitsuba computes in float32, the models in float64 with NumPy and in float32 under `jax.jit`. Mitsuba's
`eon` is the plugin of `mxeon.mitsuba`; it has no lobe of Schlick's curve or of sheen alone, but `principled` has
both in one. Times of values a second are processor time.
"""

import sys
import time
from functools import partial

import numpy as np

from mxeon.errors import NotRun, PackageError
from mxeon.models import conductor_brdf, dielectric_brdf, eon_brdf, generalized_schlick_brdf
from mxeon.models.sheen import zeltner_brdf
from tools.benchmarks.rounds import Check, Group, figure, interleave, version_of

VALUES = 1_000_000  # pairs for values per second
COLORS, R = np.array([0.2, 0.5, 0.8]), 0.7  # one material for all pairs
GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)
PLUGIN = 3e-6  # tolerance of pi f cos in float32
ONE, OWN = "one material", "a material each"
LLVM, JIT = "Mitsuba, llvm", "jax.jit, float32"
SECONDS = {ONE: 0.5, OWN: 3.0}  # goals of a million pairs of microfacets
BARE = "Schlick without compensation"  # compared with Mitsuba's Schlick
# Mitsuba's nodes for each model.
NODES = {
    "EON": {"type": "eon", "reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.8]}, "roughness": 0.7},
    "Schlick": {"type": "principled", "roughness": 0.55, "metallic": 1.0},
    "sheen": {"type": "principled", "roughness": 0.7, "sheen": 1.0},
    "conductor": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.3, "material": "Au"},
    "dielectric": {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.3},
}  # fmt: skip
RIVALED = ("EON", "Schlick", "sheen")  # must be as fast as Mitsuba
GOALS = {(name, ONE) for name in RIVALED}


def models(wo, wi, material):
    """Each model over these pairs, with one material for all or one each."""
    rng, count = np.random.default_rng(2), len(wo)
    colors, alpha, r = COLORS, np.array([0.3, 0.3]), R
    (n, k), ior = GOLD, 1.5
    if material == OWN:
        colors, alpha, r = rng.random((count, 3)), rng.random((count, 2)), rng.random(count)
        n, k = rng.uniform(0.1, 3.0, (count, 3)), rng.uniform(0.5, 6.0, (count, 3))
        ior = rng.uniform(1.0, 3.0, count)
    return {
        "EON": partial(eon_brdf, wo, wi, colors, r),
        "Schlick": partial(generalized_schlick_brdf, wo, wi, colors, 1.0, 1.0, alpha, 5.0),
        "sheen": partial(zeltner_brdf, wo, wi, colors, r),
        "conductor": partial(conductor_brdf, wo, wi, alpha, n, k),
        "dielectric": partial(dielectric_brdf, wo, wi, colors, alpha, ior),
    }


def compiled(wo, wi):
    """Mitsuba's nodes over these pairs in one call, on one thread."""
    try:
        import mitsuba as mi
    except ImportError:
        raise PackageError("mitsuba is not installed: pip install '.[mitsuba]'") from None
    from mxeon.mitsuba import register

    mi.set_variant("llvm_ad_rgb")
    register()
    import drjit as dr

    dr.set_thread_count(1)
    view, light = (mi.Vector3f(np.ascontiguousarray(w.T)) for w in (wo, wi))
    si, context = dr.zeros(mi.SurfaceInteraction3f, len(wo)), mi.BSDFContext()
    si.wi, si.t = view, 1.0
    dr.eval(view, light, si)

    def evaluated(way):
        found = way()
        dr.eval(found)
        dr.sync_thread()
        return found

    ways = {
        (name, LLVM): partial(mi.load_dict(node).eval, context, si, light)
        for name, node in NODES.items()
    }
    return {name: partial(evaluated, way) for name, way in ways.items()}


def traced(wo, wi):
    """The models over these pairs with one material, compiled by JAX."""
    try:
        import jax
    except ImportError:
        raise PackageError("JAX is not installed: pip install jax") from None
    view, light = (jax.numpy.asarray(w, jax.numpy.float32) for w in (wo, wi))
    schlick = partial(generalized_schlick_brdf, color0=COLORS, color82=1.0, color90=1.0)
    schlick = partial(schlick, roughness=0.3, exponent=5.0)
    functions = {
        "EON": partial(eon_brdf, rho=COLORS, roughness=R),
        "Schlick": schlick,
        BARE: partial(schlick, compensate=False),
        "sheen": partial(zeltner_brdf, color=COLORS, roughness=R),
    }

    def evaluated(function):
        return function(view, light).block_until_ready()

    return {(name, JIT): partial(evaluated, jax.jit(each)) for name, each in functions.items()}


def measure(rounds=3, pairs=VALUES):
    """The `Group` of values per second and of the seconds for a million pairs."""
    z, phi = np.random.default_rng(1).random((2, 2, pairs)) * [[[1.0]], [[2.0 * np.pi]]]
    S = np.sqrt(1.0 - z * z)
    wo, wi = np.stack([S * np.cos(phi), S * np.sin(phi), z], axis=-1)
    rivals = {
        (name, each): way for each in (ONE, OWN) for name, way in models(wo, wi, each).items()
    }
    for others in (compiled, traced):
        try:
            rivals |= others(wo, wi)
        except (NotRun, PackageError) as reason:
            print(f"benchmarks: left out: {reason}", file=sys.stderr)
    seconds = interleave(rivals, rounds, time.process_time)
    figures = []
    for (name, way), times in seconds.items():
        node = f" ({NODES[name]['type']}, {version_of('mitsuba')})" if way == LLVM else ""
        figures.append(figure(f"{name}, {way}{node}", "million values/s", 1e-6 * pairs / times))
        theirs = seconds.get(("Schlick" if name == BARE else name, LLVM))
        if theirs is not None and way in (ONE, JIT):
            goal = 1.0 if (name, way) in GOALS else None
            figures.append(figure(f"{name}, {way} / {LLVM}", "x", theirs / times, goal, True))
    for name in ("conductor", "dielectric"):
        for way, goal in SECONDS.items():
            million = 1e6 / pairs * seconds[name, way]
            figures.append(figure(f"{name}, {way}, a million pairs", "s", million, goal))
    checks, exact = [], np.pi * eon_brdf(wo, wi, COLORS, R) * wi[:, 2:]
    for way in (LLVM, JIT):
        if ("EON", way) in rivals:
            found = np.array(rivals["EON", way]())
            theirs = np.pi * (found.T if way == LLVM else found * wi[:, 2:])
            checks.append(Check(f"EON, {way}", float(np.abs(theirs - exact).max()), PLUGIN))
    return Group("models", "NumPy models", tuple(figures), tuple(checks))
