# SPDX-License-Identifier: Apache-2.0
"""Errors of `genglsl/thin_film.glsl` against all orders and whole averages: python -m fits.thin_film.

The shader sums six orders and a geometric series after them, averages over the hemisphere in six
cosines and over the visible facets in nine. Nothing is fitted; this measures what each costs, over random
films of up to 1000 nm on each kind of substrate.
"""

import numpy as np

from mxeon.models.microfacet.ggx_formulas import smith_lambda
from mxeon.models.thin_film import formulas as film
from mxeon.models.thin_film.curve import film_curve
from mxeon.models.thin_film.lobe import film_albedo_dir

SEED, COUNT, VIEWS = 1, 1 << 12, 1 << 8
LEAST_COSINE, LEAST_ALPHA = 0.1, 1e-2
WHITE = {"color82": 1.0, "color90": 1.0}


def substrates(rng, count):
    """Random inputs of the three nodes, by category."""
    color = 0.2 + 2.8 * rng.random((3, count))
    return {
        "dielectric_bsdf": {"ior": 1.0 + 2.0 * rng.random(count), "tint": np.ones((3, 1))},
        "conductor_bsdf": {"ior": color, "extinction": 0.2 + 5.8 * rng.random((3, count))},
        "generalized_schlick_bsdf": {
            "color0": rng.random((3, count)),
            **{name: np.full((3, count), value) for name, value in WHITE.items()},
            "exponent": np.full(count, 5.0),
        },
    }


def films(rng, count):
    """Random films."""
    return {
        "thinfilm_thickness": 1000.0 * rng.random(count),
        "thinfilm_ior": 1.0 + 1.5 * rng.random(count),
    }


def six_orders(r, phase, opd, _):
    """The shader's sum of orders, in the place of `thin_film_formulas._all_orders`."""
    total = np.zeros((3, *np.broadcast_shapes(r.shape, phase.shape, opd.shape)))
    for k, v, mu, var in film.GAUSSIANS:
        weight = v * np.sqrt(2.0 * np.pi * var) / film.NORMAL
        z = r * np.exp(1j * (2.0 * np.pi * mu * opd + phase))
        decay = var * (2.0 * np.pi * opd) ** 2
        orders = sum((z**m).real * np.exp(-decay * m * m) for m in range(1, 7))
        tail = np.exp(-49.0 * decay) * (1.0 - np.exp(-6.0 * decay))
        ratio = np.exp(-15.0 * decay) * (1.0 - r * r * tail)
        rest = np.exp(-49.0 * decay) * (z**7 / (1.0 - ratio * z)).real
        total[k] += weight * (orders + rest)
    return total


def orders_error(category, material, mu):
    """Largest error of the sum, relative to the largest channel."""
    curve = film_curve(category)
    exact = curve.at(mu, **material)
    all_orders, film._all_orders = film._all_orders, six_orders
    try:
        short = curve.at(mu, **material)
    finally:
        film._all_orders = all_orders
    return float((np.abs(short - exact) / exact.max(axis=0)).max())


def average_error(category, material):
    """Largest error of F_ss in six cosines."""
    x, w = _gauss(6)
    curve = film_curve(category)
    average = sum(
        weight * curve.at(np.asarray(mu), **material) for mu, weight in zip(x, w, strict=True)
    )
    return float(np.abs(average - curve.average(**material)).max())


def _gauss(count):
    """Gauss's rule for 2 F(mu) mu dmu on [0, 1], from the moments 2 / (k + 2)."""
    # Golub and Welsch, for the Jacobi weight 1 + x on [-1, 1].
    k = np.arange(count)
    diagonal = 1.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0))
    j = np.arange(1, count)
    side = np.sqrt(j * (j + 1.0)) / (2.0 * j + 1.0)
    nodes, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(side, 1) + np.diag(side, -1))
    return 0.5 * (1.0 + nodes), vectors[0] ** 2


def visible_error(category, material, rng):
    """Largest error of the average over the visible facets in nine of them."""
    mu = LEAST_COSINE + (1.0 - LEAST_COSINE) * rng.random(VIEWS)
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    alpha = LEAST_ALPHA ** rng.random(VIEWS)
    few = {name: value[..., :VIEWS] for name, value in material.items()}
    inputs = {name: value.T for name, value in few.items()}
    inputs["roughness"] = np.repeat(alpha[:, np.newaxis], 2, axis=1)
    white = inputs | {"thinfilm_thickness": np.zeros(VIEWS)} | MIRRORS[category]
    exact = [film_albedo_dir(category, wo, each, compensate=False) for each in (inputs, white)]
    total, weights = 0.0, 0.0
    for cosine, weight in _facets(wo, alpha):
        total += weight * film_curve(category).at(np.clip(cosine, 0.0, 1.0), **few)
        weights += weight
    return float(np.abs(total / weights - (exact[0] / exact[1]).T).max())


MIRRORS = {
    "dielectric_bsdf": {"ior": np.zeros(1)},
    "conductor_bsdf": {"ior": np.zeros((1, 3))},
    "generalized_schlick_bsdf": {"color0": np.ones((1, 3))},
}


def _facets(wo, alpha):
    """Cosines of nine visible facets with their view, and their weights."""
    x, w = np.polynomial.legendre.leggauss(3)
    stretched = wo * np.stack([alpha, alpha, np.ones_like(alpha)], axis=-1)
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    for u, height in zip(0.5 * (1.0 + x), w, strict=True):
        for azimuth in np.pi * (np.arange(3) + 0.5) / 3.0:
            z = (1.0 - u) * (1.0 + stretched[:, 2]) - stretched[:, 2]
            radius = np.sqrt(np.clip(1.0 - z * z, 0.0, 1.0))
            columns = [radius * np.cos(azimuth), radius * np.sin(azimuth), z]
            H = np.stack(columns, axis=-1) + stretched
            H *= np.stack([alpha, alpha, np.ones_like(alpha)], axis=-1)
            H /= np.linalg.norm(H, axis=1, keepdims=True)
            c = (wo * H).sum(axis=1)
            mu_i = np.maximum(2.0 * c * H[:, 2] - wo[:, 2], 0.0)
            smith = smith_lambda(wo[:, 2], alpha) * mu_i + smith_lambda(mu_i, alpha) * wo[:, 2]
            yield c, height * 2.0 * mu_i * wo[:, 2] / smith


def errors():
    """Largest errors by category: of the orders, of F_ss and of the visible facets."""
    rng = np.random.default_rng(SEED)
    result = {}
    for category, material in substrates(rng, COUNT).items():
        material |= films(rng, COUNT)
        mu = LEAST_COSINE + (1.0 - LEAST_COSINE) * rng.random(COUNT)
        few = {name: value[..., :VIEWS] for name, value in material.items()}
        result[category] = (
            orders_error(category, material, mu),
            average_error(category, few),
            visible_error(category, material, rng),
        )
    return result


if __name__ == "__main__":
    for name, (orders, average, visible) in errors().items():
        print(f"{name}: orders {orders:.2g}, F_ss {average:.2g}, visible facets {visible:.2g}")
