# SPDX-License-Identifier: Apache-2.0
"""Materials with lobes below the surface are recognized. A warning is printed when rendering."""

from dataclasses import replace

import pytest

from mxeon.errors import InputError
from mxeon.hosts.base import LobeWarning
from mxeon.hosts.cycles import process
from mxeon.shaders.generation import generate
from mxeon.shaders.inner_lobes import inner_lobes
from mxeon.shaders.nodes import connection_text, input_text, node_text
from mxeon.shaders.scene import SIDE, Paths
from tests.support.documents import lobe, material, surface, written


def mixed(weight):
    sides = connection_text("fg", "BSDF", "inner") + connection_text("bg", "BSDF", "opaque")
    mix = node_text("mix", "BSDF", "lobe", sides + input_text("mix", "float", weight))
    return material(lobe("subsurface_bsdf", "inner") + lobe("burley_diffuse_bsdf", "opaque") + mix)


@pytest.mark.parametrize(
    "text, kinds",
    [
        (material(lobe("subsurface_bsdf")), ("subsurface",)),
        (material(lobe("subsurface_bsdf", weight=0.0)), ()),
        (material(lobe("burley_diffuse_bsdf")), ()),
        (material(lobe("dielectric_bsdf", scatter_mode="R")), ()),
        (material(lobe("dielectric_bsdf", scatter_mode="RT")), ("transmission",)),
        (mixed(0.5), ("subsurface",)),
        (mixed(0.0), ()),
        (surface("open_pbr_surface"), ()),
        (surface("open_pbr_surface", subsurface_weight=0.5), ("subsurface",)),
        (surface("open_pbr_surface", transmission_weight=0.5), ("transmission", "volume")),
        (surface("open_pbr_surface", subsurface_weight=1.0, geometry_thin_walled=True), ()),
        (surface("standard_surface", subsurface=0.1), ("subsurface",)),
        (surface("UsdPreviewSurface"), ()),
        (surface("UsdPreviewSurface", opacity=0.5), ("transmission",)),
    ],
)
def test_the_lobes_below_the_surface_are_those_that_have_an_effect(text, kinds):
    assert inner_lobes(generate(text, "glsl")[0]) == kinds


@pytest.mark.parametrize(
    "lobes, paths, words",
    [
        (("subsurface",), Paths(), ""),
        (("subsurface",), Paths(1), "needs at least 16 samples per pixel; with 1,"),
        (("subsurface",), Paths(process.FEWEST_SAMPLES, 1), ""),
        (("transmission",), Paths(None, 1), "needs 8 bounces; with 1"),
        (("transmission", "volume"), Paths(64, 8), ""),
    ],
)
def test_paths_that_are_too_few_are_named(lobes, paths, words):
    reasons = process.approximations(replace(SIDE, paths=paths), lobes)
    assert len(reasons) == bool(words) and words in "".join(reasons)


def test_a_rasterized_picture_says_what_it_has_in_place_of_a_lobe(gl, judged, tmp_path):
    file = written(tmp_path, material(lobe("subsurface_bsdf")))
    [reason] = gl.approximations(gl.compile(file)[0], SIDE)
    assert "subsurface_bsdf is rasterized" in reason
    assert judged.document(file).notes == ((reason, "look.mtlx: look"),)
    assert str(LobeWarning("look", reason)) == f"look: {reason}"


def test_a_host_without_paths_refuses_them(reference):
    with pytest.raises(InputError, match="^reference: samples and bounces can be"):
        reference.refuse_paths(replace(SIDE, paths=Paths(bounces=2)))
