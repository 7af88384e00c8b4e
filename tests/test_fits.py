# SPDX-License-Identifier: Apache-2.0
"""Fitted coefficients: each script gives the digits that ship, and they have the error stated.

The scripts compute in 40 digits, so that a digit that differs is another fit, not another machine.
"""

import re

import numpy as np
import pytest

from fits import arc_tangent, eon_inversion, eon_sampling, fon_loss
from fits.minimax import least_largest, mp
from mxeon.models import inversion
from mxeon.models.sampling import eon as shipped
from mxeon.shaders import functions as twins
from tests.support import tolerances

by_language = pytest.mark.parametrize("language", twins.LANGUAGES)


def numbers(pattern, text):
    """Numbers of the macros whose names match a pattern."""
    return [float(each) for each in re.findall(rf"#define EON_{pattern} (\S+)", text)]


def test_least_largest_finds_the_line_nearest_to_a_parabola():
    points = [mp.mpf(k) / 100 for k in range(101)]
    x, residual = least_largest([[mp.one, t] for t in points], [t * t for t in points])
    np.testing.assert_array_equal(np.float64([*x, residual]), [-0.125, 1.0, 0.125])


@by_language
def test_the_script_gives_the_coefficients_of_the_loss(language):
    lines = re.findall(r"^#define EON_[PQ]\d .*$", twins.source(language), re.MULTILINE)
    assert lines == fon_loss.defines()


@by_language
def test_coefficients_of_the_loss_have_the_error_that_stands_beside_them(language):
    p, q = (numbers(rf"{name}\d", twins.source(language)) for name in "PQ")
    double, single = fon_loss.largest_errors(np.float64(p), np.float64(q))
    assert double <= tolerances.FIT_LOSS and single <= tolerances.FIT_LOSS_32


def test_a_wrong_digit_in_a_coefficient_of_the_loss_shows_in_its_error():
    p, q = fon_loss.fit()
    assert fon_loss.largest_errors(p + np.eye(5)[1] * 1e-6, q)[0] > tolerances.FIT_LOSS


@pytest.mark.parametrize("row", eon_sampling.ROWS, ids=lambda row: row[0])
def test_the_script_gives_the_coefficients_of_the_sampler(row):
    name, points, *rest = row
    coefficients = eon_sampling.fitted(points(eon_sampling.COUNT), *rest)
    assert eon_sampling.printed(coefficients) == getattr(shipped, name)


def test_the_script_gives_the_root_of_the_sampling_twins():
    root = numbers(r"ROOT\d", twins.source("glsl"))
    assert eon_sampling.printed(eon_sampling.root_fit()[0]) == tuple(root)


def test_the_root_of_the_sampling_twins_has_the_error_that_stands_beside_it():
    root = numbers(r"ROOT\d", twins.source("glsl"))
    rows = eon_sampling.root_rows(eon_sampling.nodes(1001))
    assert max(abs(mp.fdot(row, root) - 1) for row in rows) <= tolerances.FIT_ROOT


def test_the_script_gives_the_coefficients_of_the_inversion():
    assert tuple(round(each, 7) for each in eon_inversion.normal()[0]) == inversion.NORMAL_REFIT
    assert round(eon_inversion.average()[0], 7) == inversion.AVERAGE_REFIT


@by_language
def test_the_script_gives_the_series_of_the_angle(language):
    body = re.search(r"float series = (.*);", twins.source(language))[1]
    series = [float(each) for each in re.findall(r"-?\d\.\d+", body)]
    coefficients = arc_tangent.coefficients(**arc_tangent.TWINS)
    assert series == [round(each, 8) for each in coefficients]
    error = arc_tangent.largest_error(series, arc_tangent.TWINS["top"], 101)
    assert error <= tolerances.FIT_ANGLE


def test_the_script_gives_the_arc_tangent_of_the_compiled_models():
    pytest.importorskip("numba")
    from benchmarks import numba_eon as compiled

    series = arc_tangent.coefficients(**arc_tangent.COMPILED)
    assert np.ravel(compiled.ATAN).tolist() == series
    assert arc_tangent.largest_error(series, mp.one, 101) <= tolerances.ROUNDING
