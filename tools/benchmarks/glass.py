# SPDX-License-Identifier: Apache-2.0
"""Random walks through a rough glass ball in a white furnace, sampled by eonlib's GLSL.

    python -m tools.benchmarks.glass

The expected weight of a walk is 1. A ray inside a ball meets the surface at equal angles at both
ends, so samples can be chained without tracing rays. Weights omit the factor IOR^2 by which
refraction scales radiance.
"""

import numpy as np

from mxeon.conformance.checks.paths import paths
from mxeon.hosts import open_engine
from mxeon.shaders.nodes import document_text, input_text, material_text, node_text

WALKS, BOUNCES = 1 << 16, 256
ROUGH = 0.4  # alpha, which is roughness squared


def glass(node, **inputs):
    """A document with a surface shader that only transmits."""
    inputs = {"specular_roughness": ROUGH**0.5} | inputs
    ports = "".join(input_text(name, "float", value) for name, value in inputs.items())
    return document_text(node_text(node, "surfaceshader", "shading", ports))


def lobe(node, alpha, **inputs):
    return material_text(node, {"roughness": (alpha, alpha), "scatter_mode": "RT"} | inputs)


ROWS = {
    **{f"dielectric_bsdf, {a}": lobe("dielectric_bsdf", a, ior=1.5) for a in (0.1, ROUGH, 1.0)},
    f"generalized_schlick_bsdf, {ROUGH}": lobe(
        "generalized_schlick_bsdf", ROUGH, color0=(0.04, 0.04, 0.04)
    ),
    f"standard_surface, {ROUGH}": glass("standard_surface", transmission=1.0),
    f"open_pbr_surface, {ROUGH}": glass("open_pbr_surface", transmission_weight=1.0),
}


def walks(text, rng):
    """Total weights of walks that start in a parallel beam, and the largest weight of a bounce."""
    mu = np.sqrt(rng.random(WALKS))
    total, largest, active = np.zeros(WALKS), 0.0, np.arange(WALKS)
    weights, inside = np.ones(WALKS), False
    for _ in range(BOUNCES):
        wo = np.stack([np.sqrt(1.0 - mu**2), 0.0 * mu, mu], axis=1)
        u = rng.integers(0, 1 << 24, (len(mu), 3)) * 2.0**-24
        wi, weight = (text.values(what, wo, u=u, inside=inside) for what in ("wi", "weight"))
        weight = weight[:, 0]
        largest = max(largest, weight.max())
        weights = weights * weight
        leaves = (wi[:, 2] < 0.0) if inside else (wi[:, 2] > 0.0)
        total[active[leaves]] = weights[leaves]
        stays = ~leaves & (weights > 0.0)
        active, weights, mu, inside = active[stays], weights[stays], np.abs(wi[stays, 2]), True
        if not len(active):
            break
    return total, largest


if __name__ == "__main__":
    # The table has the mean and the standard deviation of a walk's weight, and the largest weight
    # of a sample.
    print("| node, alpha | mean | deviation | largest draw |\n|---|---|---|---|")
    for name, document in ROWS.items():
        total, largest = walks(paths(open_engine("gl"), document), np.random.default_rng(1))
        print(f"| {name} | {total.mean():.3g} | {total.std():.3g} | {largest:.3g} |")
