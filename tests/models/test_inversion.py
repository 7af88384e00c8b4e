# SPDX-License-Identifier: Apache-2.0
"""A reflectance computed from an albedo has exactly this albedo."""

import mpmath as mp
import numpy as np
import pytest

from mxeon.models import diffuse as inversion
from mxeon.models.diffuse import eon_albedo_avg, eon_albedo_dir
from tests.support import tolerances

# Colors and roughness in [0, 1], including all magnitudes near 0 and 1.
SMALL = 10.0 ** np.arange(-300.0, 0.0, 7.0)
EDGES = np.unique(np.concatenate([SMALL, 1.0 - SMALL, np.linspace(0.0, 1.0, 201)]))
NORMAL = inversion.eon_rho_from_albedo_normal
AVERAGE = inversion.eon_rho_from_albedo_avg

both = pytest.mark.parametrize("function", [NORMAL, AVERAGE])


def on_grid(function):
    """Values of a function for all colors (last axis) and roughnesses (first axis)."""
    return function(EDGES, EDGES)


@both
def test_without_roughness_rho_is_the_color(function):
    np.testing.assert_allclose(function(EDGES, 0.0), EDGES, rtol=tolerances.RHO)


@both
def test_black_stays_black_and_white_stays_white(function):
    np.testing.assert_array_equal(function(0.0, EDGES), 0.0)
    np.testing.assert_allclose(function(1.0, EDGES), 1.0, rtol=tolerances.RHO)


@both
def test_rho_is_in_range_and_grows_with_the_color_and_the_roughness(function):
    rho = on_grid(function)
    assert rho.min() >= 0.0 and rho.max() <= 1.0
    assert (np.diff(rho, axis=1) >= 0.0).all()
    smooth = function(np.linspace(0.0, 1.0, 101), np.linspace(0.0, 1.0, 101))
    assert (np.diff(smooth, axis=0) >= -tolerances.RHO).all()


def test_albedos_return_to_the_color():
    color = np.tile(EDGES, (len(EDGES), 1))
    for albedo in (
        eon_albedo_dir(1.0, on_grid(NORMAL), EDGES),
        eon_albedo_avg(on_grid(AVERAGE), EDGES),
    ):
        np.testing.assert_allclose(albedo, color, rtol=tolerances.ROUND_TRIP)


def exact_normal(color, r):
    """Solution of [Portsmouth2025], Eq. (30), by mpmath."""
    c1, c2 = mp.mpf(1) / 2 - 2 / (3 * mp.pi), mp.mpf(2) / 3 - 28 / (15 * mp.pi)
    normal, mean = 1 / (1 + c1 * r), (1 + c2 * r) / (1 + c1 * r)
    a, b = mean - normal, normal + color * (1 - mean)
    return (-b + mp.sqrt(b * b + 4 * a * color)) / (2 * a)


def exact_average(color, r):
    """Solution of [Portsmouth2025], Eq. (33), by mpmath."""
    c1, c2 = mp.mpf(1) / 2 - 2 / (3 * mp.pi), mp.mpf(2) / 3 - 28 / (15 * mp.pi)
    return color / (color + (1 + c2 * r) / (1 + c1 * r) * (1 - color))


@pytest.mark.parametrize("function, exact", [(NORMAL, exact_normal), (AVERAGE, exact_average)])
def test_inversion_agrees_with_the_printed_equations_at_hundreds_of_digits(function, exact):
    values = on_grid(function)[1:-1:4, 1:-1:4]
    with mp.workdps(700):
        grid = [[exact(mp.mpf(c), mp.mpf(r)) for c in EDGES[1:-1:4]] for r in EDGES[1:-1:4]]
    np.testing.assert_allclose(values, np.array(grid, dtype=float), rtol=tolerances.RHO)
