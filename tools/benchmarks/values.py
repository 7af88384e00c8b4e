# SPDX-License-Identifier: Apache-2.0
"""Values of the models a second on one thread, beside those of Mitsuba's LLVM variant.

Mitsuba computes in float32, the models in float64 with NumPy and in float32 with Dr.Jit. Mitsuba's
`eon` is the plugin of `mxeon.mitsuba`; it has no lobe of Schlick's curve or of sheen alone, but `principled` has
both in one. Times are processor time.
"""

import sys
import time
from functools import partial
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from mxeon.albedo import ggx_albedo_dir
from mxeon.errors import NotRun, PackageError
from mxeon.models import (
    conductor_brdf,
    dielectric_brdf,
    eon_brdf,
    fresnel_conductor_avg,
    generalized_schlick_brdf,
    unchecked,
    zeltner_brdf,
)
from tools.benchmarks.models import arguments
from tools.benchmarks.rounds import Check, Group, figure, interleave, ratio

CLOCK = time.process_time
PAIRS = 1_000_000
GOLD = (0.183, 0.421, 1.373), (3.424, 2.346, 1.770)
SECONDS = {"one": 0.5, "own": 3.0}  # of a million pairs of microfacets, by material
COMPENSATION = 1e-10  # of the table of E_ss
PLUGIN = 3e-6  # of pi f cos in float32
LLVM, DRJIT = "Mitsuba, llvm", "arrays of Dr.Jit, llvm"
BARE = "Schlick without compensation"  # which Mitsuba has not
# Models, and Mitsuba's nodes beside them.
NODES = {
    "EON": {"type": "eon", "reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.8]}, "roughness": 0.7},
    "Schlick": {"type": "principled", "roughness": 0.55, "metallic": 1.0},
    "sheen": {"type": "principled", "roughness": 0.7, "sheen": 1.0},
    "conductor": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.3, "material": "Au"},
    "dielectric": {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.3},
}  # fmt: skip
RIVALED = ("EON", "Schlick", "sheen")
GOALS = dict.fromkeys([(name, "one material") for name in RIVALED], 1.0)
GOALS |= dict.fromkeys([(name, DRJIT) for name in (*RIVALED, BARE)], 1.0)
RIVALS = {BARE: "Schlick"}  # of what has none of its own


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


def in_float32(wo, wi):
    """Functions of both directions, with one material."""
    colors, alpha = [0.2, 0.5, 0.8], [0.3, 0.3]
    schlick = partial(generalized_schlick_brdf, wo, wi, colors, 1.0, 1.0, alpha, 5.0)
    return {
        "EON": partial(eon_brdf, wo, wi, colors, 0.7),
        "Schlick": schlick,
        BARE: partial(schlick, compensate=False),
        "sheen": partial(zeltner_brdf, wo, wi, colors, 0.7),
        "dielectric": partial(dielectric_brdf, wo, wi, colors, alpha, 1.5),
    }


def compiled_rivals(wo, wi):
    """Mitsuba's nodes over these pairs in one call, and the models over the same arrays, on one thread."""
    mi = _mitsuba("llvm_ad_rgb")
    import drjit as dr

    dr.set_thread_count(1)
    view, light = (mi.Vector3f(np.ascontiguousarray(w.T)) for w in (wo, wi))
    dr.eval(view, light)
    ways = {}
    for name, node in NODES.items():
        ways[name, LLVM] = _vectorized(mi, dr, mi.load_dict(node), view, light)
    for name, model in in_float32(view, light).items():
        ways[name, DRJIT] = partial(_evaluated, dr, model)
    return ways


def _mitsuba(variant):
    """Mitsuba in a variant, with the plugins."""
    try:
        import mitsuba as mi
    except ImportError:
        raise PackageError("mitsuba is not installed: pip install '.[mitsuba]'") from None

    from mxeon.mitsuba import register

    mi.set_variant(variant)
    register()
    return mi


def _evaluated(dr, model):
    """Values of a model in memory."""
    with unchecked():
        found = model()
    dr.eval(found)
    dr.sync_thread()
    return found


def mitsuba_version():
    """Version of the installed package; "not installed" without it."""
    try:
        return version("mitsuba")
    except PackageNotFoundError:
        return "not installed"


def _vectorized(mi, dr, bsdf, view, light):
    """A call for all pairs, which ends when all values are in memory."""
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(view))
    si.wi, si.t, context = view, 1.0, mi.BSDFContext()
    dr.eval(si)
    return partial(_evaluated, dr, partial(bsdf.eval, context, si, light))


def checks(wo, wi, rivals):
    """Whether the compensation is that of the quadrature, and the plugin's values are EON's."""
    few = slice(0, 500)
    E = ggx_albedo_dir(wo[few, 2], 0.3)[:, np.newaxis]
    factor = 1.0 + fresnel_conductor_avg(*GOLD) * (1.0 - E) / E
    bare = conductor_brdf(wo[few], wi[few], 0.3, *GOLD, compensate=False)
    value = conductor_brdf(wo[few], wi[few], 0.3, *GOLD)
    found = [Check("conductor", float(np.abs(value / (bare * factor) - 1.0).max()), COMPENSATION)]
    exact = np.pi * eon_brdf(wo, wi, [0.2, 0.5, 0.8], 0.7) * wi[:, 2:]
    if ("EON", LLVM) in rivals:
        theirs = np.pi * np.array(rivals["EON", LLVM]()).T
        found.append(Check(f"EON, {LLVM}", float(np.abs(theirs - exact).max()), PLUGIN))
        same = np.pi * np.array(rivals["EON", DRJIT]()).T * wi[:, 2:]
        found.append(Check(f"EON, {DRJIT}", float(np.abs(same - exact).max()), PLUGIN))
    return found


def measure(rounds=3, pairs=PAIRS):
    """The `Group` of values a second, and of the seconds of a million pairs."""
    wo, wi = arguments(pairs, "one")[:2]
    rivals = {(name, "one material"): way for name, way in ours(wo, wi, "one").items()}
    rivals |= {(name, "a material each"): way for name, way in ours(wo, wi, "own").items()}
    try:
        rivals |= compiled_rivals(wo, wi)
    except (NotRun, PackageError) as reason:
        print(f"benchmarks: Mitsuba left out: {reason}", file=sys.stderr)
    seconds = interleave(rivals, rounds, CLOCK)
    # Values a second, and ratios to the fastest rival.
    figures = []
    for (name, way), times in seconds.items():
        rates = [1e-6 * pairs / each for each in times]
        node = f" ({NODES[name]['type']}, {mitsuba_version()})" if way == LLVM else ""
        figures.append(figure(f"{name}, {way}{node}", "million values/s", rates))
        theirs = seconds.get((RIVALS.get(name, name), LLVM))
        if theirs and way in ("one material", DRJIT):
            goal = GOALS.get((name, way))
            figures.append(ratio(f"{name}, {way} / {LLVM}", theirs, times, goal, at_least=True))
    for name in ("conductor", "dielectric"):
        for way, goal in (("one material", SECONDS["one"]), ("a material each", SECONDS["own"])):
            million = [1e6 / pairs * each for each in seconds[name, way]]
            figures.append(figure(f"{name}, {way}, a million pairs", "s", million, goal))
    found = checks(wo, wi, rivals)
    title = "Values a second, one thread, processor time"
    return Group("values", title, tuple(figures), tuple(found))
