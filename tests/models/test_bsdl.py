# SPDX-License-Identifier: Apache-2.0
"""What OSL's library BSDL makes of the nodes: variants that a diagnosis on testrender names."""

import numpy as np
import pytest

from mxeon.models.microfacet.defects import conty_kulla_albedo
from mxeon.models.nodes.microfacets import DIELECTRIC
from mxeon.models.nodes.renderers import BSDL_VARIANTS

WO, WI = np.array([[0.6, 0.0, 0.8]] * 3), np.array([[-0.6, 0.0, 0.8]] * 3)
ALPHAS = np.array([[0.3, 0.3], [0.2, 0.4], [0.3, 0.3]])
INPUTS = {
    "roughness": ALPHAS,
    "tint": np.full((3, 3), 0.5),
    "ior": np.array([1.5, 1.5, 7.0]),
    "extinction": np.full((3, 3), 2.0),
    "color": np.array([[0.2, 0.5, 0.8]] * 3),
    "color0": np.array([[0.02, 0.04, 0.06]] * 3),
    "color82": np.full((3, 3), 0.5),
    "color90": np.ones((3, 3)),
    "exponent": np.full(3, 5.0),
}


def variant(name, place=0):
    return BSDL_VARIANTS[name][place]


def test_an_index_above_5_counts_as_5():
    values = variant("dielectric").value(WO, WI, INPUTS)
    five = variant("dielectric").value(WO, WI, {**INPUTS, "ior": np.minimum(INPUTS["ior"], 5.0)})
    assert np.array_equal(values, five) and np.all(values > 0.0)


def test_what_a_metal_gains_has_fresnel_at_the_half_vector():
    metal = {**INPUTS, "ior": np.full((3, 3), 0.2)}
    values = variant("conductor").value(WO, WI, metal)
    # It depends on the mean of both alphas, of which the first and last pair have the same.
    assert np.array_equal(values[0], values[2]) and np.all(values > 0.0)


def test_color82_counts_as_1():
    lobe = variant("schlick").value
    other = {**INPUTS, "color82": np.full((3, 3), 0.9)}
    assert np.array_equal(lobe(WO, WI, INPUTS), lobe(WO, WI, other))


def test_a_dielectric_layer_has_no_tint_and_one_alpha():
    albedo = variant("dielectric").albedo(WO, INPUTS)
    white = {**INPUTS, "tint": np.ones((3, 3)), "ior": np.minimum(INPUTS["ior"], 5.0)}
    assert albedo == pytest.approx(
        DIELECTRIC.albedo(WO, {**white, "roughness": np.full((3, 2), 0.3)}), rel=1e-12
    )


def test_a_schlick_layer_is_a_dielectric_of_the_mean_reflectance():
    albedo = variant("schlick", 1).albedo(WO, INPUTS)
    ior = {**INPUTS, "ior": np.full(3, 1.5)}  # 0.04 at the normal, the mean of color0
    assert albedo == pytest.approx(variant("dielectric").albedo(WO, ior), rel=1e-12)


@pytest.mark.parametrize(("name", "place"), [("conty_kulla", 0), ("zeltner", 0), ("zeltner", 1)])
def test_a_sheen_layer_has_the_largest_channel_of_its_color(name, place):
    sheen = {**INPUTS, "roughness": np.array([0.3, 0.5, 1.0])}
    gray = {**sheen, "color": np.full((3, 3), 0.8)}
    albedo = variant(name, place).albedo
    assert np.array_equal(albedo(WO, sheen), albedo(WO, gray))
    if place or name == "conty_kulla":
        white = conty_kulla_albedo(WO, {**sheen, "color": np.ones((3, 3))})
        assert albedo(WO, sheen)[:, 0] == pytest.approx(0.8 * white[:, 0], rel=1e-12)
