# SPDX-License-Identifier: Apache-2.0
"""Errors of `eonlib/genglsl/thin_film.glsl` against all orders and whole averages: python -m fits.thin_film.

The shader sums six orders and a geometric series after them, averages over the hemisphere in five
cosines, or in two, and over the visible facets in four, or in one. Each of these cosines stands for those
around it, whose fringes damp each other. This measures what each costs at most, over films of up to 1000
nm on each kind of substrate. The largest error is searched for: around the worst of random films, in
ever smaller steps.
"""

import numpy as np

from mxeon.conformance.probes.thin_films import LEAST_OIL, SHARP
from mxeon.models.thin_film import formulas as film
from mxeon.models.thin_film.curve import SUBSTRATES, TEXT, film_curve
from mxeon.models.thin_film.lobe import film_albedo_dir

SEED, COUNT = 1, 1 << 9  # films of a step
KEPT, STEPS = 8, (0.1, 0.05, 0.02, 0.01)  # the worst of them; distances from these, of a range of 1
NUMBERS, LEAST = (
    10,
    1e-3,
)  # of a film, its substrate and its view; the least, since 0 reflects nothing
# Each in a range: roughness, cosine of the view, thickness in nm, index.
FILMS = {"alpha": (1e-2, 1.0), "mu": (0.1, 1.0), "thickness": (0.0, 1000.0), "index": (1.0, 2.5)}
CLEAR = {**SHARP, "index": (LEAST_OIL, 2.5)}
STEP = 1e-6  # of a thickness, relative, by which the slope of a curve is measured
# Of the shader, chosen by `thin_film_nodes.py`: the width of five cosines; two cosines, their weights and
# their width; for visible facets, polynomials of the mean of their cosines, of the reach of four nodes
# around it and of their bend; the width of each of four nodes, and of one alone, as parts of the reach.
WIDTH = 0.07
PAIR = ((0.294, 0.785), (0.275, 0.725), 0.165)
STEEP = 0.2
FACETS = (
    (3.0211, -0.024078, -5.4469, 2.4636, 0.016408, 2.3342, -2.7778, -7.803, 8.2627, 0.041009),
    (-0.20527, 4.4118, -5.1988, 0.92353, 3.6844, -7.7366, 3.6534, -2.2933, 3.1415, -0.33986),
    (0.63084, -1.2769, 1.0363, -0.70252, 0.49459, 0.18617, -1.2792, -1.6739, 2.466, -0.3033),
)  # fmt: skip
SHARE, ALONE = 0.22, 0.6
ALIKE = 0.05  # reach below which one node serves
WHITE = {"color82": 1.0, "color90": 1.0}


def substrates(unit):
    """Inputs of the three nodes, by category, from numbers in [0, 1], shape (6, N)."""
    count = unit.shape[1]
    return {
        "dielectric_bsdf": {"ior": 1.0 + 2.0 * unit[0], "tint": np.ones((3, 1))},
        "conductor_bsdf": {"ior": 0.5 + 2.5 * unit[:3], "extinction": 0.2 + 5.8 * unit[3:]},
        "generalized_schlick_bsdf": {
            "color0": unit[:3],
            **{name: np.full((3, count), value) for name, value in WHITE.items()},
            "exponent": np.full(count, 5.0),
        },
    }


def filmed(category, ranges, unit):
    """Inputs of a node under a film, roughness and cosine of a view, from numbers in [0, 1]."""
    alpha, mu, thickness, index = (
        low + (high - low) * each for (low, high), each in zip(ranges.values(), unit, strict=False)
    )
    films = {"thinfilm_thickness": thickness, "thinfilm_ior": index}
    return substrates(unit[4:])[category] | films, alpha, mu


def largest(errors, ranges, category):
    """The largest error of films in ranges that a search finds."""
    rng = np.random.default_rng(SEED)
    unit = rng.random((NUMBERS, COUNT))
    found = errors(category, *filmed(category, ranges, unit))
    for step in STEPS:
        worst = unit[:, np.argsort(found)[-KEPT:]].repeat(COUNT // KEPT // 4, axis=1)
        near = np.clip(worst + step * rng.standard_normal(worst.shape), LEAST, 1.0)
        found = np.append(found, errors(category, *filmed(category, ranges, near)))
        unit = np.append(unit, near, axis=1)
    return float(found.max())


def six_orders(spread):
    """The shader's sum of orders, in the place of `formulas._all_orders`.

    `spread` is the standard deviation of the path differences in m, whose fringes damp each other.
    """

    def series(r, phase, opd, _):
        total = np.zeros((3, *np.broadcast_shapes(r.shape, phase.shape, opd.shape)))
        for k, v, mu, var in film.GAUSSIANS:
            weight = v * np.sqrt(2.0 * np.pi * var) / film.NORMAL
            z = r * np.exp(1j * (2.0 * np.pi * mu * opd + phase))
            decay = var * (2.0 * np.pi * opd) ** 2 + 0.25 * (2.0 * np.pi * mu * spread) ** 4
            orders = sum((z**m).real * np.exp(-decay * m * m) for m in range(1, 7))
            tail = np.exp(-49.0 * decay) * (1.0 - np.exp(-6.0 * decay))
            ratio = np.exp(-15.0 * decay) * (1.0 - r * r * tail)
            rest = np.exp(-49.0 * decay) * (z**7 / (1.0 - ratio * z)).real
            total[k] += weight * (orders + rest)
        return total

    return series


def shader_curve(category, material, mu, width=0.0):
    """`thin_film_fresnel`: the mean of a film's curve over cosines of a standard deviation around mu."""
    n, thickness = material["thinfilm_ior"], material["thinfilm_thickness"]
    mu_t = np.maximum(film.refracted(mu, n), 1e-12)
    all_orders = film._all_orders
    film._all_orders = six_orders(2.0e-9 * thickness * width * mu / (n * mu_t))
    try:
        return film_curve(category).at(mu, **material)
    finally:
        film._all_orders = all_orders


def orders_errors(category, material, _, mu):
    """Errors of the sum, relative to the largest channel."""
    exact = film_curve(category).at(mu, **material)
    short = shader_curve(category, material, mu)
    return (np.abs(short - exact) / exact.max(axis=0)).max(axis=0)


def curve_errors(category, material, _, mu):
    """Errors of the sum."""
    short, exact = shader_curve(category, material, mu), film_curve(category).at(mu, **material)
    return np.abs(short - exact).max(axis=0)


def slopes(category, material, _, mu):
    """Slopes of a curve in the logarithm of the thickness, as which a path difference rounds."""
    curve, thickness = film_curve(category), material["thinfilm_thickness"]
    up, down = (
        curve.at(mu, **{**material, "thinfilm_thickness": thickness * (1.0 + step)})
        for step in (STEP, -STEP)
    )
    return np.abs(up - down).max(axis=0) / (2.0 * STEP)


def wave_slopes(category, material, _, mu):
    """Slopes of a curve in the waves of each Gaussian, whose errors may have any sign."""
    thickness, index = (material[f"thinfilm_{name}"] for name in ("thickness", "ior"))
    opd = film.path_difference(mu, thickness, index)
    substrate = {k: v for k, v in material.items() if k != "tint" and not k.startswith("thinfilm")}
    slopes = 0.0
    for interface in SUBSTRATES[category](mu, index, TEXT, **substrate):
        first, second, phase = interface
        passed = 1.0 - first
        amplitude = passed**2 * second / np.maximum(1.0 - first * second, LEAST) - passed
        for k, v, position, var in film.GAUSSIANS:
            height = (
                np.abs(np.array(TEXT.matrix)[:, k]) * v * np.sqrt(2.0 * np.pi * var) / film.NORMAL
            )
            wave = np.sqrt(first * second) * np.exp(1j * (2.0 * np.pi * position * opd + phase))
            decay = var * (2.0 * np.pi * opd) ** 2
            orders = sum(m * wave**m * np.exp(-decay * m * m) for m in range(1, 30))
            slopes = slopes + height[:, np.newaxis] * np.abs(amplitude * orders)
    return slopes.max(axis=0)


def average_errors(category, material, *_, rule=None):
    """Errors of F_ss in five cosines, or by another rule."""
    exact = film_curve(category).average(**material)
    found = average(category, material, rule or (*gauss(5), WIDTH))
    return np.abs(found - exact).max(axis=0)


def average(category, material, rule):
    """F_ss by a rule: cosines, weights and their width."""
    *rule, width = rule
    return sum(
        weight * shader_curve(category, material, np.asarray(mu), width)
        for mu, weight in zip(*rule, strict=True)
    )


def pair_errors(category, material, *_):
    """Errors of F_ss in two cosines."""
    return average_errors(category, material, rule=PAIR)


def gauss(count):
    """Gauss's rule for 2 F(mu) mu dmu on [0, 1], from the moments 2 / (k + 2)."""
    # Golub and Welsch, for the Jacobi weight 1 + x on [-1, 1].
    k = np.arange(count)
    diagonal = 1.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0))
    j = np.arange(1, count)
    side = np.sqrt(j * (j + 1.0)) / (2.0 * j + 1.0)
    nodes, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(side, 1) + np.diag(side, -1))
    return 0.5 * (1.0 + nodes), vectors[0] ** 2


def visible_errors(category, material, alpha, mu):
    """Errors of the average over the visible facets in four cosines, or in one."""
    exact = visible_average(category, material, alpha, mu)
    return np.abs(visible_mean(category, material, alpha, mu) - exact).max(axis=0)


def visible_average(category, material, alpha, mu):
    """The average over the visible facets, by quadrature of two albedos."""
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    inputs = {name: value.T for name, value in material.items()}
    inputs["roughness"] = np.repeat(alpha[:, np.newaxis], 2, axis=1)
    white = inputs | {"thinfilm_thickness": np.zeros_like(mu)} | MIRRORS[category]
    film, mirror = (
        film_albedo_dir(category, wo, each, compensate=False) for each in (inputs, white)
    )
    return (film / mirror).T


def visible_mean(category, material, alpha, mu, rule=None, count=4):
    """The same in the shader's cosines, or by other coefficients, or in another number of cosines."""
    return sum(
        weight * shader_curve(category, material, cosine, width)
        for cosine, weight, width in _nodes(mu, alpha, rule or (FACETS, SHARE, ALONE), count)
    )


MIRRORS = {
    "dielectric_bsdf": {"ior": np.zeros(1)},
    "conductor_bsdf": {"ior": np.zeros((1, 3))},
    "generalized_schlick_bsdf": dict.fromkeys(("color0", *WHITE), np.ones((1, 3))),
}


def _nodes(mu, alpha, rule, count):
    """Cosines that stand for the visible facets, their weights and widths."""
    coefficients, share, alone = rule
    mean, reach, bend = facets(mu, alpha, coefficients)
    alike = reach < ALIKE
    x, w = np.polynomial.legendre.leggauss(count)
    for node, weight in zip(x, 0.5 * w, strict=True):
        offset = np.where(alike, 0.0, reach * (node + bend * (3.0 * node * node - 1.0)))
        yield np.clip(mean + offset, 0.0, 1.0), weight, np.where(alike, alone, share) * reach


def facets(mu, alpha, coefficients):
    """Mean of the cosines of visible facets with their view, the reach of nodes around it, and their bend."""
    factors = alpha * alpha / (mu + alpha), alpha / np.sqrt(mu + alpha), 1.0
    polynomials = np.reshape(coefficients, (3, -1)) @ monomials(mu, alpha)
    mean, reach, bend = (a * b for a, b in zip(factors, polynomials, strict=True))
    return mu + mean, reach, bend


def monomials(mu, alpha):
    """Those of third degree in the cosine of the view and in alpha / (alpha + 1/5)."""
    y = alpha / (alpha + STEEP)
    return np.stack([mu**i * y**j for i in range(4) for j in range(4 - i)])


# What is measured, by name: errors, and the ranges of films.
MEASURED = {
    "orders": (orders_errors, FILMS),
    "orders of curves": (curve_errors, CLEAR),
    "slope of curves": (slopes, CLEAR),
    "waves of curves": (wave_slopes, CLEAR),
    "F_ss": (average_errors, FILMS),
    "F_ss in two cosines": (pair_errors, FILMS),
    "visible facets": (visible_errors, FILMS),
}


def errors(names):
    """Largest errors by name, each by category."""
    return {
        name: {category: largest(*MEASURED[name], category) for category in MIRRORS}
        for name in names
    }


if __name__ == "__main__":
    for name, found in errors([*MEASURED]).items():
        text = ", ".join(f"{category} {error:.3g}" for category, error in found.items())
        print(f"{name}: {text}")
