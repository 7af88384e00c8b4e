# SPDX-License-Identifier: Apache-2.0
"""Emission of surfaces: the printed equations, their integrals, and invalid arguments."""

from itertools import pairwise

import numpy as np
import pytest

from mxeon.models import media as emission
from mxeon.models.nodes.emissions import COMBINED_EMISSIONS, EMISSIONS
from tests.support.cases import direction

UP = [0.0, 0.0, 1.0]
ROWS = (*EMISSIONS, *COMBINED_EMISSIONS)
QUADRATURE = 1e-10  # error of 64 nodes on each smooth piece, relative to pi c
ROUNDING = 1e-12
ANGLES = ((60.0, 0.0), (60.0, 60.0), (0.0, 90.0), (60.0, 61e-0), (170.0, 200.0), (200.0, 300.0),
          (0.0, 360.0), (180.0, 180.0), (360.0, 10.0), (30.0, 30.001), (0.0, 0.0))  # fmt: skip


def exitance(radiance, *edges):
    """2 pi int L mu dmu over [0, 1], summed over the pieces between edges."""
    x, w = np.polynomial.legendre.leggauss(64)
    stops = np.unique(np.clip([0.0, *edges, 1.0], 0.0, 1.0))
    total = 0.0
    for low, high in pairwise(stops):
        mu = low + 0.5 * (high - low) * (x + 1.0)
        total += 0.5 * (high - low) * (w * mu) @ radiance(direction(mu))
    return 2.0 * np.pi * total


def test_a_uniform_emitter_has_the_exitance_pi_c():
    assert np.allclose(exitance(lambda wo: emission.uniform_edf(wo, [2.0])), 2.0 * np.pi)
    assert emission.uniform_exitance(2.0) == 2.0 * np.pi


@pytest.mark.parametrize("angles", ANGLES)
def test_the_exitance_of_a_cone_is_the_integral_of_its_radiance(angles):
    edges = [float(emission.cone_cosine(np.array(each))) for each in angles]
    measured = exitance(lambda wo: emission.conical_edf(wo, [1.0], *angles), *edges)
    closed = emission.conical_exitance([1.0], *angles)
    assert np.abs(measured - closed).max() <= QUADRATURE * np.pi


@pytest.mark.parametrize("exponent", [0.0, 0.5, 5.0, 20.0])
def test_the_exitance_of_a_schlick_curve_is_the_integral_of_its_radiance(exponent):
    factors = [0.2, 0.9], [0.7, 0.1], exponent
    x, w = np.polynomial.legendre.leggauss(64)
    t = 0.5 * (x + 1.0)  # 1 - mu = t^2 makes its square root smooth
    values = emission.generalized_schlick_edf(direction(1.0 - t * t), [2.0, 3.0], *factors)
    measured = 2.0 * np.pi * (0.5 * w * 2.0 * t * (1.0 - t * t)) @ values
    closed = emission.generalized_schlick_exitance([2.0, 3.0], *factors)
    assert np.abs(measured - closed).max() <= QUADRATURE


def test_a_cone_without_falloff_is_hard_and_one_with_it_smooth():
    cosines = np.cos(np.radians([29.9, 30.1, 44.9, 45.1]))
    hard = emission.conical_edf(direction(cosines), [1.0], 60.0, 0.0)[:, 0]
    soft = emission.conical_edf(direction(cosines), [1.0], 60.0, 90.0)[:, 0]
    assert hard.tolist() == [1.0, 0.0, 0.0, 0.0]
    assert soft[0] == 1.0 and soft[3] == 0.0 and 0.0 < soft[2] < 1e-3 and soft[1] > 0.999


def test_a_narrow_falloff_nears_the_hard_edge():
    mu = np.linspace(0.0, 1.0, 999)
    hard, narrow = (
        emission.conical_edf(direction(mu), [1.0], 60.0, 60.0 + more) for more in (0, 1e-9)
    )
    assert np.array_equal(hard, narrow)


def test_the_back_of_a_cone_is_dark_unless_it_holds_the_horizon():
    back = np.array([0.0, 0.6, -0.8])
    assert emission.conical_edf(back, [1.0], 179.0, 0.0) == 0.0
    assert emission.conical_edf(back, [1.0], 180.0, 0.0) == 1.0
    assert 0.0 < emission.conical_edf(back, [1.0], 170.0, 200.0) < 1.0


def test_a_schlick_curve_ends_at_both_factors_on_both_sides():
    for side in (1.0, -1.0):
        ends = np.array([[0.0, 0.0, side], [1.0, 0.0, 0.0]])
        values = emission.generalized_schlick_edf(ends, [2.0], [0.3], [0.7], 5.0)
        assert np.abs(values[:, 0] - [0.6, 1.4]).max() <= ROUNDING


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_the_rows_integrate_to_their_exitance(row):
    inputs = inputs_of(row, 1)
    edges = [float(emission.cone_cosine(inputs[name])[0]) for name in row.inputs if "angle" in name]

    def radiance(wo):
        spread = {name: np.repeat(values, len(wo), axis=0) for name, values in inputs.items()}
        return row.value(wo, spread)

    measured = exitance(radiance, *edges)
    # The integrand has a root at the normal.
    assert np.abs(measured - row.exitance(inputs)).max() <= 1e-6
    values = row.value(direction([0.75]), inputs)
    assert all(
        np.abs(each.value(direction([0.75]), inputs) - values).max() > 1e-3
        for each in row.variants
        if not each.permitted
    )


def inputs_of(row, count):
    rng = np.random.default_rng(3)
    values = {}
    for name in row.inputs:
        number = name.endswith(("mix", "exponent", "angle")) or row.name.endswith("_float")
        shape = (count,) if number and "color" not in name else (count, 3)
        values[name] = 0.2 + 0.7 * rng.random(shape)
        values[name] *= {"exponent": 4.0}.get(name, 1.0)
        if name.endswith("angle"):
            values[name] = np.full(count, {"inner_angle": 60.0, "outer_angle": 100.0}[name])
    return values
