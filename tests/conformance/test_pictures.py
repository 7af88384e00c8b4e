# SPDX-License-Identifier: Apache-2.0
"""Pictures of documents match the NumPy reference. Failures have the right messages."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.errors import NotRun
from mxeon.io.images import write_exr
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import EON, connection_text, node_text
from mxeon.shaders.scene import FRONT, FURNACE, SIDE, Scene, sphere
from tests.support.documents import connected, lobe, material, written
from tests.support.verdicts import has
from tests.support.wrong_libraries import wrong_copy, wrong_stock


@pytest.fixture
def shown(judged, tmp_path):
    """Function that checks a document with one material; returns result, pictures and notes."""

    def show(text, library="eonlib"):
        path = written(tmp_path, text)
        found = judged.document(path, library=library)
        [result] = found.results
        return result, found.pictures, found.notes

    return show


FILM = {"roughness": (0.0, 0.0), "thinfilm_thickness": 550.0, "thinfilm_ior": 1.5}
# Template of a nodegraph that outputs a color. The names and the color are filled in later.
COLOR = """<nodegraph name="{graph}">
  <multiply name="{node}" type="color3">
    <input name="in1" type="color3" value="{color}"/>
    <input name="in2" type="float" value="0.5"/>
  </multiply>
  <output name="out" type="color3" nodename="{node}"/>
</nodegraph>"""
SUM = connected("lobe1", color='nodegraph="red" output="out"')
SUM += connected("lobe2", color='nodegraph="green" output="out"')
SUM += '<add name="lobe" type="BSDF"><input name="in1" type="BSDF" nodename="lobe1"/>'
SUM += '<input name="in2" type="BSDF" nodename="lobe2"/></add>'


def test_a_film_of_the_index_of_its_schlick_substrate_has_one_phase(shown):
    film = lobe("generalized_schlick_bsdf", color0=(0.04, 0.04, 0.04), **FILM)
    result, *_ = shown(material(film))
    assert result.verdict == "passed"
    assert result.error < 1e-4  # a reflection with the wrong phase would cause an error of 0.17


def test_direct_light_shows_a_wrong_curve_of_a_film_on_metal(shown, tmp_path):
    film = FILM | {"roughness": (0.1, 0.1), "thinfilm_thickness": 300.0}
    text = material(lobe("conductor_bsdf", **film))
    right, *_ = shown(text)
    position = ("2.2399e6, 1.7953e6", "2.2399e6, 1.8353e6")
    wrong, *_ = shown(text, wrong_copy(tmp_path, *position, "genglsl/lib/thin_film.glsl"))
    assert (right.verdict, wrong.verdict) == ("passed", "failed")
    assert 0.02 < wrong.error < 0.04 and wrong.tolerance < 0.02


def test_a_truth_value_is_drawn_white_or_black(shown):
    text = """<materialx version="1.39"><nodegraph name="logic">
      <and name="both" type="boolean">
        <input name="in1" type="boolean" value="true"/><input name="in2" type="boolean" value="true"/>
      </and><output name="shown" type="boolean" nodename="both"/></nodegraph></materialx>"""
    result, *_ = shown(text)
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("shown",))


def test_nodes_of_one_name_in_two_nodegraphs_are_named(shown):
    red = COLOR.format(graph="red", node="tint", color="1, 0, 0")
    green = COLOR.format(graph="green", node="tint", color="0, 1, 0")
    result, _, notes = shown(material(red + green + SUM))
    assert result.verdict == "failed"
    assert has(result, "same_names", '"red/tint" and "green/tint"')
    assert any("must have different names" in text for text, _ in notes)


# --- unsupported patterns: the reference takes their values from the host -----------------------

LOBE = connected(
    color='nodename="pattern"', roughness='value="1"', energy_compensation='value="true"'
)
NOISE = """<cellnoise2d name="noise" type="float">
  <input name="texcoord" type="vector2" nodename="placed"/>
</cellnoise2d>
<place2d name="placed" type="vector2">
  <input name="texcoord" type="vector2" nodename="where"/>
  <input name="scale" type="vector2" value="0.1, 0.1"/>
</place2d>
<texcoord name="where" type="vector2"/>
<convert name="pattern" type="color3"><input name="in" type="float" nodename="noise"/></convert>"""
TILED = """<tiledimage name="pattern" type="color3">
  <input name="file" type="filename" value="checks.exr"/>
  <input name="uvtiling" type="vector2" value="3, 2"/>
</tiledimage>"""


def test_the_color_of_a_noise_comes_from_the_host(shown):
    result, pictures, _ = shown(material(NOISE + LOBE))
    assert (result.check, result.verdict) == ("picture", "passed")
    assert result.measured == ("lobe.color",)
    assert {picture.metadata["from the host"] for picture in pictures} == {"lobe.color"}
    assert np.ptp(pictures[0].reference[128]) > 0.5  # the noise pattern is visible


def test_the_color_of_a_noise_in_a_node_of_its_own_comes_from_the_host(shown):
    mixed = """<mix name="pattern" type="color3"><input name="fg" type="color3" value="0.2, 0.8, 0.4"/>
      <input name="mix" type="float" nodename="noise"/></mix>"""
    own = f"""<nodedef name="ND_own" node="own"><output name="out" type="BSDF"/></nodedef>
      <nodegraph name="NG_own" nodedef="ND_own" colorspace="srgb_texture">{NOISE[: NOISE.index("<convert")]}
      {mixed}{LOBE}<output name="out" type="BSDF" nodename="lobe"/></nodegraph><own name="lobe" type="BSDF"/>"""
    text = material(own).replace("<materialx ", '<materialx colorspace="lin_rec709" ')
    result, *_ = shown(text)
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("lobe.color",))


def test_a_wrong_lobe_behind_a_measured_input_is_found(shown):
    result, *_ = shown(material(NOISE + LOBE), "stock")
    assert (result.check, result.verdict, result.measured) == ("picture", "failed", ("lobe.color",))
    assert result.error > 100 * result.tolerance


def test_an_image_with_a_transform_comes_from_the_host(shown, tmp_path):
    checks = np.indices((8, 8)).sum(axis=0)[..., np.newaxis] % 2 * np.array([0.8, 0.4, 0.2])
    write_exr(tmp_path / "checks.exr", checks.astype(np.float32), {})
    result, *_ = shown(material(TILED + LOBE))
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("lobe.color",))


def test_a_pattern_alone_is_what_a_surface_emits_of_it(shown):
    output = '<output name="shown" type="float" nodename="noise"/>'
    text = f'<materialx version="1.39">{NOISE}{output}</materialx>'
    result, *_ = shown(text)
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("shown",))


def test_materials_that_vary_are_judged_and_compared_at_some_of_the_pixels(shown):
    port = connection_text("roughness", "vector2", "rough")
    metal = node_text("conductor_bsdf", "BSDF", "lobe", port)
    metal += node_text("convert", "vector2", "rough", connection_text("in", "float", "noise"))
    result, pictures, _ = shown(material(NOISE + metal))
    furnace = pictures[-1]
    assert 700 < furnace.judged.sum() < 900
    # In the difference map, pixels that were not judged get the difference of a judged neighbor.
    assert np.abs(furnace.image - furnace.reference).max() > 10.0 * result.tolerance
    assert np.nanmax(furnace.difference_map()) < 3.0 * result.tolerance


# --- light through a surface: transmission, volumes, and lobes below the surface ------------------

GLASS = {"tint": (0.2, 0.5, 0.9), "scatter_mode": "T"}


def glass(name="lobe", **inputs):
    return lobe("dielectric_bsdf", name, **GLASS | inputs)


FOG = """<anisotropic_vdf name="fog" type="VDF"><input name="scattering" type="vector3"
  value="0, 1, 0"/></anisotropic_vdf>"""
HAZE = """<layer name="lobe" type="BSDF"><input name="top" type="BSDF" nodename="glass"/>
  <input name="base" type="VDF" nodename="fog"/></layer>"""


@pytest.fixture
def lit(reference):
    """Function that renders nodes in a scene with the NumPy reference."""
    return lambda text, scene: reference.picture(
        generate(material(text), "glsl")[0], replace(scene, size=32)
    )


def test_what_is_transmitted_of_a_furnace_is_what_is_not_reflected(lit):
    whole = glass(tint=(1.0, 1.0, 1.0), scatter_mode="RT")
    assert np.allclose(lit(whole, FURNACE)[sphere(32).mask], 1.0, atol=1e-9)
    assert not lit(glass(), SIDE).any()


def test_a_volume_dims_what_is_transmitted_and_not_what_is_reflected(lit):
    clear, foggy = (lit(each, FURNACE) for each in (glass(), glass("glass") + FOG + HAZE))
    assert np.allclose(foggy, clear * [1.0, np.exp(-1.0), 1.0], atol=1e-12)
    reflected = lit(glass("glass", scatter_mode="R") + FOG + HAZE, FURNACE)
    assert np.allclose(reflected, lit(glass(scatter_mode="R"), FURNACE))


WAX = lobe("subsurface_bsdf", radius=(0.5, 0.2, 0.05))


@pytest.mark.parametrize("node", [glass(scatter_mode="RT"), WAX, lobe("chiang_hair_bsdf")])
def test_lobes_below_the_surface_have_a_picture_like_gl(shown, node):
    result, *_ = shown(material(node))
    assert (result.check, result.verdict) == ("picture", "passed")
    # JSON does not support NumPy's number types.
    assert type(result.tolerance) is float and type(result.control.caught) is bool


@pytest.mark.parametrize("node", [lobe("subsurface_bsdf"), glass(roughness=(0.8, 0.8))])
def test_a_wrong_lobe_below_the_surface_is_found(shown, node):
    result, *_ = shown(material(node), "stock")
    assert (result.check, result.verdict) == ("picture", "failed")


def test_a_zeltner_sheen_has_no_tolerance_of_microfacets(shown, tmp_path):
    text = material(lobe("sheen_bsdf", mode="zeltner"))
    right, *_ = shown(text)
    old, new = "bsdf.response = lobe * color", "bsdf.response = 1.001 * lobe * color"
    wrong, *_ = shown(text, wrong_copy(tmp_path, old, new, "genglsl/sheen_bsdf.glsl"))
    assert (right.verdict, wrong.verdict) == ("passed", "failed") and right.tolerance < 2e-5


def test_the_first_wrong_node_of_a_pattern_is_named(shown, tmp_path):
    text = material(
        """<normalmap name="bump" type="vector3"><input name="in" type="vector3" value="0.6, 0.5, 0.9"/>
        <input name="scale" type="float" value="0.4"/></normalmap>
        <burley_diffuse_bsdf name="lobe" type="BSDF"><input name="normal" type="vector3" nodename="bump"/>
        </burley_diffuse_bsdf>"""
    )
    change = ("value.x * normal_scale.x", "value.x")
    library = wrong_stock(tmp_path / "library", "stdlib/genglsl/mx_normalmap.glsl", change)
    result, *_ = shown(text, library)
    assert result.verdict == "failed" and has(result, "other_node", "normalmap", "bump")


# --- nodes that the models do not cover --------------------------------------------------------


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
        (lobe(EON, color=(0.8, 0.4, 0.1)), Scene("sky", environment="sky.exr"), "must be uniform"),
    ],
    ids=["noise", "color space", "image of an environment"],
)
def test_what_the_models_do_not_cover_did_not_run(reference, nodes, scene, words):
    managed = material(nodes).replace("<materialx ", '<materialx colorspace="lin_rec709" ')
    shader = generate(managed, "glsl")[0]
    with pytest.raises(NotRun, match=words):
        reference.picture(shader, scene)


@pytest.mark.parametrize(
    "name, value, high",
    [("color", "0.5, 1.5, 0.5", "1"), ("weight", "1.5", "1"), ("roughness", "1.6", "pi/2")],
)
def test_a_value_outside_its_model_is_not_judged(shown, name, value, high):
    result, pictures, notes = shown(material(lobe(**{name: value})))
    assert result.verdict == "not run" and not pictures
    rule = f"must lie in [0, {high}], where its model is defined; got {value}"
    assert result.reason == f'input "lobe/{name}" {rule}' and not notes
    assert has(result, "input", f"lobe/{name}")
