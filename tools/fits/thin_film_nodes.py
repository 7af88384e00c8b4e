# SPDX-License-Identifier: Apache-2.0
"""Choice of the nodes in which `genglsl/lib/microfacet_film.glsl` averages a film.

Over random films of up to 1000 nm on each kind of substrate, different from those of the checks, it minimizes
the mean fourth power of the errors of F_ss, which emphasizes the largest, and the mean square of the errors of
the mean over visible facets.

    python -m tools.fits.thin_film_nodes
"""

import numpy as np
from scipy.optimize import least_squares

from mxeon.models.microfacet.ggx import smith_lambda
from mxeon.models.thin_film import film_curve
from tools.fits import thin_film as fit

SEED, COUNT = 24, 400  # random films
BARE, HEAVY = 100, 8.0  # substrates without a film, whose F_ss should be kept, and their weight
START = ((0.2, 0.6, 0.9), (0.15, 0.4, 0.45), (0.15, 0.12, 0.09))  # cosines, weights and widths
FACETS = 384  # films that coefficients for visible facets are fitted to
GRID = 16  # views and roughnesses per side of a grid that ties coefficients to moments of facets
TIE = 2e-2  # weight of the moments, relative to an error of a film
BEND = 0.33  # bend b of a semicircle's nodes, a t + b (t^2 - 1), for a skewness of 1
NEAR = 1e-5  # difference of a coefficient to measure slopes
SCALE = 1e3  # makes squares of errors about 1


def random_films(count, ranges=fit.FILMS, seed=SEED):
    """Categories, materials, roughness and views."""
    rng = np.random.default_rng(seed)
    for category in fit.MIRRORS:
        unit = rng.random((fit.NUMBERS, count))
        yield category, *fit.filmed(category, ranges, unit)


def hemisphere():
    """Cosines, weights and widths of three nodes for F_ss."""
    bare = {**fit.FILMS, "thickness": (0.0, 0.0), "index": (1.0, 1.0)}
    films = [
        (weight, category, material, film_curve(category).average(**material))
        for weight, drawn in (
            (1.0, random_films(COUNT)),
            (HEAVY, random_films(BARE, bare, SEED + 1)),
        )
        for category, material, *_ in drawn
    ]

    def nodes(numbers):
        (*cosines, low, middle), widths = numbers[:5], numbers[5:]
        return cosines, (low, middle, 1.0 - low - middle), widths

    def squares(numbers):
        errors = np.concatenate(
            [
                weight * (fit.average(*film, nodes(numbers)) - exact).ravel()
                for weight, *film, exact in films
            ]
        )
        return SCALE * errors * np.abs(errors)

    start = np.concatenate([START[0], START[1][:2], START[2]])
    found = least_squares(squares, start, x_scale=0.1, diff_step=NEAR).x
    return tuple(tuple(float(f"{each:.5g}") for each in row) for row in nodes(found))


def facets():
    """Coefficients for visible facets, by a step of Gauss and Newton from the moments of their cosines."""
    films = [(film, fit.visible_average(*film)) for film in random_films(FACETS)]
    start = _moments()

    def errors(coefficients):
        return np.concatenate(
            [(fit.visible_mean(*film, coefficients) - exact).ravel() for film, exact in films]
        )

    left = errors(start)
    slopes = np.stack(
        [(errors(start + NEAR * axis) - left) / NEAR for axis in np.eye(len(start))], 1
    )
    # Tie coefficients to the start where no film determines them.
    rows = TIE * _rows(*grid())
    change = np.linalg.lstsq(
        np.concatenate([slopes, rows]), np.append(-left, np.zeros(len(rows))), rcond=None
    )[0]
    return tuple(float(f"{each:.5g}") for each in start + change)


def grid():
    """Cosines of views and roughnesses over the whole domain."""
    axis = (np.arange(GRID) + 0.5) / GRID
    return (each.ravel() for each in np.meshgrid(axis, axis))


def _rows(mu, alpha):
    """Contribution of each coefficient to mean, reach and bend at views and roughness."""
    factors = alpha * alpha / (mu + alpha), alpha / np.sqrt(mu + alpha), np.ones_like(mu)
    terms = fit.monomials(mu, alpha)
    blocks = np.zeros((3, mu.size, 3, len(terms)))
    for k, factor in enumerate(factors):
        blocks[k, :, k] = (factor * terms).T
    return blocks.reshape(3 * mu.size, -1)


def _moments():
    """Coefficients that best match the mean, deviation and skewness of the facets."""
    mu, alpha = grid()
    mean, deviation, skewness = facet_moments(mu, alpha)
    b = np.clip(BEND * skewness, -0.8, 0.8)
    even = np.sqrt(1.0 - b * b)
    reach, bend = deviation * even * 2.0 * np.sqrt(1.0 - 0.08), b / (2.0 * even)
    wanted = np.concatenate([mean - mu, reach, bend])
    return np.linalg.lstsq(_rows(mu, alpha), wanted, rcond=None)[0]


def facet_moments(mu, alpha):
    """Mean, deviation and skewness of the cosines of 16 visible facets with their view."""
    cosines, weights = (np.array(each) for each in zip(*_facets(mu, alpha), strict=True))
    weights /= weights.sum(axis=0)
    mean = (weights * cosines).sum(axis=0)
    central = cosines - mean
    deviation = np.sqrt(np.maximum((weights * central**2).sum(axis=0), 1e-12))
    return mean, deviation, (weights * central**3).sum(axis=0) / deviation**3


def _facets(mu, alpha):
    """Cosines of 16 visible facets with their view, and their weights.

    Facets below `lowest` are excluded: they mirror no light along the normal.
    """
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    x, w = np.polynomial.legendre.leggauss(4)
    stretched = wo * np.stack([alpha, alpha, np.ones_like(alpha)], axis=-1)
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    lowest = 2.0 * alpha**2 * stretched[:, 2] / (1.0 + alpha**2)
    for u, height in zip(0.5 * (1.0 + x), w, strict=True):
        for azimuth in np.pi * (np.arange(4) + 0.5) / 4.0:
            v = stretched[:, 2]
            z = (1.0 - u) * lowest + u * (1.0 + v) - v
            radius = np.sqrt(np.clip(1.0 - z * z, 0.0, 1.0))
            columns = [radius * np.cos(azimuth), radius * np.sin(azimuth), z]
            H = np.stack(columns, axis=-1) + stretched
            H *= np.stack([alpha, alpha, np.ones_like(alpha)], axis=-1)
            H /= np.linalg.norm(H, axis=1, keepdims=True)
            c = (wo * H).sum(axis=1)
            mu_i = np.maximum(2.0 * c * H[:, 2] - wo[:, 2], 0.0)
            smith = smith_lambda(wo[:, 2], alpha) * mu_i + smith_lambda(mu_i, alpha) * wo[:, 2]
            yield c, height * 2.0 * mu_i * wo[:, 2] / smith


if __name__ == "__main__":
    print(f"cosines, weights and widths for F_ss: {hemisphere()}")
    print(f"coefficients for visible facets: {facets()}")
