# SPDX-License-Identifier: Apache-2.0
"""Storm and MaterialX's renderer match the models, show known defects, and report failures."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import host_row, materialx, storm
from mxeon.shaders.library import examples_folder
from mxeon.shaders.methods import Methods
from mxeon.shaders.nodes import OREN_NAYAR, document_text, material_text
from mxeon.shaders.scene import FRONT, FURNACE, SIDE, sphere
from tests.support.cases import direction
from tests.support.documents import image, lobe, material, surface, written
from tests.support.verdicts import FAILED, PASSED, has
from tests.support.wrong_libraries import wrong_copy

HOSTS = {"storm": storm.StormHost, "materialx": materialx.MaterialXHost}
DOCUMENT = examples_folder() / "eon_node.mtlx"
SMALL = replace(FRONT, size=16)
EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
# Errors of pixels stored as half floats. Direct light has two roundings of 2^-11, and light from an
# environment has four.
HALF, HALF_SURROUNDINGS = 2.0**-10 + 248 * 2.0**-24, 2.0**-9 + 2e-6
TEXTURED = 2.0**-8  # precision of filter weights that OpenGL guarantees


@pytest.fixture(scope="module", params=HOSTS)
def host(request, hosts):
    return hosts(request.param)


@pytest.fixture(scope="module")
def on_storm(hosts):
    return hosts("storm")


def test_a_document_is_that_of_the_reference(host, judged):
    found = judged.document(DOCUMENT, host.name)
    assert {each.verdict for each in found.results} == {PASSED}
    assert len(found.pictures) == len(found.results) * len(host_row(host.name).scenes)


def test_textures_are_those_of_the_reference(host, reference):
    [shader] = host.compile(examples_folder() / "brick.mtlx")
    scene = replace(SIDE, size=128)
    difference = host.picture(shader, scene) - reference.picture(shader, scene)
    facing = sphere(128).normal[..., 2:]
    assert np.abs(difference * facing).max() <= TEXTURED + HALF


def test_a_textured_material_is_seen_at_the_exact_points(on_storm, tmp_path):
    """Storm renders a textured material in blocks of pixels. The material here emits positions."""
    nodes = (
        '<position name="point" type="vector3"><input name="space" type="string" value="world"/>'
        '</position><convert name="color" type="color3"><input name="in" type="vector3"'
        ' nodename="point"/></convert><mix name="mixed" type="color3"><input name="fg" type="color3"'
        ' nodename="image"/><input name="bg" type="color3" nodename="color"/></mix>'
        '<uniform_edf name="edf" type="EDF"><input name="color" type="color3" nodename="mixed"/>'
        '</uniform_edf><surface name="shading" type="surfaceshader"><input name="edf" type="EDF"'
        ' nodename="edf"/></surface>'
    )
    shutil.copy(examples_folder() / "textures" / "brick_color.png", tmp_path)
    text = document_text(image("brick_color.png") + nodes)
    [shader] = on_storm.compile(written(tmp_path, text))
    points = sphere(16)
    seen = points.mask & (points.position.min(axis=-1) > 0.0)  # negative values cannot be emitted
    # Storm's camera is so far away that float32 rounds z to a sixteenth.
    found, exact = on_storm.picture(shader, SMALL)[seen], points.position[seen]
    assert np.abs(found - exact)[:, :2].max() <= HALF


def test_subsurface_scattering_on_flat_quads_is_not_judged(host, judged, tmp_path):
    path = written(tmp_path, material(lobe("subsurface_bsdf", radius=(0.3, 0.1, 0.05))))
    [result] = judged.document(path, host.name).results
    assert result.check == "finite" and result.verdict == PASSED
    assert "curvature" in result.diagnosis.first.text


@pytest.mark.parametrize("environment", ["fis", "prefilter"])
@pytest.mark.parametrize("node", ["dielectric_bsdf, scatter_mode R", "conductor_bsdf"])
def test_an_environment_of_microfacets_is_judged_on_pictures(judged, node, environment):
    result = judged("environment", node, "materialx", methods=Methods(environment))
    assert result.verdict == PASSED, result


def test_materialx_binds_the_table_of_albedos_that_it_is_given(hosts, gl):
    text = material(lobe("conductor_bsdf", roughness=(0.6, 0.6)))
    pictures = []
    for each in (gl, hosts("materialx")):
        [shader] = each.compile(text, library="stock", methods=Methods("prefilter", albedo="table"))
        pictures.append(each.picture(shader, replace(FURNACE, size=16)))
    assert np.abs(pictures[0] - pictures[1]).max() <= HALF_SURROUNDINGS - HALF
    assert pictures[0][sphere(16).mask][:, 0].min() > 0.9  # the red channel of gold


def test_the_dome_of_storm_is_given_what_its_sum_loses(on_storm):
    """If mxeon did not brighten Storm's dome, the picture would be too dark by eight tolerances."""
    white = material_text(OREN_NAYAR, {"color": (1.0, 1.0, 1.0), "roughness": 0.0})
    [shader] = on_storm.compile(white)
    picture = on_storm.picture(shader, replace(FURNACE, size=16))[sphere(16).mask]
    assert np.abs(picture - 1.0).max() <= HALF_SURROUNDINGS
    darker = replace(FURNACE, size=16, environment=0.9844)
    assert np.abs(on_storm.picture(shader, darker)[sphere(16).mask] - 1.0).min() > 0.015


def test_a_later_input_is_refused_in_a_sentence(on_storm):
    [shader] = on_storm.compile(material(lobe("dielectric_bsdf", retroreflective="true")))
    message = "^storm: OpenUSD .*, MaterialX 1.39.3 cannot show the document: .*nodedef for 'lobe'"
    with pytest.raises(NotRun, match=message):
        on_storm.picture(shader, SMALL)


def test_an_enumerated_input_is_said_not_to_be_read(on_storm, gl):
    def unread(mode):
        return on_storm.unread(on_storm.compile(material(lobe("sheen_bsdf", mode=mode)))[0])

    assert unread("conty_kulla") == ""
    assert unread("zeltner").endswith("of enumerated inputs, here of lobe/mode")
    [shader] = on_storm.compile(material(lobe("sheen_bsdf", mode="zeltner")))
    other = on_storm.compile(material(lobe("sheen_bsdf", mode="conty_kulla")))[0]
    np.testing.assert_array_equal(*(on_storm.picture(each, SMALL) for each in (shader, other)))
    assert gl.unread(shader) == ""


def test_stock_is_wrong_from_behind(host, judged):
    result = judged("value", EON, host.name, "stock")
    assert result.verdict == FAILED
    assert has(result, "model", "EON with clamped dot(wo, wi)")
    assert result.pages == ("genglsl_clamped_dot",)


GLASS = surface("open_pbr_surface", transmission_weight=1.0, specular_roughness=0.8)
# Storm renders transmission as opacity. The layer in mode R already subtracts the reflected light,
# so the lobe in mode T below must not subtract the light again. In the modified copy, both lobes
# subtract reflected light.
BELOW = "bool below = scatter_mode == 1;", "bool below = false;"


def test_a_card_shows_through_rough_glass_in_storm(on_storm, gl, tmp_path):
    points = sphere(16)
    facing = points.mask & (points.normal[..., 2] > 0.05)
    normal = points.normal[facing]
    view = np.stack([np.hypot(normal[:, 0], normal[:, 1]), 0.0 * normal[:, 0], normal[:, 2]], 1)

    def through(library):
        [shader] = on_storm.compile(GLASS, library=library)
        return on_storm.transmitted(shader, 16)[facing]

    [shader] = gl.compile(GLASS, methods=on_storm.active)
    expected = gl.evaluate(shader, view, view, {}, "transmission")
    found = through("eonlib")
    assert np.abs(found - expected).max() <= 2 * HALF
    assert found.min() >= 0.88
    wrong = through(wrong_copy(tmp_path, *BELOW, "genglsl/lib/microfacet_transmission.glsl"))
    assert np.abs(wrong - expected).max() > 20 * HALF


COAT = lobe("dielectric_bsdf", "coat", roughness=(0.1, 0.1))
COAT += lobe(name="base", color=(1.0, 1.0, 1.0))
COAT += '<layer name="lobe" type="BSDF"><input name="top" type="BSDF" nodename="coat"/>'
COAT += '<input name="base" type="BSDF" nodename="base"/></layer>'
WHITE = dict.fromkeys(("color0", "color82"), (1.0, 1.0, 1.0))
METAL = lobe("generalized_schlick_bsdf", **WHITE, roughness=(0.8, 0.8))
CONDUCTOR = lobe("conductor_bsdf", roughness=(0.4, 0.4))
# Mutations of lines that other hosts never compile, because only the hosts in this file use the
# folder `genglsl/environment`.
PREFILTER = "genglsl/environment/libraries/pbrlib/genglsl/lib/mx_environment_prefilter.glsl"
DIM = ("Radiance) * $envLight", "Radiance) * 0.8 * $envLight", PREFILTER)
WHOLE = ("mean * lobe.albedo * ", "mean * ", "genglsl/lib/microfacet_lobe.glsl")
FITTED = "mx_ggx_dir_albedo(lobe.mu_o, lobe.alpha, F0, vec3(1.0))", "vec3(1.0)"


@pytest.mark.parametrize(
    ("text", "change"),
    [(COAT, DIM), (METAL, WHOLE), (CONDUCTOR, (*FITTED, "genglsl/conductor_bsdf.glsl"))],
    ids=["coat", "metal", "conductor"],
)
def test_microfacets_in_the_dome_of_storm_are_as_bright_as_their_albedo(
    on_storm, gl, text, change, tmp_path
):
    """mxeon brightens Storm's dome by 1 / 0.984 for diffuse lobes, but not for microfacets."""
    points = sphere(16)
    facing = points.mask & (points.normal[..., 2] > 0.05)
    view = direction(points.normal[facing][:, 2])
    [shader] = gl.compile(material(text))
    expected = gl.evaluate(shader, view, view, {}, "environment")

    def error(library):
        [shader] = on_storm.compile(material(text), library=library)
        found = on_storm.picture(shader, replace(FURNACE, size=16))[facing]
        return np.abs(found - np.clip(found, expected, expected / 0.984)).max()

    # eonlib approximates a conductor's average reflectance from both ends of the Fresnel curve.
    assert error("eonlib") <= 8e-3
    assert min(error("stock"), error(wrong_copy(tmp_path, *change))) >= 0.02


def test_a_shader_that_does_not_compile_is_a_shader_error(host, tmp_path):
    old, new = "float s = dot(wo, wi) - mu_o * mu_i;", "float s = no_such_function(wo);"
    library = wrong_copy(tmp_path, old, new, "genglsl/lib/oren_nayar_lobe.glsl")
    [shader] = host.compile(material_text(OREN_NAYAR, {}), library=library)
    with pytest.raises(ShaderError, match=f"^{host.name}: .*no_such_function"):
        host.picture(shader, SMALL)
