# SPDX-License-Identifier: Apache-2.0
"""The blur of subsurface scattering in GLSL: its error, its energy, and its inputs on a sphere."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.hosts import open_host
from mxeon.models.media.subsurface import diffusion_blur
from mxeon.models.nodes.subsurface import circle_blur
from mxeon.shaders.functions import source_file
from mxeon.shaders.nodes import material_text
from mxeon.shaders.scene import SIDE, sphere
from tests.support.availability import available
from tests.support.tolerances import SUBSURFACE_RINGS, SUBSURFACE_SPHERE, TWIN_VALUE

COSINES = np.linspace(-1.0, 1.0, 401).astype(np.float32).astype(np.float64)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)
REACHES = (0.001, 0.03, 0.1, 0.153, 0.2, 0.3, 1.0, 10.0, 1000.0)
SCENE = replace(SIDE, size=32)
COLOR, RADIUS = (0.9, 0.6, 0.3), (0.5, 0.2, 0.05)


@pytest.fixture(scope="module")
def plain(gl):
    """The picture of a sphere."""
    return picture(gl)


@pytest.fixture(scope="module")
def gl():
    with available("gl"):
        host = open_host("gl")
    yield host
    host.close()


def blurred(host, mu, reach):
    source = source_file("glsl", "subsurface_blur").read_text()
    return host.execute(source, "subsurface_blur", mu, np.full((len(mu), 3), reach))[:, 0]


def picture(host, **inputs):
    text = material_text("subsurface_bsdf", {"color": COLOR, "radius": RADIUS, **inputs})
    return host.picture(host.compile(text)[0], SCENE)


@pytest.mark.parametrize("reach", REACHES)
def test_the_blur_is_that_of_the_profile(gl, reach):
    error = np.abs(blurred(gl, COSINES, reach) - diffusion_blur(COSINES, reach))
    assert error.max() < SUBSURFACE_RINGS


@pytest.mark.parametrize("reach", REACHES)
def test_a_sphere_returns_all_light(gl, reach):
    for values in (blurred(gl, NODES, reach), diffusion_blur(NODES, reach)):
        assert abs(2.0 * (WEIGHTS * values).sum() - 1.0) < SUBSURFACE_SPHERE


def test_a_plane_is_lambert(gl):
    error = np.abs(blurred(gl, COSINES, 0.0) - np.maximum(COSINES, 0.0))
    assert error.max() <= TWIN_VALUE


def test_the_circle_of_materialx_returns_more():
    returned = 2.0 * (WEIGHTS * circle_blur(NODES, np.full((200, 1), 10.0), body=1.0)[:, 0]).sum()
    assert returned > 1.1


def test_a_picture_of_a_sphere_is_the_blur(plain):
    points = sphere(SCENE.size)
    inner = points.mask & (points.normal[..., 2] > 0.3)  # where a pixel's point changes slowly
    mu = np.clip(points.normal[inner] @ SCENE.light, -1.0, 1.0)
    expected = np.stack([diffusion_blur(mu, each) for each in RADIUS], axis=-1) * COLOR
    assert np.abs(plain[inner] - expected).max() < SUBSURFACE_RINGS


@pytest.mark.parametrize("inputs", [{"radius": (0.2, 0.2, 0.2)}, {"anisotropy": 0.5}])
def test_a_sphere_shows_every_input(gl, plain, inputs):
    assert np.abs(picture(gl, **inputs) - plain).max() > 0.01
