# SPDX-License-Identifier: Apache-2.0
"""OpenGL pictures: exact points, the right way up, and light as it is asked for."""

import gc
from dataclasses import replace

import moderngl
import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.conformance.reference import Host as Reference
from mxeon.errors import NotRun
from mxeon.hosts import fragment, open_host
from mxeon.hosts.textures import irradiance, read_latlong
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import EON, OREN_NAYAR, document_text, material_text
from mxeon.shaders.scene import FRONT, FURNACE, SCENES, Scene, sphere
from mxeon.shaders.shader_ball import shader_ball
from tests.support.cases import directions_32
from tests.support.documents import material
from tests.support.tolerances import MICROFACET_VALUE, PICTURE

SIZE = 96
ROUGH = '<input name="roughness" type="float" value="0.9"/>'
COLOR = '<input name="color" type="color3" value="0.8, 0.4, 0.1"/>'
TRUE = '<input name="energy_compensation" type="boolean" value="true"/>'
LOBES = {
    "eon": f'<{OREN_NAYAR} name="lobe" type="BSDF">{ROUGH}{COLOR}{TRUE}</{OREN_NAYAR}>',
    "qon": f'<{OREN_NAYAR} name="lobe" type="BSDF">{ROUGH}{COLOR}</{OREN_NAYAR}>',
    "node": f'<{EON} name="lobe" type="BSDF">{ROUGH}{COLOR}</{EON}>',
}


def shader(nodes):
    return generate(material(nodes), "glsl", lights=True, policy=Policy(outside=True))[0]


def picture(host, nodes, scene):
    return host.picture(shader(nodes), replace(scene, size=SIZE))


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
@pytest.mark.parametrize("name", LOBES)
def test_every_pixel_is_the_models(gl, reference, name, scene):
    image, expected = (picture(host, LOBES[name], scene) for host in (gl, reference))
    points = sphere(SIZE)
    mask = points.mask
    error = np.abs(image - expected)[mask].max(axis=1) * points.normal[mask][:, 2]
    assert error.max() <= PICTURE
    assert not image[~mask].any()


def test_the_shader_ball_is_drawn_at_its_points(gl):
    lambert = f'<{EON} name="lobe" type="BSDF">{COLOR}</{EON}>'
    image = picture(gl, lambert, replace(FRONT, shape="ball"))
    points = shader_ball(SIZE)
    cosine = np.where(points.mask, points.normal[..., 2], 0.0)[..., None]
    assert np.abs(image - cosine * [0.8, 0.4, 0.1]).max() <= PICTURE


def test_a_closed_host_takes_no_program_from_the_next():
    closed = open_host("gl")
    for name in LOBES:
        picture(closed, LOBES[name], FURNACE)
    closed.close()
    following = open_host("gl")
    before = [picture(following, LOBES[name], FURNACE) for name in LOBES]
    del closed
    with following._context:
        gc.collect()
    after = [picture(following, LOBES[name], FURNACE) for name in LOBES]
    following.close()
    assert np.array_equal(before, after)


def test_light_from_the_right_lights_the_right_and_from_above_the_top(gl):
    right = picture(gl, LOBES["eon"], Scene("right", light=(1.0, 0.0, 0.0)))
    above = picture(gl, LOBES["eon"], Scene("above", light=(0.0, 1.0, 0.0)))
    half = SIZE // 2
    assert right[:, half:].any() and not right[:, :half].any()
    assert above[:half].any() and not above[half:].any()


def test_a_texture_stands_upright(gl, reference, tmp_path):
    texels = np.zeros((8, 16, 3), dtype=np.float32)
    texels[:4, :, 0], texels[4:, :, 2] = 0.9, 0.6  # red above, blue below
    oiio.ImageBuf(texels).write(str(tmp_path / "flag.exr"))
    nodes = f"""<image name="flag" type="color3">
        <input name="file" type="filename" value="{tmp_path / "flag.exr"}"/>
      </image>
      <{EON} name="lobe" type="BSDF"><input name="color" type="color3" nodename="flag"/></{EON}>"""
    front = Scene("front", light=(0.0, 0.0, 1.0))
    image, expected = (picture(host, nodes, front) for host in (gl, reference))
    top, bottom = image[SIZE // 4, SIZE // 2], image[3 * SIZE // 4, SIZE // 2]
    assert top[0] > 0.5 > top[2] and bottom[2] > 0.4 > bottom[0]
    assert np.abs(image - expected)[sphere(SIZE).mask].max() <= 2.0**-8  # filter weights


def test_an_environment_image_lights_by_its_irradiance(gl, tmp_path):
    sky = np.zeros((32, 64, 3), dtype=np.float32)
    sky[:16] = [0.2, 0.4, 1.0]  # blue from above, nothing from below
    oiio.ImageBuf(sky).write(str(tmp_path / "sky.exr"))
    white = f'<{EON} name="lobe" type="BSDF">{COLOR.replace("0.8, 0.4, 0.1", "1, 1, 1")}</{EON}>'
    image = picture(gl, white, Scene("sky", environment=tmp_path / "sky.exr"))
    top, bottom = image[1, SIZE // 2], image[-2, SIZE // 2]
    assert np.allclose(top, [0.2, 0.4, 1.0], atol=0.02) and bottom.max() < 0.02
    assert irradiance(read_latlong(0.5)).max() == 0.5


def test_a_normal_that_faces_away_is_turned_and_light_below_the_horizon_gives_nothing(gl):
    wo, wi = np.array([[0.6, 0.0, 0.8]]), np.array([[0.0, 0.8, 0.6], [0.0, 0.8, -0.6]])
    wo = np.repeat(wo, 2, axis=0)
    inputs = {"color": (0.5, 0.5, 0.5), "roughness": 1.0, "energy_compensation": True}
    up, down = (
        gl.evaluate(shader(LOBES["eon"]), wo, wi, {**inputs, "normal": (0.0, 0.0, z)}, "direct")
        for z in (1.0, -1.0)
    )
    assert np.array_equal(up, down) and up[0].min() > 0.0 and not up[1].any()


@pytest.mark.parametrize("branch", ["direct", "environment"])
@pytest.mark.parametrize("flag", [True, False])
def test_inputs_outside_their_ranges_give_finite_numbers(gl, flag, branch):
    rng = np.random.default_rng(1)
    wo, wi = directions_32(rng, 4096), directions_32(rng, 4096)
    inputs = {
        "color": rng.uniform(-1.0, 1.0, (4096, 3)),
        "roughness": rng.uniform(-1.0, 10.0, 4096),
        "weight": rng.uniform(-1.0, 2.0, 4096),
        "energy_compensation": flag,
    }
    values = gl.evaluate(shader(LOBES["eon"]), wo, wi, inputs, branch)
    assert np.isfinite(values).all()
    assert not values[inputs["weight"] < 0.0].any()


def test_nodes_are_evaluated_together_with_inputs_by_their_paths(gl):
    nodes = f"""<{EON} name="a" type="BSDF"/><{EON} name="b" type="BSDF"/>
      <add name="lobe" type="BSDF">
        <input name="in1" type="BSDF" nodename="a"/><input name="in2" type="BSDF" nodename="b"/>
      </add>"""
    wo, wi = np.array([[0.0, 0.6, 0.8]]), np.array([[0.0, -0.8, 0.6]])
    colors = {"a/color": (0.1, 0.2, 0.3), "b/color": (0.3, 0.2, 0.1)}
    both = gl.evaluate(shader(nodes), wo, wi, colors, "direct")
    one, other = (
        gl.evaluate(shader(LOBES["eon"]), wo, wi, {"color": color, "roughness": 0.0}, "direct")
        for color in colors.values()
    )
    assert np.allclose(both, one + other, rtol=1e-6)


SHADERS = ("standard_surface", "UsdPreviewSurface")


@pytest.mark.parametrize("category", SHADERS)
def test_it_evaluates_a_surface_shader_with_inputs_of_each_pair(gl, category):
    shader = gl.compile(document_text(f'<{category} name="shading" type="surfaceshader"/>'))[0]
    wo, wi = np.array([[0.6, 0.0, 0.8]] * 2), np.array([[0.0, -0.8, 0.6]] * 2)
    color = "diffuseColor" if category == "UsdPreviewSurface" else "base_color"
    inputs = {color: np.array([[0.8, 0.4, 0.1], [0.1, 0.2, 0.6]]), "metallic": 0.0}
    values = np.pi * gl.evaluate(shader, wo, wi, inputs, "direct")
    expected = np.pi * Reference().evaluate(shader, wo, wi, inputs, "direct")
    assert np.abs(values - expected).max() < MICROFACET_VALUE
    assert np.abs(values[0] - values[1]).max() > 0.05


@pytest.mark.parametrize("branch, words", [("direct", "BSDF"), ("graph", "uniform EDF")])
def test_a_material_without_the_closure_cannot_be_evaluated(gl, branch, words):
    text = document_text('<surface_unlit name="shading" type="surfaceshader"/>')
    wo = np.array([[0.0, 0.0, 1.0]])
    with pytest.raises(ValueError, match=f"element 'look' must call an? {words}"):
        gl.evaluate(gl.compile(text)[0], wo, wo, {}, branch)


def test_a_machine_without_egl_did_not_run(monkeypatch):
    def missing(**options):
        raise Exception("libEGL.so not loaded")

    monkeypatch.setattr(moderngl, "create_context", missing)
    with pytest.raises(NotRun, match="libEGL.so not loaded.*apt-get install libegl1"):
        open_host("gl")


def test_another_context_of_the_process_is_not_in_the_way(gl):
    before = gl.call("fon_a", np.array([0.5]))
    other = moderngl.create_standalone_context(require=430, backend="egl")
    other.release()
    np.testing.assert_array_equal(gl.call("fon_a", np.array([0.5])), before)


def test_a_picture_of_odd_size_is_the_models(gl, reference):
    odd = replace(SCENES[1], size=SIZE + 1)
    image, expected = (host.picture(shader(LOBES["eon"]), odd) for host in (gl, reference))
    error = np.abs(image - expected).max(axis=2) * sphere(odd.size).normal[..., 2]
    assert expected.any() and error.max() <= PICTURE


def test_a_long_evaluation_is_that_of_its_parts(gl):
    [shader] = generate(material_text("conductor_bsdf", {}), "glsl")
    count = fragment.PART + 7
    wo, wi = (np.tile(each, (count, 1)) for each in ([0.6, 0.0, 0.8], [-0.28, 0.0, 0.96]))
    rough = np.linspace(0.1, 0.9, 2 * count).reshape(count, 2)
    values = gl.evaluate(shader, wo, wi, {"roughness": rough}, "direct")
    last = gl.evaluate(shader, wo[-7:], wi[-7:], {"roughness": rough[-7:]}, "direct")
    assert len(values) == count
    np.testing.assert_array_equal(values[-7:], last)
