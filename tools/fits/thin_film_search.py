# SPDX-License-Identifier: Apache-2.0
"""Films of three kinds of substrate from numbers in [0, 1], and a search for the largest error among them."""

import numpy as np
from scipy.optimize import differential_evolution

SEED, COUNT, GENERATIONS = 1, 1 << 9, 100  # films per step; steps of evolution
KEPT, STEPS = 8, (0.1, 0.05, 0.02, 0.01)  # worst films to keep; distances from them in [0, 1]
NUMBERS = 10  # numbers that describe a film, its substrate and its view
COLORED = 17  # NUMBERS plus color82, color90 and the exponent of Schlick's curve
FAR = (0.3, 0.1, 0.1, 0.05, 0.05, 0.02, 0.01)  # distances with COLORED numbers
MOVED = 0.3  # share of the COLORED numbers that change
LEAST = 1e-3  # least value of numbers except roughness, cosine and extinction: 0 reflects nothing
# The worst films of longer searches, which random starts miss: of a metal with total reflection in the film,
# and of glass at grazing, both with fringes of 1000 nm.
GLASS = (0.0298, 0.001, 1.0, 0.0462, *[0.3587] * 6)
CORNERS = {
    "dielectric_bsdf": GLASS,
    "conductor_bsdf": (0.2061, 0.0314, 1.0, 0.1054, *[0.0959] * 3, *[0.0] * 3),
    "generalized_schlick_bsdf": GLASS,
}
WHITE = {"color82": 1.0, "color90": 1.0}


def substrates(unit):
    """Inputs of the three nodes, by category, from numbers in [0, 1], shape (6, N) or (13, N)."""
    count = unit.shape[1]
    edges = {name: np.full((3, count), value) for name, value in WHITE.items()}
    edges["exponent"] = np.full(count, 5.0)
    if len(unit) > 6:
        edges = {"color82": unit[6:9], "color90": unit[9:12], "exponent": 1.0 + 9.0 * unit[12]}
    return {
        "dielectric_bsdf": {"ior": 1.0 + 2.0 * unit[0], "tint": np.ones((3, 1))},
        "conductor_bsdf": {"ior": 0.5 + 2.5 * unit[:3], "extinction": 0.2 + 5.8 * unit[3:6]},
        "generalized_schlick_bsdf": {"color0": unit[:3], **edges},
    }


def filmed(category, ranges, unit):
    """Inputs of a node under a film, roughness and cosine of a view, from numbers in [0, 1]."""
    alpha, mu, thickness, index = (
        low + (high - low) * each for (low, high), each in zip(ranges.values(), unit, strict=False)
    )
    films = {"thinfilm_thickness": thickness, "thinfilm_ior": index}
    return substrates(unit[4:])[category] | films, alpha, mu


def largest(errors, ranges, category, numbers=NUMBERS):
    """The largest error of films in ranges, by a search.

    It searches around the worst random films and a corner in decreasing steps, and then evolves the worst of
    these. For films with more numbers, more films are kept, and each only changes some of its numbers.
    """
    rng = np.random.default_rng(SEED)
    many = numbers > NUMBERS
    count, kept, steps = (4 * COUNT, 4 * KEPT, FAR) if many else (COUNT, KEPT, STEPS)
    least = np.full((numbers, 1), LEAST)
    least[[0, 1, *range(7, 10)]] = 0.0

    def of(unit):
        return errors(category, *filmed(category, ranges, unit))

    unit = rng.random((numbers, count))
    unit[:NUMBERS, 0] = CORNERS[category]
    found = of(unit)
    for step in steps:
        worst = unit[:, np.argsort(found)[-kept:]].repeat(count // kept // 4, axis=1)
        way = step * rng.standard_normal(worst.shape)
        if many:
            way *= rng.random(worst.shape) < MOVED
        near = np.clip(worst + way, least, 1.0)
        found = np.append(found, of(near))
        unit = np.append(unit, near, axis=1)
    evolved = differential_evolution(
        lambda unit: -of(np.maximum(unit, least)),
        [(0.0, 1.0)] * numbers,
        init=np.append(unit[:, np.argsort(found)[-kept:]], unit[:, : count // 4], axis=1).T,
        maxiter=GENERATIONS, seed=SEED, vectorized=True, updating="deferred", polish=False,
    )  # fmt: skip
    return -float(evolved.fun)
