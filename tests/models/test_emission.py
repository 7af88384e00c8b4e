# SPDX-License-Identifier: Apache-2.0
"""Emission models agree with the printed equations, and their variants differ."""

import numpy as np
import pytest

from mxeon.models import media as emission
from mxeon.models.nodes.emissions import COMBINED_EMISSIONS, EMISSIONS
from tests.support.cases import direction

ROWS = (*EMISSIONS, *COMBINED_EMISSIONS)
ROUNDING = 1e-12


def test_a_cone_falls_off_by_the_printed_smoothstep():
    mu = np.linspace(0.0, 1.0, 101)
    inner, outer = np.cos(np.radians([30.0, 45.0]))
    t = np.clip((mu - outer) / (inner - outer), 0.0, 1.0)
    values = emission.conical_edf(direction(mu), [2.0], 60.0, 90.0)[:, 0]
    assert np.abs(values - 2.0 * t * t * (3.0 - 2.0 * t)).max() <= ROUNDING


@pytest.mark.parametrize("exponent", [0.0, 0.5, 5.0, 20.0])
def test_a_schlick_curve_is_the_printed_one(exponent):
    mu = np.linspace(0.0, 1.0, 101)
    values = emission.generalized_schlick_edf(direction(mu), [2.0], [0.2], [0.7], exponent)[:, 0]
    assert np.abs(values - 2.0 * (0.2 + 0.5 * (1.0 - mu) ** exponent)).max() <= ROUNDING


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
def test_the_variants_of_a_row_are_others(row):
    inputs = inputs_of(row, 1)
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
