# SPDX-License-Identifier: Apache-2.0
"""The models as a host: graphs of lobes and layers, and what they cannot say."""

import numpy as np
import pytest

from mxeon.conformance.pictures import judge_document
from mxeon.conformance.reference import Host as Reference
from mxeon.errors import NotRun
from mxeon.hosts import open_host
from mxeon.models.diffuse.brdf import eon_brdf
from mxeon.models.sheen import (
    conty_kulla_albedo_dir,
    conty_kulla_brdf,
    zeltner_albedo_dir,
    zeltner_brdf,
)
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import EON, document_text
from mxeon.shaders.scene import FRONT, Scene
from tests.support.documents import lobe, material

A = f'<{EON} name="a" type="BSDF"><input name="color" type="color3" value="0.8, 0.4, 0.1"/></{EON}>'
B = f'<{EON} name="b" type="BSDF"><input name="color" type="color3" value="0.1, 0.2, 0.6"/></{EON}>'
OUTSIDE = (
    ({"color": "0.5, 1.5, 0.5"}, "color must lie in [0, 1]; got 1.5"),
    ({"weight": "1.5"}, "weight must lie in [0, 1]; got 1.5"),
    ({"roughness": "1.6"}, "roughness must lie in [0, pi/2]; got 1.6"),
)
CENTER = np.s_[15:17, 15:17]
SMALL = Scene("front", light=(0.0, 0.0, 1.0), size=32)


def center(text):
    """The picture's middle, where a smooth lobe under frontal light shows nearly its color."""
    image = Reference().picture(generate(text, "glsl")[0], SMALL)
    return image[CENTER].mean(axis=(0, 1))


def color(*channels):
    """What a Lambertian of this color shows there."""
    node = f'<{EON} name="lobe" type="BSDF"><input name="color" type="color3" value="{channels}"/>'
    return center(material(f"{node}</{EON}>".replace("(", "").replace(")", "")))


@pytest.mark.parametrize(
    "nodes, channels",
    [
        (
            f"""{A}{B}<mix name="lobe" type="BSDF"><input name="fg" type="BSDF" nodename="a"/>
            <input name="bg" type="BSDF" nodename="b"/><input name="mix" type="float" value="0.25"/>
            </mix>""",
            (0.275, 0.25, 0.475),
        ),
        (
            f"""{A}{B}<add name="lobe" type="BSDF"><input name="in1" type="BSDF" nodename="a"/>
            <input name="in2" type="BSDF" nodename="b"/></add>""",
            (0.9, 0.6, 0.7),
        ),
        (
            f"""{A}<multiply name="lobe" type="BSDF"><input name="in1" type="BSDF" nodename="a"/>
            <input name="in2" type="color3" value="0.5, 1.0, 0.0"/></multiply>""",
            (0.4, 0.4, 0.0),
        ),
        (
            f"""{A}<multiply name="lobe" type="BSDF"><input name="in1" type="BSDF" nodename="a"/>
            <input name="in2" type="float" value="0.5"/></multiply>""",
            (0.4, 0.2, 0.05),
        ),
        (
            f"""<constant name="c" type="color3"><input name="value" type="color3"
            value="0.3, 0.2, 0.1"/></constant><{EON} name="lobe" type="BSDF">
            <input name="color" type="color3" nodename="c"/>
            <input name="weight" type="float" value="0.5"/></{EON}>""",
            (0.15, 0.1, 0.05),
        ),
    ],
    ids=["mix", "add", "multiply by a color", "multiply by a number", "constant and weight"],
)
def test_lobes_combine_as_their_nodes_say(nodes, channels):
    assert np.allclose(center(material(nodes)), color(*channels), rtol=1e-6, atol=1e-9)


def test_a_nodegraph_hands_its_inputs_down():
    text = f"""<materialx version="1.39">
      <nodedef name="ND_paint" node="paint"><input name="tone" type="color3" value="1, 1, 1"/>
        <output name="out" type="BSDF"/></nodedef>
      <nodegraph name="NG_paint" nodedef="ND_paint">
        <{EON} name="lobe" type="BSDF"><input name="color" type="color3" interfacename="tone"/></{EON}>
        <output name="out" type="BSDF" nodename="lobe"/></nodegraph>
      <paint name="wall" type="BSDF"><input name="tone" type="color3" value="0.6, 0.3, 0.2"/></paint>
      <surface name="shading" type="surfaceshader">
        <input name="bsdf" type="BSDF" nodename="wall"/></surface>
      <surfacematerial name="look" type="material">
        <input name="surfaceshader" type="surfaceshader" nodename="shading"/></surfacematerial>
    </materialx>"""
    assert np.allclose(center(text), color(0.6, 0.3, 0.2), rtol=1e-6)


def test_a_color_in_srgb_becomes_linear():
    node = f"""<{EON} name="lobe" type="BSDF"><input name="color" type="color3"
      value="0.5, 0.02, 1.0" colorspace="srgb_texture"/></{EON}>"""
    text = material(node).replace('version="1.39"', 'version="1.39" colorspace="lin_rec709"')
    linear = ((0.5 + 0.055) / 1.055) ** 2.4
    assert np.allclose(center(text), color(linear, 0.02 / 12.92, 1.0), rtol=1e-6)


def with_alpha(space):
    """A document whose color is a color4 in a color space."""
    node = f"""<constant name="paint" type="color4">
        <input name="value" type="color4" value="0.5, 0.02, 1.0, 0.5" colorspace="{space}"/></constant>
      <convert name="opaque" type="color3"><input name="in" type="color4" nodename="paint"/></convert>
      <{EON} name="lobe" type="BSDF"><input name="color" type="color3" nodename="opaque"/></{EON}>"""
    return material(node).replace('version="1.39"', 'version="1.39" colorspace="lin_rec709"')


@pytest.mark.parametrize("space", ["srgb_texture", "srgb_rec709_scene"])
def test_a_color_with_alpha_becomes_linear(space):
    linear = ((0.5 + 0.055) / 1.055) ** 2.4
    expected = color(linear, 0.02 / 12.92, 1.0)
    assert np.allclose(center(with_alpha(space)), expected, rtol=1e-6)


def test_a_length_is_in_meters():
    node = f'<{EON} name="lobe" type="BSDF"><input name="weight" type="float" {{}}/></{EON}>'
    length = 'value="0.0005" unittype="distance" unit="kilometer"'
    images = [center(material(node.format(words))) for words in (length, 'value="0.5"')]
    assert np.allclose(*images, rtol=1e-6)


@pytest.mark.parametrize(
    "nodes, scene, words",
    [
        (
            f"""<noise2d name="bump" type="vector3"/><{EON} name="lobe" type="BSDF">
            <input name="normal" type="vector3" nodename="bump"/></{EON}>""",
            FRONT,
            "no model for node 'noise2d'",
        ),
        (
            f"""<{EON} name="lobe" type="BSDF"><input name="color" type="color3"
            value="0.5, 0.5, 0.5" colorspace="acescg"/></{EON}>""",
            FRONT,
            "no transform from color space acescg to lin_rec709",
        ),
        (A.replace('"a"', '"lobe"'), Scene("sky", environment="sky.exr"), "must be uniform"),
    ],
    ids=["noise", "color space", "image of an environment"],
)
def test_what_the_models_do_not_cover_did_not_run(nodes, scene, words):
    managed = material(nodes).replace("<materialx ", '<materialx colorspace="lin_rec709" ')
    shader = generate(managed, "glsl")[0]
    with pytest.raises(NotRun, match=words):
        Reference().picture(shader, scene)


def turned(category, normal, tangent):
    """A lobe with a normal and a tangent, each a node of its own."""
    return f"""<constant name="n" type="vector3"><input name="value" type="vector3"
      value="{normal}"/></constant><constant name="t" type="vector3"><input name="value"
      type="vector3" value="{tangent}"/></constant><{category} name="lobe" type="BSDF">
      <input name="roughness" type="vector2" value="0.2, 0.6"/>
      <input name="normal" type="vector3" nodename="n"/>
      <input name="tangent" type="vector3" nodename="t"/></{category}>"""


def test_a_lobe_has_the_frame_of_its_normal_and_tangent():
    wo, wi = np.array([[0.6, 0.0, 0.8]]), np.array([[0.0, -0.8, 0.6]])
    axes = np.array([[0.0, 1.0, 0.0], [-0.8, 0.0, 0.6], [0.6, 0.0, 0.8]])
    nodes = turned("conductor_bsdf", "0.6, 0.0, 0.8", "0.0, 1.0, 0.0")
    values = Reference().evaluate(generate(material(nodes), "glsl")[0], wo, wi, {}, "direct")
    straight = """<conductor_bsdf name="lobe" type="BSDF">
      <input name="roughness" type="vector2" value="0.2, 0.6"/></conductor_bsdf>"""
    shader = generate(material(straight), "glsl")[0]
    expected = Reference().evaluate(shader, wo @ axes.T, wi @ axes.T, {}, "direct")
    assert np.allclose(values, expected, rtol=1e-9)


def test_emission_is_scaled_by_the_opacity():
    text = document_text("""<uniform_edf name="lamp" type="EDF">
      <input name="color" type="color3" value="2, 4, 6"/></uniform_edf>
      <surface name="shading" type="surfaceshader"><input name="edf" type="EDF" nodename="lamp"/>
      <input name="opacity" type="float" value="0.5"/></surface>""")
    assert np.allclose(center(text), [1.0, 2.0, 3.0])


@pytest.mark.parametrize("inputs, rule", OUTSIDE, ids=str)
def test_a_value_outside_its_model_is_not_judged(tmp_path, inputs, rule):
    path = tmp_path / "look.mtlx"
    path.write_text(material(lobe(**inputs)))
    hosts = open_host("gl"), Reference()
    [result], pictures, notes = judge_document(path, *hosts, "eonlib")
    assert result.verdict == "not run" and not pictures
    assert f"reference: node 'lobe': {rule}" in result.reason
    assert "where its model is defined" in notes[0][0]


SHEEN = """<sheen_bsdf name="{name}" type="BSDF"><input name="color" type="color3" value="{color}"/>
  <input name="roughness" type="float" value="0.3"/>
  <input name="mode" type="string" value="{mode}"/></sheen_bsdf>"""
WHITE = f"""<{EON} name="base" type="BSDF">
  <input name="color" type="color3" value="1, 1, 1"/></{EON}>"""
LAYER = """<layer name="lobe" type="BSDF"><input name="top" type="BSDF" nodename="{top}"/>
  <input name="base" type="BSDF" nodename="{base}"/></layer>"""
SHEENS = (
    ("conty_kulla", conty_kulla_brdf, conty_kulla_albedo_dir),
    ("zeltner", zeltner_brdf, zeltner_albedo_dir),
)
every_sheen = pytest.mark.parametrize(
    "mode, brdf, albedo", SHEENS, ids=lambda each: getattr(each, "__name__", str(each))
)


def layered(mode, color="0.5, 1, 0.25"):
    """Sheen over a white base."""
    top = SHEEN.format(name="top", mode=mode, color=color)
    return material(top + WHITE + LAYER.format(top="top", base="base"))


@every_sheen
def test_a_layer_darkens_its_base_by_its_albedo(mode, brdf, albedo):
    shader = generate(layered(mode), "glsl")[0]
    wo, wi = np.array([[0.6, 0.0, 0.8]]), np.array([[0.0, -0.8, 0.6]])
    tint = np.array([0.5, 1.0, 0.25])
    values = Reference().evaluate(shader, wo, wi, {}, "direct")
    left = 1.0 - tint * albedo(0.8, 0.3)
    expected = 0.6 * (brdf(wo, wi, tint, 0.3) + left * eon_brdf(wo, wi, 1.0, 0.0))
    assert np.allclose(values, expected, rtol=1e-9)
    # The tint is part of the albedo, so what it does not reflect reaches the base.
    assert np.allclose(Reference().evaluate(shader, wo, wi, {}, "environment"), 1.0, rtol=1e-12)
