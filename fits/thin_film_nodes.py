# SPDX-License-Identifier: Apache-2.0
"""Choice of the nodes in which `eonlib/genglsl/thin_film.glsl` averages a film.

Over random films of up to 1000 nm on each kind of substrate, of which no check asks, the mean fourth power
of the errors is least: the largest count most. Found by steps along one number at a time. What another
number of nodes costs is measured too.

    python -m fits.thin_film_nodes
"""

from collections.abc import Callable

import numpy as np

from fits import thin_film as fit
from mxeon.models.thin_film.curve import film_curve

SEED, COUNT = 24, 1 << 8  # of the films
STEPS = (0.1, 0.03, 0.01)  # the last one is the digit that ships
FINER = (*STEPS, 3e-3, 1e-3)  # of two cosines


def random_films():
    """Categories, materials, roughness and views."""
    rng = np.random.default_rng(SEED)
    for category in fit.MIRRORS:
        unit = rng.random((fit.NUMBERS, COUNT))
        yield category, *fit.filmed(category, fit.FILMS, unit)


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


def bend_and_share():
    """How far skewness bends four nodes, and the part of the deviation that each has around it."""
    films = [(film, fit.visible_average(*film)) for film in random_films()]
    return chosen(
        lambda *both: _power(fit.visible_mean(*film, *both) - exact for film, exact in films),
        (0.3, 0.3),
        STEPS,
    )


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
                fit.visible_mean(*film, fit.BEND, 4.0 * fit.SHARE / count, count) - visible
                for film, _, visible in films
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
    print(f"bend of four nodes, and their share of the deviation: {bend_and_share()}")
    for count, (average, visible) in costs().items():
        print(f"{count} nodes: F_ss {average:.2g}, visible facets {visible:.2g}")
