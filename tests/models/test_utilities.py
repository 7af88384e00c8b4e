# SPDX-License-Identifier: Apache-2.0
"""Utility nodes that compute inputs of lobes have the right limits, inverses and domains."""

import numpy as np
import pytest

from mxeon.models.hair import (
    EUMELANIN,
    PHEOMELANIN,
    chiang_hair_absorption_from_color,
    chiang_hair_roughness,
    deon_hair_absorption_from_melanin,
)
from mxeon.models.media import blackbody, blackbody_xyz
from mxeon.models.microfacet.fresnel import artistic_ior, fresnel_conductor
from mxeon.models.microfacet.ggx import glossiness_anisotropy, roughness_anisotropy, roughness_dual
from mxeon.models.nodes.utilities import UTILITIES, node
from mxeon.shaders.library import load_library
from tests.support.availability import package

RNG = np.random.default_rng(1)
SHARES = RNG.random((2, 10_000))
COLORS = np.exp(-np.array(EUMELANIN)), np.exp(-np.array(PHEOMELANIN))


def test_anisotropy_stretches_along_the_tangent_and_keeps_the_geometric_mean():
    x, y = roughness_anisotropy(*SHARES).T
    inside = x < 1.0
    assert (x >= y).all()
    assert np.allclose((x * y)[inside], SHARES[0][inside] ** 4, rtol=1e-14, atol=0.0)
    aspect = 1.0 - np.minimum(SHARES[1], 0.98)  # ratio of the shorter axis to the longer axis
    assert np.allclose(y[inside], (aspect * x)[inside], rtol=1e-14, atol=0.0)
    assert np.array_equal(roughness_anisotropy(SHARES[0], 0.0), SHARES[0][:, None] ** 2 * [1, 1])
    assert np.array_equal(roughness_anisotropy(0.5, 1.0), roughness_anisotropy(0.5, 0.98))


def test_glossiness_is_inverted_roughness_and_dual_is_two_squares():
    glossy = glossiness_anisotropy(1.0 - SHARES[0], SHARES[1])
    assert np.array_equal(glossy, roughness_anisotropy(1.0 - (1.0 - SHARES[0]), SHARES[1]))
    assert np.array_equal(roughness_dual(SHARES.T), SHARES.T**2)


def test_an_artistic_index_has_the_reflectivity_that_was_asked():
    reflectivity, edge = SHARES[0] * 0.999999, SHARES[1]
    ior, extinction = artistic_ior(reflectivity, edge)
    metals = fresnel_conductor(1.0, ior[:, None], extinction[:, None])[:, 0]
    assert np.abs(metals - reflectivity).max() < 1e-12


def test_an_artistic_index_has_the_form_of_the_paper():
    r, g = SHARES[0] * 0.99, SHARES[1]
    ior, extinction = artistic_ior(r, g)
    square = (r * (ior + 1.0) ** 2 - (ior - 1.0) ** 2) / (1.0 - r)
    assert np.abs(extinction**2 - square).max() < 1e-14 * 400.0**2 / 0.01
    assert artistic_ior(0.5, 0.0)[1] == 0.0  # dielectrics have no extinction


def test_a_blackbody_has_luminance_1_and_the_colors_of_a_library():
    with np.printoptions():  # colour changes how NumPy prints arrays, which would break doctests
        colour = package("colour")
    shape = colour.SpectralShape(360, 830, 1)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    for kelvin in (800.0, 1667.0, 4000.0, 25000.0):
        light = colour.sd_blackbody(kelvin, shape)
        xyz = np.asarray(colour.sd_to_XYZ(light, observer, method="Integration"))
        # The tolerance allows for the different wavelength steps of both integrals, 5 nm and 1 nm.
        assert np.abs(blackbody_xyz(kelvin) - xyz / xyz[1]).max() < 5e-5
        assert blackbody(kelvin) @ [0.2126729, 0.7151522, 0.0721750] == pytest.approx(1, abs=1e-6)


def test_a_cold_body_has_the_color_of_the_longest_wavelength_and_a_hot_one_has_an_end():
    assert np.allclose(blackbody([1.0, 50.0]), blackbody(10.0), atol=1e-6)
    assert np.allclose(blackbody(1e9), blackbody(1e8), atol=1e-3)
    blue = blackbody([1900.0, 1901.0])[:, 2]
    green = blackbody([963.0, 965.0])[:, 1]
    assert blue[0] < 0.0 < blue[1] and green[0] < 0.0 < green[1]


def test_hair_roughness_ends_at_specular_and_scales_the_variance_alone():
    r, tt, trt = chiang_hair_roughness(*SHARES, 0.5, 2.0)
    assert np.array_equal(chiang_hair_roughness(0.0, 0.0)[0], [0.0, 0.0])
    assert np.array_equal(tt, r * [0.25, 1.0]) and np.array_equal(trt, r * [4.0, 1.0])
    assert chiang_hair_roughness(1.0, 1.0)[0] == pytest.approx([5.238**2, 6.831])


def test_hair_absorbs_by_its_pigments_and_white_hair_absorbs_nothing():
    assert np.array_equal(deon_hair_absorption_from_melanin(0.0, 0.5, *COLORS), np.zeros(3))
    one = 1.0 - np.exp(-1.0)  # amount of melanin that corresponds to one unit of pigment
    for redness, pigment in ((0.0, EUMELANIN), (1.0, PHEOMELANIN)):
        assert deon_hair_absorption_from_melanin(one, redness, *COLORS) == pytest.approx(pigment)
    assert np.array_equal(chiang_hair_absorption_from_color(np.ones(3), 0.3), np.zeros(3))


def test_the_pigments_are_those_of_materialx():
    node = load_library("stock").getNodeDef("ND_deon_hair_absorption_from_melanin")
    for name, pigment in (("eumelanin_color", EUMELANIN), ("pheomelanin_color", PHEOMELANIN)):
        default = node.getActiveInput(name).getValue()
        assert np.exp(-np.array(pigment)) == pytest.approx(list(default), abs=1e-6)


@pytest.mark.parametrize("row", UTILITIES)
def test_a_row_takes_any_input_and_returns_each_output(row):
    assert row.name == row.category and row.category in row.title
    sizes = {"vector2": 2, "vector3": 3, "color3": 3}
    for value in (-1.0, 0.0, 0.5, 1.0, 3.0, 1e6):
        inputs = {name: np.full((4, *np.shape(each)), value) for name, each in row.inputs.items()}
        outputs = row.value(inputs)
        shapes = {name: (4, sizes[kind]) for name, kind in row.outputs.items()}
        assert all(np.isfinite(each).all() and each.min() >= 0.0 for each in outputs.values())
        for found in (outputs, *(variant.value(inputs) for variant in row.variants)):
            assert {name: each.shape for name, each in found.items()} == shapes


def test_a_row_has_the_reflectivity_up_to_its_limit():
    inputs = {"reflectivity": np.array([[0.5, 0.99, 1.0]]), "edge_color": np.full((1, 3), 0.5)}
    outputs = node("artistic_ior").value(inputs)
    reflectance = fresnel_conductor(1.0, outputs["ior"], outputs["extinction"])
    assert reflectance == pytest.approx(np.array([[0.5, 0.99, 0.99]]))
