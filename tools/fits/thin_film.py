# SPDX-License-Identifier: Apache-2.0
"""Errors of `genglsl/lib/thin_film.glsl`, compared with all interference orders and exact averages.

    python -m tools.fits.thin_film

The shader omits negligible orders, and averages over the hemisphere or over visible facets by a sum
over three cosines. Each cosine represents a range of cosines in which fringes partly cancel. The
script prints the largest errors for cosines of at least 0.1 and for films of up to 1000 nm on each
kind of substrate.

A check measures the root mean square error of a set of random films. The tolerance of the check is
the largest root mean square error of other sets, and is at most a third of the largest error of a
film. So the check can detect a wrong digit that changes every film by less than the largest error.
"""

import numpy as np
from scipy.optimize import differential_evolution

from mxeon.conformance.checks.microfacets import SMOOTH
from mxeon.conformance.samples import SEED as DRAWN
from mxeon.conformance.specs import microfacets
from mxeon.conformance.specs.microfacets import LEAST_FILM, LEAST_OIL, SHARP
from mxeon.models import thin_film as film
from mxeon.models.microfacet.ggx import ggx_albedo_dir
from mxeon.models.thin_film import SUBSTRATES, TEXT, film_albedo_dir, film_curve

# Ranges of alpha, of the cosine of wo, and of the thickness in nm and the IOR of a film.
FILMS = {"alpha": (1e-2, 1.0), "mu": (0.1, 1.0), "thickness": (0.0, 1000.0), "index": (1.0, 2.5)}
BARE = FILMS | {"thickness": (0.0, 0.0), "index": (1.0, 1.0)}
VISIBLE = FILMS | {"index": (LEAST_FILM, 2.5)}
CLEAR = dict(alpha=SHARP.alpha, mu=SHARP.mu, thickness=SHARP.thickness, index=(LEAST_OIL, 2.5))
DARK = 1e-3  # lower limit of the divisor of relative errors
STEP = 1e-6  # relative change of the thickness for difference quotients
# The shader's constants, fitted by `thin_film_nodes.py`. NODES has the cosines, the weights and the
# widths of the nodes for F_ss. FACETS has the coefficients of the polynomials in `facets`.
NODES = (
    (0.17999, 0.55701, 0.88292),
    (0.10982, 0.43737, 0.4528),
    (0.19938, 0.13743, 0.088681),
)
STEEP = 0.2
FACETS = (
    (3.252, -0.91173, -4.1529, 1.7917, -0.12447, 2.405, -2.6953, -7.6708, 8.1838, 0.0010818),
    (0.32298, 3.3428, -4.255, 0.51298, 3.6133, -7.43, 3.3391, -2.597, 3.5172, -0.34239),
    (0.14542, 0.030955, -0.22576, -0.22374, 1.0328, -1.4779, 0.16285, -1.7185, 2.1385, 0.018052),
)  # fmt: skip
# The shader sums an interference order if the order's squared amplitude exceeds both VALUE_ORDER
# times the sum of squared mean reflectances and WIDTH_ORDER times the squared width of a node. From
# order to order, squared amplitudes are assumed to change by a factor of at most ORDER_RATIO.
VALUE_ORDER, WIDTH_ORDER, ORDER_RATIO = 8e-14, 1e-3, 0.6
NARROWEST = min(film.GAUSSIANS, key=lambda gaussian: gaussian[3])
LEAST_PATH = 1e-21  # m
LEAST_LOSS = 1e-12
SEED, COUNT, GENERATIONS = 1, 1 << 9, 100  # COUNT films per step of the search
WORST, STEPS = 8, (0.1, 0.05, 0.02, 0.01)  # number of films to vary, and sizes of the steps
NUMBERS = 10  # numbers that describe a film, the substrate, alpha and the cosine of wo
COLORED = 17  # NUMBERS, plus 7 for color82, color90 and the exponent of Schlick's curve
FAR = (0.3, 0.1, 0.1, 0.05, 0.05, 0.02, 0.01)  # step sizes for films that COLORED numbers describe
MOVED = 0.3  # fraction of the COLORED numbers that change in a step
LEAST = 1e-3  # lower limit of a film's numbers, except of alpha, cosine and extinction
# Films of 1000 nm with large errors, which longer searches found and random starts miss. GLASS is a
# film on glass at a grazing angle. The film on a metal has total reflection inside the film.
GLASS = (0.0298, 0.001, 1.0, 0.0462, *[0.3587] * 6)
CORNERS = {
    "dielectric_bsdf": GLASS,
    "conductor_bsdf": (0.2061, 0.0314, 1.0, 0.1054, *[0.0959] * 3, *[0.0] * 3),
    "generalized_schlick_bsdf": GLASS,
}
WHITE = {"color82": 1.0, "color90": 1.0}


def shader_curve(category, material, mu, width=0.0):
    """The shader's mean reflectance over cosines with mean mu and standard deviation `width`."""
    films = (material[f"thinfilm_{name}"] for name in ("thickness", "ior"))
    mu, thickness, n = np.broadcast_arrays(mu, *films)
    opd = film.path_difference(mu, thickness, n)
    spread = (2.0 * film.METERS * thickness) ** 2 * width * mu / np.maximum(opd, LEAST_PATH)
    interfaces = SUBSTRATES[category](mu, n, TEXT, **substrate(material))
    # `means` are reflectances averaged over phases. `weights` and `sizes` determine the amplitudes
    # of orders.
    R, S = (
        np.stack(each)
        for each in zip(*(np.broadcast_arrays(r**2, R23) for r, _, R23 in interfaces), strict=True)
    )
    loss, sizes = np.maximum(1.0 - R * S, LEAST_LOSS), np.sqrt(R * S)
    means, weights = R + (1.0 - R) ** 2 * S / loss, (1.0 - R) * (1.0 - S) / loss
    bright = 3.0 * ((0.5 * means.sum(axis=0)) ** 2).mean(axis=0)
    least = np.maximum(VALUE_ORDER * bright, WIDTH_ORDER * np.square(width))
    count = order_count(weights, sizes, opd, spread, least)
    xyz = sum(
        mean - 2.0 * weight * counted_orders(r12 * (x + 1j * y), opd, spread, count)
        for mean, weight, (r12, (x, y), _) in zip(means, weights, interfaces, strict=True)
    )
    return np.clip(film.to_rgb(0.5 * xyz, TEXT), 0.0, 1.0)


def substrate(material):
    """A node's inputs except the film and the tint."""
    return {k: v for k, v in material.items() if k != "tint" and not k.startswith("thinfilm")}


def counted_orders(z, opd, spread, count):
    """Sums of the first `count` interference orders for X, Y and Z, (3, ...).

    `spread`, the standard deviation of the path differences in m, damps the fringes.
    """
    total = np.zeros((3, *np.broadcast_shapes(z.shape, opd.shape)))
    for k, v, mu, var in film.GAUSSIANS:
        height = v * np.sqrt(2.0 * np.pi * var) / film.NORMAL
        wave, fade = z * np.exp(2j * np.pi * mu * opd), np.exp(-decay(mu, var, opd, spread))
        # The term of order m is height wave^m fade^(m^2).
        order, step = height * wave * fade, wave * fade**3
        for m in range(1, int(count.max()) + 1):
            total[k] += np.where(m <= count, order.real, 0.0)
            order, step = order * step, step * fade * fade
    return total


def decay(mu, var, opd, spread):
    """Decay exponent of the first order for a Gaussian sensitivity and a spread of paths."""
    return var * (2.0 * np.pi * opd) ** 2 + 0.25 * (2.0 * np.pi * mu * spread) ** 4


def order_count(weights, sizes, opd, spread, least):
    """Number of orders that the shader sums, at least 1.

    Reflectances are largest for s-polarized light, and transmittances for p-polarized light.
    """
    k2 = np.exp(-2.0 * decay(*NARROWEST[2:], opd, spread))
    along_p, along_s = weights[0], sizes[1]
    largest, first = ((each**2).max(axis=0) for each in (along_s, along_p * along_s))
    ratio, order = np.minimum(largest * k2**3, ORDER_RATIO), first * k2
    count = np.ones_like(order)
    while np.any(order * ratio > least):
        order, ratio = order * ratio, ratio * k2 * k2
        count += order > least
    return count


def orders_errors(category, material, alpha, mu):
    """`curve_errors` divided by max(DARK, largest channel of the exact reflectance)."""
    largest = film_curve(category).at(mu, **material).max(axis=0)
    return curve_errors(category, material, alpha, mu) / np.maximum(largest, DARK)


def curve_errors(category, material, _, mu):
    exact = film_curve(category).at(mu, **material)
    return np.abs(shader_curve(category, material, mu) - exact).max(axis=0)


def slopes(category, material, _, mu):
    """Derivatives of the reflectance with respect to log(thickness)."""
    curve, thickness = film_curve(category), material["thinfilm_thickness"]
    up, down = (
        curve.at(mu, **{**material, "thinfilm_thickness": thickness * (1.0 + step)})
        for step in (STEP, -STEP)
    )
    return np.abs(up - down).max(axis=0) / (2.0 * STEP)


def wave_slopes(category, material, _, mu):
    """Sum over all Gaussians of the reflectance's derivative with respect to log(`wave`)."""
    thickness, index = (material[f"thinfilm_{name}"] for name in ("thickness", "ior"))
    opd, matrix = film.path_difference(mu, thickness, index), np.abs(np.array(TEXT.matrix))
    total = 0.0
    for r12, (x, y), R23 in SUBSTRATES[category](mu, index, TEXT, **substrate(material)):
        R12 = r12**2
        T12 = 1.0 - R12
        amplitude = T12**2 * R23 / np.maximum(1.0 - R12 * R23, LEAST_LOSS) - T12
        for k, v, position, var in film.GAUSSIANS:
            height = matrix[:, k] * v * np.sqrt(2.0 * np.pi * var) / film.NORMAL
            wave = r12 * (x + 1j * y) * np.exp(2j * np.pi * position * opd)
            fade = decay(position, var, opd, 0.0)
            orders = sum(m * wave**m * np.exp(-fade * m * m) for m in range(1, 30))
            total = total + height[:, np.newaxis] * np.abs(amplitude * orders)
    return total.max(axis=0)


def single_share(category, material, _, mu):
    """F (1 - F_ss), the factor of E_ss in a smooth lobe's albedo F (E_ss + F_ss (1 - E_ss))."""
    curve = film_curve(category)
    return (curve.at(mu, **material) * (1.0 - curve.average(**material))).max(axis=0)


def average_errors(category, material, *_):
    """Errors of the shader's F_ss, a sum over three cosines."""
    exact = film_curve(category).average(**material)
    return np.abs(average(category, material) - exact).max(axis=0)


def average(category, material, nodes=NODES):
    """F_ss as a weighted sum over `nodes`, which have cosines, weights and widths."""
    return sum(
        weight * shader_curve(category, material, np.asarray(mu), width)
        for mu, weight, width in zip(*nodes, strict=True)
    )


def visible_errors(category, material, alpha, mu):
    """Errors of the shader's mean reflectance of visible facets, a sum over three cosines."""
    exact = visible_average(category, material, alpha, mu)
    return np.abs(visible_mean(category, material, alpha, mu) - exact).max(axis=0)


def albedo_errors(category, material, alpha, mu):
    """Errors of the albedo: the sum of `visible_errors` and (1 - E_ss) times the errors of F_ss."""
    loss = 1.0 - ggx_albedo_dir(mu, alpha)
    return visible_errors(category, material, alpha, mu) + loss * average_errors(category, material)


def seen_errors(category, material, alpha, mu):
    return mu * albedo_errors(category, material, alpha, mu)


def visible_average(category, material, alpha, mu):
    """Mean reflectance of visible facets, computed as the albedo divided by a mirror's albedo."""
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    inputs = {name: value.T for name, value in material.items()}
    inputs["roughness"] = np.repeat(alpha[:, np.newaxis], 2, axis=1)
    white = inputs | {"thinfilm_thickness": np.zeros_like(mu)} | MIRRORS[category]
    film, mirror = (
        film_albedo_dir(category, wo, each, compensate=False) for each in (inputs, white)
    )
    return (film / mirror).T


def visible_mean(category, material, alpha, mu, coefficients=FACETS):
    """The shader's mean reflectance of visible facets, a sum over three cosines.

    The cosines are Gaussian quadrature nodes for a semicircular density.
    """
    mean, reach, bend = facets(mu, alpha, coefficients)
    total = 0.0
    for x in (-np.sqrt(0.5), 0.0, np.sqrt(0.5)):
        cosine = np.clip(mean + reach * (x + bend * (4.0 * x * x - 1.0)), 0.0, 1.0)
        curve = shader_curve(category, material, cosine, reach / 3.0)
        total = total + (0.5 - 0.5 * x * x) * curve
    return total


MIRRORS = {
    "dielectric_bsdf": {"ior": np.zeros(1)},
    "conductor_bsdf": {"ior": np.zeros((1, 3))},
    "generalized_schlick_bsdf": dict.fromkeys(("color0", *WHITE), np.ones((1, 3))),
}


def facets(mu, alpha, coefficients):
    """Mean, spread and skew of the three cosines between wo and visible facets."""
    factors = alpha * alpha / (mu + alpha), alpha / np.sqrt(mu + alpha), 1.0
    polynomials = np.reshape(coefficients, (3, -1)) @ monomials(mu, alpha)
    mean, reach, bend = (a * b for a, b in zip(factors, polynomials, strict=True))
    return mu + mean, reach, bend


def monomials(mu, alpha):
    """Monomials up to degree 3 in mu and alpha / (alpha + 1/5)."""
    y = alpha / (alpha + STEEP)
    return np.stack([mu**i * y**j for i in range(4) for j in range(4 - i)])


def smooth_errors(category, material, _, mu):
    """Errors of a smooth lobe's value F (1 + F_ss (1 - E_ss) / E_ss) due to errors of F_ss."""
    E_ss = ggx_albedo_dir(mu, SMOOTH[0])
    F = film_curve(category).at(mu, **material).max(axis=0)
    return average_errors(category, material) * F * (1.0 - E_ss) / E_ss


# Functions whose largest values are measured, with ranges of films. A film is described by NUMBERS
# numbers, or by COLORED numbers if the row has COLORED.
MEASURED = {
    "orders": (orders_errors, FILMS, COLORED),
    "orders of curves": (curve_errors, CLEAR, COLORED),
    "slope of curves": (slopes, CLEAR),
    "waves of curves": (wave_slopes, CLEAR),
    "E_ss in curves": (single_share, CLEAR, COLORED),
    "F_ss": (average_errors, FILMS, COLORED),
    "F_ss without a film": (average_errors, BARE),
    "visible facets": (visible_errors, FILMS),
    "albedo": (albedo_errors, FILMS),
    "albedo from an index on": (albedo_errors, VISIBLE),
    "albedo in a picture": (seen_errors, VISIBLE),
}
# Functions whose root mean squares are measured, with ranges of films.
SETS = {
    "all orders": (curve_errors, microfacets.ORDERED),
    "F_ss": (average_errors, microfacets.FRINGED),
    "compensation of smooth lobes": (smooth_errors, microfacets.FRINGED),
    "visible facets": (visible_errors, microfacets.STEEP),
    "visible facets that are much alike": (visible_errors, microfacets.GLOSSY),
}


# --- the largest errors ---------------------------------------------------------------------------


def substrates(unit):
    """Inputs of each category, computed from numbers in [0, 1] of shape (6, N) or (13, N)."""
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
    """Map numbers in [0, 1] to inputs of a node with a film, alpha, and the cosine of wo."""
    alpha, mu, thickness, index = (
        low + (high - low) * each for (low, high), each in zip(ranges.values(), unit, strict=False)
    )
    films = {"thinfilm_thickness": thickness, "thinfilm_ior": index}
    return substrates(unit[4:])[category] | films, alpha, mu


def largest(errors, ranges, category, numbers=NUMBERS):
    """Search for the largest error of films within ranges.

    The search repeatedly varies the films with the largest errors, in smaller and smaller steps.
    Then differential evolution starts from the films with the largest errors. If COLORED numbers
    describe a film, the search uses more films, and a step changes only some numbers.
    """
    rng = np.random.default_rng(SEED)
    many = numbers > NUMBERS
    count, best, steps = (4 * COUNT, 4 * WORST, FAR) if many else (COUNT, WORST, STEPS)
    least = np.full((numbers, 1), LEAST)
    least[[0, 1, *range(7, 10)]] = 0.0

    def measured(unit):
        return errors(category, *filmed(category, ranges, unit))

    unit = rng.random((numbers, count))
    unit[:NUMBERS, 0] = CORNERS[category]
    found = measured(unit)
    for step in steps:
        worst = unit[:, np.argsort(found)[-best:]].repeat(count // best // 4, axis=1)
        change = step * rng.standard_normal(worst.shape)
        if many:
            change *= rng.random(worst.shape) < MOVED
        near = np.clip(worst + change, least, 1.0)
        found = np.append(found, measured(near))
        unit = np.append(unit, near, axis=1)
    evolved = differential_evolution(
        lambda unit: -measured(np.maximum(unit, least)),
        [(0.0, 1.0)] * numbers,
        init=np.append(unit[:, np.argsort(found)[-best:]], unit[:, : count // 4], axis=1).T,
        maxiter=GENERATIONS, seed=SEED, vectorized=True, updating="deferred", polish=False,
    )  # fmt: skip
    return -float(evolved.fun)


def films(spec, ranges, seed):
    """Category, material, roughness and cosine of the films that a check uses with `seed`."""
    DRAWN.set(seed)
    batch = microfacets.film_views(spec, ranges)
    material = {
        name: np.moveaxis(value, -1, 0)
        for name, value in batch.inputs.items()
        if name not in ("roughness", "retroreflective")
    }
    return spec.node, material, batch.inputs["roughness"][:, 0], batch.wo[:, 2]


def largest_mean(errors, ranges, sets=64):
    """For each category, the largest root mean square error of many sets of films."""
    return {
        spec.node: max(
            float(np.sqrt(np.mean(errors(*films(spec, ranges, seed)) ** 2)))
            for seed in range(2, 2 + sets)
        )
        for spec in microfacets.FILM_SPECS
    }


if __name__ == "__main__":
    found = {
        name: {category: largest(*row[:2], category, *row[2:]) for category in MIRRORS}
        for name, row in MEASURED.items()
    }
    found |= {f"sets, {name}": largest_mean(*row) for name, row in SETS.items()}
    for name, errors in found.items():
        text = ", ".join(f"{category} {error:.3g}" for category, error in errors.items())
        print(f"{name}: {text}")
