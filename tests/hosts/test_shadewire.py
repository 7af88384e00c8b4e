# SPDX-License-Identifier: Apache-2.0
"""shadewire's closures match stock GLSL. `test_upstream.py` covers shadewire's two failures."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.errors import NotRun, Unsupported
from mxeon.hosts.base import RendererWarning
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import BACK, SIDE
from tests.support.cases import pairs
from tests.support.documents import lobe, material, surface
from tests.support.verdicts import DIFFERS, FAILED, PASSED

SAME = 1e-5  # tolerance for two float32 shaders with values up to 3
EON, FITTED = "oren_nayar_diffuse_bsdf, energy_compensation true", "MaterialX's fit of its albedo"
WO, WI, COLOR, NUMBER = pairs(1000, 3)
ALPHA = 0.1 + 0.9 * np.stack([NUMBER, COLOR[:, 0]], axis=1)
CASES = {  # documents, and values for the inputs of each document
    "diffuse": (
        material(lobe(energy_compensation="true")),
        {"color": COLOR, "roughness": NUMBER, "weight": COLOR[:, 0]},
    ),
    "film": (
        material(lobe("conductor_bsdf", retroreflective="true")),
        {"roughness": ALPHA, "thinfilm_thickness": 500.0 * NUMBER, "tangent": (0.6, 0.8, 0.0)},
    ),
    "sheen": (material(lobe("sheen_bsdf", mode="zeltner")), {"color": COLOR, "roughness": NUMBER}),
    "standard_surface": (
        surface("standard_surface"),
        {"base_color": COLOR, "coat": NUMBER, "sheen": COLOR[:, 0], "metalness": COLOR[:, 1]},
    ),
    "gltf_pbr": (
        surface("gltf_pbr"),
        {"base_color": COLOR, "metallic": NUMBER, "clearcoat": COLOR[:, 0], "alpha_mode": 2},
    ),
}


@pytest.fixture
def shadewire(hosts):
    return hosts("shadewire")


@pytest.mark.parametrize("name", CASES)
def test_values_and_throughputs_of_pairs_are_those_of_stock_glsl(shadewire, gl, name):
    text, inputs = CASES[name]
    # Throughputs of surface shaders differ between the hosts, because stock MaterialX's generator
    # multiplies lobe weights by mix weights.
    for output in ("response", "throughput") if "_bsdf" in text else ("response",):
        values = []
        for host in (shadewire, gl):
            [shader] = host.compile(text, library="stock")
            values.append(host.evaluate(shader, WO, WI, inputs, "direct", output=output))
        np.testing.assert_allclose(*values, rtol=0.0, atol=SAME)


@pytest.mark.parametrize("name", ["clay", "velvet", "brushed_metal_wedge", "openpbr_rough_base"])
@pytest.mark.parametrize("scene", [SIDE, BACK])
def test_pictures_in_direct_light_are_those_of_stock_glsl(shadewire, gl, name, scene):
    scene = replace(scene, size=32)
    file = examples_folder() / f"{name}.mtlx"
    shaders = (each.compile(file, library="stock") for each in (shadewire, gl))
    for own, stock in zip(*shaders, strict=True):
        expected = gl.picture(stock, scene)
        np.testing.assert_allclose(shadewire.picture(own, scene), expected, rtol=SAME, atol=SAME)


def test_a_picture_with_an_image_is_refused(shadewire):
    [shader] = shadewire.compile(examples_folder() / "brick.mtlx")
    with pytest.raises(NotRun, match="texcoord"):
        shadewire.picture(shader, SIDE)


@pytest.mark.parametrize(
    "check, title, library, verdict, words, page",
    [
        ("value", EON, "stock", FAILED, "clamped dot(wo, wi)", "genglsl_clamped_dot"),
        ("value", "eon_diffuse_bsdf", "eonlib", FAILED, "clamped dot(wo, wi)", ""),
        ("value", "burley_diffuse_bsdf", "eonlib", PASSED, "", ""),
        ("environment", "burley_diffuse_bsdf", "eonlib", FAILED, FITTED, "genglsl_burley_fit"),
        ("value", "conductor_bsdf", "stock", DIFFERS, "compensation", "genglsl_microfacet_compensation"),
        ("combination", "layer, under connected masks", "eonlib", PASSED, "", ""),
        ("radiance", "add, EDF", "eonlib", PASSED, "", ""),
        ("output", "roughness_dual", "eonlib", PASSED, "", ""),
        ("lobes", "UsdPreviewSurface, every lobe", "stock", FAILED, "", "genglsl_microfacet_throughput"),
        ("value", "chiang_hair_bsdf", "eonlib", FAILED, "not evaluated", "shadewire_hair_black"),
    ],
)  # fmt: skip
def test_a_failure_is_explained_by_a_page_whatever_the_library(
    shadewire, judged, check, title, library, verdict, words, page
):
    result = judged(check, title, "shadewire", library)
    assert result.verdict == verdict and words in result.explanation
    assert result.control.caught and (page in result.pages or not page)


def test_what_shadewire_refuses_or_lacks_is_not_run(shadewire):
    connected = '<input name="color" type="color3" nodename="warm"/></oren_nayar_diffuse_bsdf>'
    node = '<oren_nayar_diffuse_bsdf name="lobe" type="BSDF">' + connected
    [shader] = shadewire.compile(material('<blackbody name="warm" type="color3"/>' + node))
    with pytest.raises(NotRun, match="^shadewire: .*no implementation for ND_blackbody"):
        shadewire.evaluate(shader, WO, WI, {}, "direct")
    [shader] = shadewire.compile(material(lobe()))
    with pytest.raises(Unsupported, match="^shadewire: this host has no environment lookups"):
        shadewire.evaluate(shader, WO, WI, {}, "environment", irradiance=np.ones((2, 2, 3)))


def test_a_lobe_without_code_is_black_with_a_warning_of_ours(shadewire):
    [shader] = shadewire.compile(material(lobe("chiang_hair_bsdf")))
    with pytest.warns(RendererWarning, match="chiang_hair_bsdf: not evaluated"):
        assert not shadewire.evaluate(shader, WO, WI, {}, "direct").any()
