# SPDX-License-Identifier: Apache-2.0
"""Choice of the nodes in which `genglsl/lib/thin_film.glsl` averages a film.

Over random films of up to 1000 nm on each kind of substrate, of which no check asks, the mean fourth power
of the errors is least: the largest count most. Found by steps along one number at a time. What another
number of nodes costs is measured too.

    python -m tools.fits.thin_film_nodes
"""

from collections.abc import Callable

import numpy as np

from mxeon.models.microfacet.ggx_formulas import smith_lambda
from mxeon.models.thin_film.curve import film_curve
from tools.fits import thin_film as fit
from tools.fits.thin_film_search import NUMBERS, filmed

SEED, COUNT = 24, 1 << 8  # of the films
FACETS = 384  # films that coefficients for visible facets are fitted to
GRID = 16  # views and roughness along a side, at which coefficients are tied to moments of facets
TIE = 2e-2  # by which they are, relative to an error of a film
BEND = 0.33  # of nodes, for a skewness of 1: those of a semicircle, a t + b (t^2 - 1), bent by b
NEAR = 1e-5  # the difference of a coefficient that measures a slope
STEPS = (0.1, 0.03, 0.01)  # the last one is the digit that ships
FINER = (*STEPS, 3e-3, 1e-3)  # of two cosines


def random_films(count=COUNT):
    """Categories, materials, roughness and views."""
    rng = np.random.default_rng(SEED)
    for category in fit.MIRRORS:
        unit = rng.random((NUMBERS, count))
        yield category, *filmed(category, fit.FILMS, unit)


def chosen(error: Callable[..., float], start: tuple[float, ...], steps: tuple[float, ...]):
    """Numbers of the least error that steps along one of them at a time find."""
    best, least = start, error(*start)
    for step in steps:
        better = True
        while better:
            better = False
            for tried in [
                tuple(np.round(np.array(best) + sign * step * axis, 6))
                for axis in np.eye(len(start))
                for sign in (-1.0, 1.0)
            ]:
                if (found := error(*tried)) < least:
                    best, least, better = tried, found, True
    return tuple(map(float, best))


def _power(errors):
    """Mean fourth power of errors of each kind of substrate, the largest of channels."""
    return float(np.mean([np.abs(each).max(axis=0) ** 4 for each in errors]))


def width():
    """Width of five cosines."""
    films = [
        (category, material, film_curve(category).average(**material))
        for category, material, *_ in random_films()
    ]
    rule = fit.gauss(5)
    return chosen(
        lambda width: _power(fit.average(*film, (*rule, width)) - exact for *film, exact in films),
        (0.05,),
        STEPS,
    )


def pair():
    """Two cosines, the weight of the first, and their width."""
    films = [
        (category, material, film_curve(category).average(**material))
        for category, material, *_ in random_films()
    ]

    def error(low, high, weight, width):
        rule = (low, high), (weight, 1.0 - weight), width
        return _power(fit.average(*film, rule) - exact for *film, exact in films)

    return chosen(error, (0.3, 0.8, 0.3, 0.1), FINER)


def facets(start=1.0, steps=STEPS):
    """Width of all nodes for visible facets, relative to their reach, and its coefficients."""
    films = [(film, fit.visible_average(*film)) for film in random_films(FACETS)]

    def error(share):
        coefficients = _coefficients(films, share)
        return _power(
            fit.visible_mean(*film, coefficients, share=share) - exact for film, exact in films
        )

    [share] = chosen(error, (start,), steps)
    return share, _coefficients(films, share)


def _coefficients(films, share):
    """Coefficients for visible facets, by a step of Gauss and Newton from the moments of their cosines.

    A second step takes a hundredth from the mean square of these errors, and adds a tenth to the largest
    ones of other films.
    """
    start = _moments()

    def errors(coefficients):
        return np.concatenate(
            [
                (fit.visible_mean(*film, coefficients, share=share) - exact).ravel()
                for film, exact in films
            ]
        )

    left = errors(start)
    slopes = np.stack(
        [(errors(start + NEAR * axis) - left) / NEAR for axis in np.eye(len(start))], 1
    )
    # Coefficients stay near the start where no film asks for others.
    rows = TIE * _rows(*grid())
    change = np.linalg.lstsq(
        np.concatenate([slopes, rows]), np.append(-left, np.zeros(len(rows))), rcond=None
    )[0]
    return tuple(float(f"{each:.5g}") for each in start + change)


def grid():
    """Cosines of views and roughness from end to end."""
    axis = (np.arange(GRID) + 0.5) / GRID
    return (each.ravel() for each in np.meshgrid(axis, axis))


def _rows(mu, alpha):
    """What each coefficient adds to the mean, the reach and the bend at views and roughness."""
    factors = alpha * alpha / (mu + alpha), alpha / np.sqrt(mu + alpha), np.ones_like(mu)
    terms = fit.monomials(mu, alpha)
    blocks = np.zeros((3, mu.size, 3, len(terms)))
    for k, factor in enumerate(factors):
        blocks[k, :, k] = (factor * terms).T
    return blocks.reshape(3 * mu.size, -1)


def _moments():
    """Coefficients by which nodes have mean, deviation and skewness of facets, as far as these can be had."""
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

    Lower ones than the lowest mirror no light along the normal.
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


def costs():
    """Root mean square errors of F_ss and of the mean over visible facets, by their number of nodes."""
    films = [
        (film, film_curve(film[0]).average(**film[1]), fit.visible_average(*film))
        for film in random_films()
    ]
    return {
        count: (
            _root(
                fit.average(*film[:2], (*fit.gauss(count), 5.0 * fit.WIDTH / count)) - average
                for film, average, _ in films
            ),
            _root(
                fit.visible_mean(*film, fit.FACETS, count) - visible for film, _, visible in films
            ),
        )
        for count in (3, 4, 5, 6, 8)
    }


def _root(errors):
    """Root of their mean square, of the largest of channels."""
    return float(np.sqrt(np.mean([np.abs(each).max(axis=0) ** 2 for each in errors])))


if __name__ == "__main__":
    print(f"width of five cosines: {width()}")
    print(f"two cosines, the first weight, their width: {pair()}")
    share, coefficients = facets()
    print(f"width of nodes for visible facets: {share}, coefficients: {coefficients}")
    for count, (average, visible) in costs().items():
        print(f"{count} nodes: F_ss {average:.2g}, visible facets {visible:.2g}")
