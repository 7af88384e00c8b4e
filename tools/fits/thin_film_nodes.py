# SPDX-License-Identifier: Apache-2.0
"""Fits the nodes with which `genglsl/lib/microfacet_film.glsl` averages reflectances of a film.

The script uses random films of up to 1000 nm on each kind of substrate. The checks use other films.
Nodes for F_ss minimize the mean fourth power of the errors to emphasize the largest errors. Nodes
for visible facets minimize the mean square error.

    python -m tools.fits.thin_film_nodes
"""

import numpy as np
from scipy.optimize import least_squares

from mxeon.models.microfacet.ggx import smith_lambda
from mxeon.models.thin_film import film_curve
from tools.fits import thin_film as fit

SEED, COUNT = 24, 400
BARE, HEAVY = 100, 8.0  # number and weight of samples without a film
START = ((0.2, 0.6, 0.9), (0.15, 0.4, 0.45), (0.15, 0.12, 0.09))  # cosines, weights, widths
FACETS = 384  # number of films for the fit of the visible facets
GRID = 16  # number of cosines and of roughnesses in `grid`
TIE = 2e-2  # weight of the equations that keep coefficients near the fit of the moments
BEND = 0.33  # ratio of b to the skewness of a t + b (t^2 - 1), for t with a semicircular density
NEAR = 1e-5  # change of a coefficient for difference quotients
SCALE = 1e3  # scales squared errors to about 1


def random_films(count, ranges=fit.FILMS, seed=SEED):
    """Yield each category with the inputs, alphas and cosines of random films."""
    rng = np.random.default_rng(seed)
    for category in fit.MIRRORS:
        unit = rng.random((fit.NUMBERS, count))
        yield category, *fit.filmed(category, ranges, unit)


def hemisphere():
    """Fitted cosines, weights and widths of the three nodes for F_ss."""
    sets = (1.0, random_films(COUNT)), (HEAVY, random_films(BARE, fit.BARE, SEED + 1))
    films = [
        (weight, category, material, film_curve(category).average(**material))
        for weight, drawn in sets
        for category, material, *_ in drawn
    ]

    def nodes(numbers):
        (*cosines, low, middle), widths = numbers[:5], numbers[5:]
        return cosines, (low, middle, 1.0 - low - middle), widths

    def squares(numbers):
        rule = nodes(numbers)
        parts = [weight * (fit.average(*film, rule) - exact) for weight, *film, exact in films]
        errors = np.concatenate(parts, axis=None)
        return SCALE * errors * np.abs(errors)

    start = np.concatenate([START[0], START[1][:2], START[2]])
    found = least_squares(squares, start, x_scale=0.1, diff_step=NEAR).x
    return tuple(tuple(float(f"{each:.5g}") for each in row) for row in nodes(found))


def facets():
    """Coefficients for visible facets, by one Gauss-Newton step from the fit of the moments."""
    films = [(film, fit.visible_average(*film)) for film in random_films(FACETS)]
    start = moments_fit()

    def errors(coefficients):
        parts = [fit.visible_mean(*film, coefficients) - exact for film, exact in films]
        return np.concatenate(parts, axis=None)

    first = errors(start)
    slopes = [(errors(start + NEAR * axis) - first) / NEAR for axis in np.eye(len(start))]
    # These rows keep a coefficient near `start` if the films do not determine the coefficient.
    rows = TIE * moment_rows(*grid())
    matrix = np.concatenate([np.stack(slopes, 1), rows])
    change = np.linalg.lstsq(matrix, np.append(-first, np.zeros(len(rows))), rcond=None)[0]
    return tuple(float(f"{each:.5g}") for each in start + change)


def grid():
    axis = (np.arange(GRID) + 0.5) / GRID
    return (each.ravel() for each in np.meshgrid(axis, axis))


def moment_rows(mu, alpha):
    """Matrix that maps coefficients to mean, spread and skew for each mu and alpha."""
    factors = alpha * alpha / (mu + alpha), alpha / np.sqrt(mu + alpha), np.ones_like(mu)
    terms = fit.monomials(mu, alpha)
    blocks = np.zeros((3, mu.size, 3, len(terms)))
    for k, factor in enumerate(factors):
        blocks[k, :, k] = (factor * terms).T
    return blocks.reshape(3 * mu.size, -1)


def moments_fit():
    """Coefficients that best match the moments of the cosines between wo and visible facets."""
    mu, alpha = grid()
    mean, deviation, skewness = facet_moments(mu, alpha)
    b = np.clip(BEND * skewness, -0.8, 0.8)
    even = np.sqrt(1.0 - b * b)
    reach, bend = deviation * even * 2.0 * np.sqrt(1.0 - 0.08), b / (2.0 * even)
    moments = np.concatenate([mean - mu, reach, bend])
    return np.linalg.lstsq(moment_rows(mu, alpha), moments, rcond=None)[0]


def facet_moments(mu, alpha):
    """Mean, standard deviation and skewness of the cosine between wo and visible facets."""
    cosines, weights = (np.array(each) for each in zip(*sampled_facets(mu, alpha), strict=True))
    weights /= weights.sum(axis=0)
    mean = (weights * cosines).sum(axis=0)
    central = cosines - mean
    deviation = np.sqrt(np.maximum((weights * central**2).sum(axis=0), 1e-12))
    return mean, deviation, (weights * central**3).sum(axis=0) / deviation**3


def sampled_facets(mu, alpha):
    """Yield cosines between wo and 16 visible facets, with weights.

    Facets below `lowest` are excluded. If mu = 1, such facets would reflect light from below.
    """
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    x, w = np.polynomial.legendre.leggauss(4)
    stretch = np.stack([alpha, alpha, np.ones_like(alpha)], axis=-1)
    stretched = wo * stretch
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    v = stretched[:, 2]
    lowest = 2.0 * alpha**2 * v / (1.0 + alpha**2)
    for u, height in zip(0.5 * (1.0 + x), w, strict=True):
        for azimuth in np.pi * (np.arange(4) + 0.5) / 4.0:
            z = (1.0 - u) * lowest + u * (1.0 + v) - v
            radius = np.sqrt(np.clip(1.0 - z * z, 0.0, 1.0))
            H = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
            H = (H + stretched) * stretch
            H /= np.linalg.norm(H, axis=1, keepdims=True)
            c = (wo * H).sum(axis=1)
            mu_i = np.maximum(2.0 * c * H[:, 2] - wo[:, 2], 0.0)
            smith = smith_lambda(wo[:, 2], alpha) * mu_i + smith_lambda(mu_i, alpha) * wo[:, 2]
            yield c, height * 2.0 * mu_i * wo[:, 2] / smith


if __name__ == "__main__":
    print(f"cosines, weights and widths for F_ss: {hemisphere()}")
    print(f"coefficients for visible facets: {facets()}")
