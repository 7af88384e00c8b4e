# SPDX-License-Identifier: Apache-2.0
"""Lobes below the surface: the materials that have them, and the warnings about their pictures."""

from dataclasses import replace

import pytest

from mxeon.errors import InputError
from mxeon.hosts.base import LobeWarning
from mxeon.hosts.cycles import process
from mxeon.shaders.generation import generate
from mxeon.shaders.inner_lobes import inner_lobes
from mxeon.shaders.nodes import document_text
from mxeon.shaders.scene import SIDE, Paths
from tests.support.documents import material

LOBE = '<subsurface_bsdf name="{}" type="BSDF">{}</subsurface_bsdf>'
OPAQUE = '<burley_diffuse_bsdf name="opaque" type="BSDF"/>'
GLASS = (
    '<dielectric_bsdf name="lobe" type="BSDF">'
    '<input name="scatter_mode" type="string" value="{}"/></dielectric_bsdf>'
)


def number(name, value, kind="float"):
    return f'<input name="{name}" type="{kind}" value="{value}"/>'


def mixed(weight):
    sides = "".join(
        f'<input name="{side}" type="BSDF" nodename="{node}"/>'
        for side, node in (("fg", "inner"), ("bg", "opaque"))
    )
    mix = f'<mix name="lobe" type="BSDF">{sides}{weight}</mix>'
    return material(LOBE.format("inner", "") + OPAQUE + mix)


def surface(category, *inputs):
    shader = f'<{category} name="shading" type="surfaceshader">{"".join(inputs)}</{category}>'
    return document_text(shader)


@pytest.mark.parametrize(
    "text, kinds",
    [
        (material(LOBE.format("lobe", "")), ("subsurface",)),
        (material(LOBE.format("lobe", number("weight", 0.0))), ()),
        (material(OPAQUE.replace("opaque", "lobe")), ()),
        (material(GLASS.format("R")), ()),
        (material(GLASS.format("RT")), ("transmission",)),
        (mixed(number("mix", 0.5)), ("subsurface",)),
        (mixed(number("mix", 0.0)), ()),
        (surface("open_pbr_surface"), ()),
        (surface("open_pbr_surface", number("subsurface_weight", 0.5)), ("subsurface",)),
        (
            surface("open_pbr_surface", number("transmission_weight", 0.5)),
            ("transmission", "volume"),
        ),
        (
            surface(
                "open_pbr_surface",
                number("subsurface_weight", 1.0),
                number("geometry_thin_walled", "true", "boolean"),
            ),
            (),
        ),
        (surface("standard_surface", number("subsurface", 0.1)), ("subsurface",)),
        (surface("UsdPreviewSurface"), ()),
        (surface("UsdPreviewSurface", number("opacity", 0.5)), ("transmission",)),
    ],
)
def test_the_lobes_below_the_surface_are_those_that_have_an_effect(text, kinds):
    assert inner_lobes(generate(text, "glsl")[0]) == kinds


@pytest.mark.parametrize(
    "lobes, paths, words",
    [
        (("subsurface",), Paths(), ""),
        (("subsurface",), Paths(1), "needs at least 16 samples of a pixel; with 1"),
        (("subsurface",), Paths(process.FEWEST_SAMPLES, 1), ""),
        (("transmission",), Paths(None, 1), "needs 8 bounces; with 1"),
        (("transmission", "volume"), Paths(64, 8), ""),
    ],
)
def test_paths_that_are_too_few_are_named(lobes, paths, words):
    reasons = process.approximations(replace(SIDE, paths=paths), lobes)
    assert len(reasons) == bool(words) and words in "".join(reasons)


def test_a_rasterized_picture_says_what_it_has_in_place_of_a_lobe(gl, judged, tmp_path):
    file = tmp_path / "wax.mtlx"
    file.write_text(material(LOBE.format("lobe", "")))
    [reason] = gl.approximations(gl.compile(file)[0], SIDE)
    assert "subsurface_bsdf is rasterized" in reason
    assert judged.document(file).notes == ((reason, "wax.mtlx: look"),)
    assert str(LobeWarning("look", reason)) == f"look: {reason}"


def test_a_host_without_paths_refuses_them(reference):
    with pytest.raises(InputError, match="^reference: samples and bounces can be"):
        reference.refuse_paths(replace(SIDE, paths=Paths(bounces=2)))
