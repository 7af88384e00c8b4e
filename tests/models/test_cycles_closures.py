# SPDX-License-Identifier: Apache-2.0
"""What Cycles makes of the nodes: variants that a diagnosis on it names."""

import numpy as np
import pytest

from mxeon.models.nodes.renderers import CYCLES_VARIANTS
from mxeon.models.sheen import zeltner_albedo_dir

WO, WI = np.array([[0.6, 0.0, 0.8]] * 3), np.array([[-0.6, 0.0, 0.8]] * 3)
SMOOTH, ROUGH = np.full((3, 2), 1e-4), np.full((3, 2), 0.9)
INPUTS = {
    "roughness": ROUGH,
    "tint": np.array([[0.2, 0.5, 0.8]] * 3),
    "ior": np.full(3, 1.5),
    "color": np.array([[0.2, 0.5, 0.8]] * 3),
    "color0": np.array([[0.02, 0.04, 0.06]] * 3),
    "color82": np.full((3, 3), 0.5),
    "color90": np.ones((3, 3)),
    "exponent": np.full(3, 5.0),
}
METAL = {**INPUTS, "ior": np.full((3, 3), 0.2), "extinction": np.full((3, 3), 3.0)}


def variant(name, place=0):
    return CYCLES_VARIANTS[name][place]


@pytest.mark.parametrize(("name", "inputs"), [("dielectric", INPUTS), ("conductor", METAL)])
def test_a_lobe_is_single_scattering(name, inputs):
    value, albedo = variant(name).value, variant(name).albedo
    assert np.all(value(WO, WI, inputs) > 0.0)
    # A rough lobe loses light that a smooth one returns.
    smooth, rough = (albedo(WO, {**inputs, "roughness": alpha}) for alpha in (SMOOTH, ROUGH))
    assert np.all(rough < 0.9 * smooth)


def test_color82_counts_as_1():
    other = {**INPUTS, "color82": np.full((3, 3), 0.9)}
    schlick, layered = variant("schlick"), variant("schlick", 1)
    assert np.array_equal(*(schlick.value(WO, WI, each) for each in (INPUTS, other)))
    assert np.array_equal(*(schlick.albedo(WO, each) for each in (INPUTS, other)))
    assert np.array_equal(*(layered.albedo(WO, each) for each in (INPUTS, other)))


@pytest.mark.parametrize("name", ["dielectric", "schlick"])
def test_a_layer_is_the_largest_channel_of_facets_that_lose_no_light(name):
    albedo = variant(name, 1).albedo(WO, INPUTS)
    assert np.array_equal(albedo, np.repeat(albedo[:, :1], 3, axis=1))
    # That of a lobe which loses light is less; without roughness both are one.
    assert np.all(albedo > variant(name).albedo(WO, INPUTS))
    smooth = {**INPUTS, "roughness": SMOOTH}
    largest = variant(name).albedo(WO, smooth).max(axis=1)
    assert variant(name, 1).albedo(WO, smooth)[:, 0] == pytest.approx(largest, rel=1e-3)


def test_a_layer_of_an_index_below_1_is_smooth():
    rarer = {**INPUTS, "ior": np.full(3, 0.9)}
    smooth, rough = (
        variant("dielectric", 1).albedo(WO, {**rarer, "roughness": each})
        for each in (SMOOTH, ROUGH)
    )
    assert np.array_equal(smooth, rough)


def test_the_color_of_a_sheen_counts_twice_in_its_layer():
    albedo = variant("zeltner").albedo(WO, {**INPUTS, "roughness": np.full(3, 0.5)})
    assert albedo[:, 0] == pytest.approx(0.64 * zeltner_albedo_dir(0.8, 0.5), rel=1e-12)
