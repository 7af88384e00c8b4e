# SPDX-License-Identifier: Apache-2.0
"""The path tracer's pictures of the sphere and of the shader ball have known values."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.errors import MISUSE, PASSED
from mxeon.hosts.path_tracer import NoiseNote, PathTracerHost
from mxeon.shaders.nodes import material_text
from mxeon.shaders.scene import FURNACE, SIDE, STUDIO, Paths, sphere
from tests.support.availability import package
from tests.support.command import PLASTER, run
from tests.support.documents import connected, material

CLAY = material_text("eon_diffuse_bsdf", {"color": (0.8, 0.4, 0.2), "roughness": 1.0})
WHITE = material_text("eon_diffuse_bsdf", {"color": (1.0, 1.0, 1.0), "roughness": 1.0})
GLASS = material_text("dielectric_bsdf", {"roughness": (0.0, 0.0), "scatter_mode": "RT"})
# A property with a default, times the texture coordinates in the property of USD, times the color of
# the vertices.
PROPERTIES = material(
    """
    <geompropvalue name="st" type="vector2"><input name="geomprop" type="string" value="st"/>
    </geompropvalue>
    <convert name="placed" type="color3"><input name="in" type="vector2" nodename="st"/></convert>
    <geompropvalue name="cd" type="color3"><input name="geomprop" type="string" value="Cd"/>
    <input name="default" type="color3" value="0.8, 0.4, 0.2"/></geompropvalue>
    <multiply name="colored" type="color3"><input name="in1" type="color3" nodename="placed"/>
    <input name="in2" type="color3" nodename="cd"/></multiply>
    <geomcolor name="vertices" type="color3"/>
    <multiply name="product" type="color3"><input name="in1" type="color3" nodename="colored"/>
    <input name="in2" type="color3" nodename="vertices"/></multiply>
    """
    + connected(color='nodename="product"')
)
SIZE = 32


@pytest.fixture(scope="module")
def tracer(hosts):
    hosts("gl")  # skips the test if `gl` cannot run
    host = PathTracerHost()
    yield host
    host.close()


def traced(tracer, document, scene, paths, shape="sphere"):
    [shader] = tracer.compile(document)
    with pytest.warns(NoiseNote, match="nois"):
        return tracer.picture(shader, replace(scene, size=SIZE, paths=paths, shape=shape))


@pytest.mark.parametrize("document", [CLAY, PROPERTIES], ids=["clay", "properties"])
def test_direct_light_is_the_rasterizers(hosts, tracer, document):
    gl = hosts("gl")
    [shader] = gl.compile(document)
    expected = gl.picture(shader, replace(SIDE, size=SIZE))
    assert expected.max() > 0.1
    np.testing.assert_allclose(traced(tracer, document, SIDE, Paths(1, 1)), expected, atol=1e-4)


@pytest.mark.parametrize("shape", ["sphere", "ball"])
def test_a_white_shape_vanishes_in_a_furnace(tracer, shape):
    image = traced(tracer, WHITE, FURNACE, Paths(1, 64), shape)
    seen = image[image.sum(axis=-1) > 0.0]
    assert len(seen) > 300
    np.testing.assert_allclose(np.median(seen), 1.0, atol=1e-4)


def test_glass_loses_little_in_a_furnace(tracer):
    image = traced(tracer, GLASS, FURNACE, Paths(16, 64))
    mask = sphere(SIZE).mask
    assert abs(image[mask].mean() - 1.0) < 0.02


def test_a_picture_with_the_default_samples_has_no_noise(tracer):
    package("pyoidn")
    scene = replace(STUDIO, light=None)
    smooth, raw = (traced(tracer, CLAY, scene, Paths(n), "ball") for n in (None, 64))

    def contrast(image):
        """Mean |a - b - c + d| of 2 x 2 pixels in the ball's upper half, 0 for linear shading."""
        part = image[6:14, 10:22].mean(axis=-1)
        blocks = part[:-1, :-1] - part[1:, :-1] - part[:-1, 1:] + part[1:, 1:]
        return np.abs(blocks).mean()

    assert contrast(smooth) < 0.5 * contrast(raw)
    assert abs(smooth.mean() / raw.mean() - 1.0) < 0.05


def test_the_command_prints_the_noise(hosts, tmp_path):
    hosts("gl")
    options = ["--output", str(tmp_path / "clay.png"), "--size", "16", "--integrator", "path"]
    done = run("render", PLASTER, *options, "--samples", "2")
    assert done.returncode == PASSED
    assert "still noisy (" in done.stderr
    assert run("render", PLASTER, *options, "--host", "cycles").returncode == MISUSE
