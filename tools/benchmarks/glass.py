# SPDX-License-Identifier: Apache-2.0
"""Walks through a rough ball of glass in a white furnace, drawn by eonlib's text.

    python -m tools.benchmarks.glass

The right weight of a walk is 1. On a sphere, light meets the surface again at the angle at which it left it, so a walk
is a chain of draws. Radiance lacks the factor of the squared index.
"""

import numpy as np

from mxeon.conformance.checks.paths import paths
from mxeon.hosts import open_engine
from mxeon.shaders.nodes import material_text

WALKS, BOUNCES, INDEX = 1 << 16, 256, 1.5
ALPHAS = (0.1, 0.4, 1.0)


def eonlib(alpha):
    """A function that draws directions and weights by eonlib's text."""
    inputs = {"ior": INDEX, "roughness": (alpha, alpha), "scatter_mode": "RT"}
    text = paths(open_engine("gl"), material_text("dielectric_bsdf", inputs))

    def draw(wo, u, inside):
        wi, weight = (text.values(what, wo, u=u, inside=inside) for what in ("wi", "weight"))
        return wi, weight[:, 0]

    return draw


def walks(draw, rng):
    """Weights of walks from a parallel beam, and the largest weight of a draw."""
    mu = np.sqrt(rng.random(WALKS))
    total, largest, active = np.zeros(WALKS), 0.0, np.arange(WALKS)
    weights, inside = np.ones(WALKS), False
    for _ in range(BOUNCES):
        wo = np.stack([np.sqrt(1.0 - mu**2), 0.0 * mu, mu], axis=1)
        wi, weight = draw(wo, rng.integers(0, 1 << 24, (len(mu), 3)) * 2.0**-24, inside)
        largest = max(largest, weight.max())
        weights = weights * weight
        left = (wi[:, 2] < 0.0) if inside else (wi[:, 2] > 0.0)
        total[active[left]] = weights[left]
        kept = ~left & (weights > 0.0)
        active, weights, mu, inside = active[kept], weights[kept], np.abs(wi[kept, 2]), True
        if not len(active):
            break
    return total, largest


def main():
    """Print a table of Markdown: mean and standard deviation of a walk, and the largest draw."""
    print("| alpha | mean | deviation | largest draw |\n|---|---|---|---|")
    for alpha in ALPHAS:
        total, largest = walks(eonlib(alpha), np.random.default_rng(1))
        print(f"| {alpha} | {total.mean():.3g} | {total.std():.3g} | {largest:.3g} |")


if __name__ == "__main__":
    main()
