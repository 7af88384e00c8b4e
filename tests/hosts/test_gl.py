# SPDX-License-Identifier: Apache-2.0
"""OpenGL pictures have exact points, the correct orientation, and the requested light."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.hosts.points import visible
from mxeon.hosts.textures import irradiance, read_latlong
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import EON
from mxeon.shaders.scene import FRONT, SCENES, Scene, sphere
from tests.support.documents import connected, lobe, material
from tests.support.documents import image as image_node
from tests.support.tolerances import PICTURE

SIZE = 96
ROUGH = {"color": (0.8, 0.4, 0.1), "roughness": 0.9}
LOBES = lobe(**ROUGH, energy_compensation=True), lobe(**ROUGH), lobe(EON, **ROUGH)


def picture(host, nodes, scene):
    [shader] = generate(material(nodes), "glsl", lights=True, policy=Policy(outside=True))
    return host.picture(shader, replace(scene, size=SIZE))


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("nodes", LOBES, ids=["eon", "qon", "node"])
def test_every_pixel_is_the_models(gl, reference, nodes, scene):
    image, expected = (picture(host, nodes, scene) for host in (gl, reference))
    points = sphere(SIZE)
    mask = points.mask
    error = np.abs(image - expected)[mask].max(axis=1) * points.normal[mask][:, 2]
    assert error.max() <= PICTURE
    assert not image[~mask].any()


def test_the_shader_ball_is_drawn_at_its_points(gl):
    image = picture(gl, lobe(EON, color=ROUGH["color"]), replace(FRONT, shape="ball"))
    points = visible(SIZE, "ball")
    cosine = np.where(points.mask, points.normal[..., 2], 0.0)[..., None]
    assert np.abs(image - cosine * [0.8, 0.4, 0.1]).max() <= PICTURE


DEFAULT = '<input name="default" type="color3" value="0.8, 0.4, 0.1"/>'
PROPERTY = '<input name="geomprop" type="string" value="{}"/>'
SOURCES = {
    "image": f'<image name="s" type="color3">{DEFAULT}</image>',
    "property": f'<geompropvalue name="s" type="color3">{PROPERTY.format("Cd")}{DEFAULT}'
    "</geompropvalue>",
}


@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES)
def test_what_a_shape_or_an_image_lacks_is_the_default(gl, source):
    front = Scene("front", light=(0.0, 0.0, 1.0), environment=0.5)
    color = lobe(color=ROUGH["color"])
    image, expected = (
        picture(gl, nodes, front) for nodes in (source + connected(color='nodename="s"'), color)
    )
    assert np.abs(image - expected).max() <= PICTURE


def test_a_pair_of_numbers_on_the_shape_is_its_texture_coordinates(gl):
    swizzle = '<convert name="s" type="color3"><input name="in" type="vector2" nodename="st"/>'
    property_ = f'<geompropvalue name="st" type="vector2">{PROPERTY.format("st")}</geompropvalue>'
    image, expected = (
        picture(gl, f"{node}{swizzle}</convert>" + connected(color='nodename="s"'), FRONT)
        for node in (property_, '<texcoord name="st" type="vector2"/>')
    )
    assert image.max() > 0.1
    np.testing.assert_array_equal(image, expected)


def test_a_texture_stands_upright(gl, reference, tmp_path):
    texels = np.zeros((8, 16, 3), dtype=np.float32)
    texels[:4, :, 0], texels[4:, :, 2] = 0.9, 0.6  # red at the top, blue at the bottom
    oiio.ImageBuf(texels).write(str(tmp_path / "flag.exr"))
    nodes = image_node(tmp_path / "flag.exr", "flag") + connected(color='nodename="flag"')
    front = Scene("front", light=(0.0, 0.0, 1.0))
    image, expected = (picture(host, nodes, front) for host in (gl, reference))
    top, bottom = image[SIZE // 4, SIZE // 2], image[3 * SIZE // 4, SIZE // 2]
    assert top[0] > 0.5 > top[2] and bottom[2] > 0.4 > bottom[0]
    # OpenGL guarantees a precision of 2^-8 for filter weights.
    assert np.abs(image - expected)[sphere(SIZE).mask].max() <= 2.0**-8


def test_an_environment_image_lights_by_its_irradiance(gl, tmp_path):
    sky = np.zeros((32, 64, 3), dtype=np.float32)
    sky[:16] = [0.2, 0.4, 1.0]  # bluish light from above
    oiio.ImageBuf(sky).write(str(tmp_path / "sky.exr"))
    white = lobe(EON, color=(1.0, 1.0, 1.0))
    image = picture(gl, white, Scene("sky", environment=tmp_path / "sky.exr"))
    top, bottom = image[1, SIZE // 2], image[-2, SIZE // 2]
    assert np.allclose(top, [0.2, 0.4, 1.0], atol=0.02) and bottom.max() < 0.02
    assert irradiance(read_latlong(0.5)).max() == 0.5


FORKED = """import os
from mxeon import check
from mxeon.hosts import open_engine
engine = open_engine("gl")
if os.fork() == 0:
    run = check(nodes=["sheen_bsdf"])
    print({each.reason for each in run.results if each.host == "gl"}, flush=True)
    os._exit(0)
os.wait()
"""


def test_a_forked_process_says_that_an_engine_of_its_parent_hangs(gl):
    done = subprocess.run([sys.executable, "-c", FORKED], capture_output=True, text=True)
    assert "gl: this process was forked from one that had opened an engine" in done.stdout
    assert len(done.stdout.splitlines()) == 1 and "pass workers=1" in done.stdout
