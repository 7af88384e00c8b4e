# SPDX-License-Identifier: Apache-2.0
"""Values of the models a second on one thread, beside Mitsuba's scalar and LLVM variants.

Mitsuba computes in float32, the models in float64. Its `eon` is the plugin of `mxeon.mitsuba`; it has no
lobe of Schlick's curve or of sheen alone, but `principled` has both in one. Times are processor time.
"""

import sys
import time
from functools import partial
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from benchmarks.models import arguments
from benchmarks.rounds import Check, Group, figure, interleave, ratio
from mxeon.albedo import ggx_albedo_dir
from mxeon.errors import NotRun, PackageError
from mxeon.models import (
    conductor_brdf,
    dielectric_brdf,
    eon_brdf,
    fresnel_conductor_avg,
    generalized_schlick_brdf,
    zeltner_brdf,
)

PAIRS, CALLS = 1_000_000, 500  # of arrays; of calls for one pair each
GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)
SECONDS = {"one": 0.5, "own": 3.0}  # of a million pairs of microfacets, by material
COMPENSATION = 1e-10  # of the table of E_ss
PLUGIN = 3e-6  # of pi f cos in float32
LLVM, SCALAR = "Mitsuba, llvm", "Mitsuba, scalar"
PASS = "the sum wo + wi", "one pass of NumPy"
# Models, and Mitsuba's nodes beside them.
NODES = {
    "EON": {"type": "eon", "reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.8]}, "roughness": 0.7},
    "Schlick": {"type": "principled", "roughness": 0.55, "metallic": 1.0},
    "sheen": {"type": "principled", "roughness": 0.7, "sheen": 1.0},
    "conductor": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.3, "material": "Au"},
    "dielectric": {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.3},
}  # fmt: skip
RIVALED = ("EON", "Schlick", "sheen")


def ours(wo, wi, material):
    """Each model over these pairs, with one material for all or one each."""
    rng, count = np.random.default_rng(2), len(wo)
    colors, alpha, r = np.array([0.2, 0.5, 0.8]), np.array([0.3, 0.3]), 0.7
    (n, k), ior = GOLD, 1.5
    if material == "own":
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


def mitsuba_rivals(wo, wi, calls):
    """Mitsuba's nodes over these pairs in one call, and over `calls` of them one by one."""
    try:
        import mitsuba as mi
    except ImportError:
        raise PackageError("mitsuba is not installed: pip install 'mxeon[mitsuba]'") from None
    import drjit as dr

    from mxeon.mitsuba import register

    # One pair a call.
    ways = {}
    mi.set_variant("scalar_rgb")
    register()
    for name, node in NODES.items():
        ways[name, SCALAR] = _scalar(mi, mi.load_dict(node), wo[:calls], wi[:calls])
    # All pairs in one call, on one thread.
    mi.set_variant("llvm_ad_rgb")
    register()
    dr.set_thread_count(1)
    for name, node in NODES.items():
        ways[name, LLVM] = _vectorized(mi, dr, mi.load_dict(node), wo, wi)
    return ways


def mitsuba_version():
    """Version of the installed package; "not installed" without it."""
    try:
        return version("mitsuba")
    except PackageNotFoundError:
        return "not installed"


def _scalar(mi, bsdf, wo, wi):
    """A call for each pair, in Mitsuba's words si.wi and wo."""
    context, pairs = mi.BSDFContext(), []
    for view, light in zip(wo, wi, strict=True):
        si = mi.SurfaceInteraction3f()
        si.wi, si.t = mi.Vector3f(*view), 1.0
        pairs.append((si, mi.Vector3f(*light)))

    def values():
        mi.set_variant("scalar_rgb")  # which the plugin takes its types from
        return [bsdf.eval(context, si, light) for si, light in pairs]

    return values


def _vectorized(mi, dr, bsdf, wo, wi):
    """A call for all pairs, which ends when all values are in memory."""
    si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
    si.wi, si.t = mi.Vector3f(np.ascontiguousarray(wo.T)), 1.0
    light, context = mi.Vector3f(np.ascontiguousarray(wi.T)), mi.BSDFContext()
    dr.eval(si, light)

    def values():
        mi.set_variant("llvm_ad_rgb")
        found = bsdf.eval(context, si, light)
        dr.eval(found)
        dr.sync_thread()
        return found

    return values


def checks(wo, wi, rivals):
    """Whether the compensation is that of the quadrature, and the plugin's values are EON's."""
    few = slice(0, 500)
    E = ggx_albedo_dir(wo[few, 2], 0.3)[:, np.newaxis]
    factor = 1.0 + fresnel_conductor_avg(*GOLD) * (1.0 - E) / E
    bare = conductor_brdf(wo[few], wi[few], 0.3, *GOLD, compensate=False)
    value = conductor_brdf(wo[few], wi[few], 0.3, *GOLD)
    found = [Check("conductor", float(np.abs(value / (bare * factor) - 1.0).max()), COMPENSATION)]
    if ("EON", LLVM) in rivals:
        theirs = np.pi * np.array(rivals["EON", LLVM]()).T
        exact = np.pi * eon_brdf(wo, wi, [0.2, 0.5, 0.8], 0.7) * wi[:, 2:]
        found.append(Check(f"EON, {LLVM}", float(np.abs(theirs - exact).max()), PLUGIN))
    return found


def measure(rounds=3, pairs=PAIRS, calls=CALLS):
    """The `Group` of values a second, and of the seconds of a million pairs."""
    wo, wi = arguments(pairs, "one")[:2]
    rivals = {(name, "one material"): way for name, way in ours(wo, wi, "one").items()}
    rivals |= {(name, "a material each"): way for name, way in ours(wo, wi, "own").items()}
    rivals[PASS] = partial(np.add, wo, wi)
    try:
        rivals |= mitsuba_rivals(wo, wi, min(calls, pairs))
    except (NotRun, PackageError) as reason:
        print(f"benchmarks: no rivals of Mitsuba: {reason}", file=sys.stderr)
    seconds = interleave(rivals, rounds, time.process_time)
    # Values a second, and ratios to the fastest rival.
    figures = []
    for (name, way), times in seconds.items():
        count = min(calls, pairs) if way == SCALAR else pairs
        rates = [1e-6 * count / each for each in times]
        node = f" ({NODES[name]['type']}, {mitsuba_version()})" if way in (LLVM, SCALAR) else ""
        figures.append(figure(f"{name}, {way}{node}", "million values/s", rates))
    for name in NODES:
        if (name, LLVM) in seconds:
            goal = 1.0 if name in RIVALED else None
            label = f"{name}, one material / {LLVM}"
            theirs, own = seconds[name, LLVM], seconds[name, "one material"]
            figures.append(ratio(label, theirs, own, goal, at_least=True))
    for name in ("conductor", "dielectric"):
        for way, goal in (("one material", SECONDS["one"]), ("a material each", SECONDS["own"])):
            million = [1e6 / pairs * each for each in seconds[name, way]]
            figures.append(figure(f"{name}, {way}, a million pairs", "s", million, goal))
    return Group(
        "values",
        "Values a second, one thread, processor time",
        tuple(figures),
        tuple(checks(wo, wi, rivals)),
    )
