# SPDX-License-Identifier: Apache-2.0
"""What OSL's library BSDL and Cycles make of the nodes: variants that a diagnosis on testrender or Cycles names."""

import numpy as np
import pytest

from mxeon.models.microfacet.defects import conty_kulla_albedo
from mxeon.models.nodes.microfacets import DIELECTRIC
from mxeon.models.nodes.renderers import BSDL_VARIANTS, CYCLES_VARIANTS
from mxeon.models.sheen import zeltner_albedo_dir

WO, WI = np.array([[0.6, 0.0, 0.8]] * 3), np.array([[-0.6, 0.0, 0.8]] * 3)
COMMON = {
    "color": np.array([[0.2, 0.5, 0.8]] * 3),
    "color0": np.array([[0.02, 0.04, 0.06]] * 3),
    "color82": np.full((3, 3), 0.5),
    "color90": np.ones((3, 3)),
    "exponent": np.full(3, 5.0),
}


@pytest.mark.parametrize("variants", [BSDL_VARIANTS, CYCLES_VARIANTS], ids=["BSDL", "Cycles"])
def test_color82_counts_as_1(variants):
    inputs = COMMON | {"roughness": np.full((3, 2), 0.9)}
    both = inputs, inputs | {"color82": np.full((3, 3), 0.9)}
    for each in variants["schlick"]:
        assert not each.value or np.array_equal(*(each.value(WO, WI, given) for given in both))
        assert not each.albedo or np.array_equal(*(each.albedo(WO, given) for given in both))


# --- BSDL ----------------------------------------------------------------------------------------

ALPHAS = np.array([[0.3, 0.3], [0.2, 0.4], [0.3, 0.3]])
INPUTS = COMMON | {
    "roughness": ALPHAS,
    "tint": np.full((3, 3), 0.5),
    "ior": np.array([1.5, 1.5, 7.0]),
    "extinction": np.full((3, 3), 2.0),
}


def bsdl(name, place=0):
    return BSDL_VARIANTS[name][place]


def test_an_index_above_5_counts_as_5():
    values = bsdl("dielectric").value(WO, WI, INPUTS)
    five = bsdl("dielectric").value(WO, WI, {**INPUTS, "ior": np.minimum(INPUTS["ior"], 5.0)})
    assert np.array_equal(values, five) and np.all(values > 0.0)


def test_what_a_metal_gains_has_fresnel_at_the_half_vector():
    metal = {**INPUTS, "ior": np.full((3, 3), 0.2)}
    values = bsdl("conductor").value(WO, WI, metal)
    # It depends on the mean of both alphas, of which the first and last pair have the same.
    assert np.array_equal(values[0], values[2]) and np.all(values > 0.0)


def test_a_dielectric_layer_has_no_tint_and_one_alpha():
    albedo = bsdl("dielectric").albedo(WO, INPUTS)
    white = {**INPUTS, "tint": np.ones((3, 3)), "ior": np.minimum(INPUTS["ior"], 5.0)}
    assert albedo == pytest.approx(
        DIELECTRIC.albedo(WO, {**white, "roughness": np.full((3, 2), 0.3)}), rel=1e-12
    )


def test_a_schlick_layer_is_a_dielectric_of_the_mean_reflectance():
    albedo = bsdl("schlick", 1).albedo(WO, INPUTS)
    ior = {**INPUTS, "ior": np.full(3, 1.5)}  # 0.04 at the normal, the mean of color0
    assert albedo == pytest.approx(bsdl("dielectric").albedo(WO, ior), rel=1e-12)


@pytest.mark.parametrize(("name", "place"), [("conty_kulla", 0), ("zeltner", 0), ("zeltner", 1)])
def test_a_sheen_layer_has_the_largest_channel_of_its_color(name, place):
    sheen = {**INPUTS, "roughness": np.array([0.3, 0.5, 1.0])}
    gray = {**sheen, "color": np.full((3, 3), 0.8)}
    albedo = bsdl(name, place).albedo
    assert np.array_equal(albedo(WO, sheen), albedo(WO, gray))
    if place or name == "conty_kulla":
        white = conty_kulla_albedo(WO, {**sheen, "color": np.ones((3, 3))})
        assert albedo(WO, sheen)[:, 0] == pytest.approx(0.8 * white[:, 0], rel=1e-12)


# --- Cycles --------------------------------------------------------------------------------------

SMOOTH, ROUGH = np.full((3, 2), 1e-4), np.full((3, 2), 0.9)
SINGLE = COMMON | {"roughness": ROUGH, "tint": COMMON["color"], "ior": np.full(3, 1.5)}
METAL = {**SINGLE, "ior": np.full((3, 3), 0.2), "extinction": np.full((3, 3), 3.0)}


def cycles(name, place=0):
    return CYCLES_VARIANTS[name][place]


@pytest.mark.parametrize(("name", "inputs"), [("dielectric", SINGLE), ("conductor", METAL)])
def test_a_lobe_is_single_scattering(name, inputs):
    value, albedo = cycles(name).value, cycles(name).albedo
    assert np.all(value(WO, WI, inputs) > 0.0)
    # A rough lobe loses light that a smooth one returns.
    smooth, rough = (albedo(WO, {**inputs, "roughness": alpha}) for alpha in (SMOOTH, ROUGH))
    assert np.all(rough < 0.9 * smooth)


@pytest.mark.parametrize("name", ["dielectric", "schlick"])
def test_a_layer_is_the_largest_channel_of_facets_that_lose_no_light(name):
    albedo = cycles(name, 1).albedo(WO, SINGLE)
    assert np.array_equal(albedo, np.repeat(albedo[:, :1], 3, axis=1))
    # That of a lobe which loses light is less; without roughness both are one.
    assert np.all(albedo > cycles(name).albedo(WO, SINGLE))
    smooth = {**SINGLE, "roughness": SMOOTH}
    largest = cycles(name).albedo(WO, smooth).max(axis=1)
    assert cycles(name, 1).albedo(WO, smooth)[:, 0] == pytest.approx(largest, rel=1e-3)


def test_a_layer_of_an_index_below_1_is_smooth():
    rarer = {**SINGLE, "ior": np.full(3, 0.9)}
    smooth, rough = (
        cycles("dielectric", 1).albedo(WO, {**rarer, "roughness": each}) for each in (SMOOTH, ROUGH)
    )
    assert np.array_equal(smooth, rough)


def test_the_color_of_a_sheen_counts_twice_in_its_layer():
    albedo = cycles("zeltner").albedo(WO, {**SINGLE, "roughness": np.full(3, 0.5)})
    assert albedo[:, 0] == pytest.approx(0.64 * zeltner_albedo_dir(0.8, 0.5), rel=1e-12)
