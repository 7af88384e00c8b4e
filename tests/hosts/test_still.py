# SPDX-License-Identifier: Apache-2.0
"""Stills: antialiased, on a floor that the shader ball shades, by a tone curve."""

from dataclasses import replace

import numpy as np

from mxeon.hosts.still import PAPER, floor, still
from mxeon.io.tone import pbr_neutral
from mxeon.shaders.nodes import material_text
from mxeon.shaders.scene import FURNACE, STUDIO, Scene

WHITE = material_text("eon_diffuse_bsdf", {"color": (1.0, 1.0, 1.0), "roughness": 1.0})
SIZE = 64


def test_a_pixel_at_the_edge_has_the_share_of_the_sphere_in_it(hosts):
    host = hosts("gl")
    [shader] = host.compile(WHITE)
    image = still(host, shader, replace(FURNACE, size=SIZE))
    # 16 samples in each of about 4 SIZE pixels at the edge: the area of a disk, to a tenth of a percent.
    np.testing.assert_allclose(image.mean(), np.pi / 4.0, rtol=1e-3)
    assert len(np.unique(image.round(4))) > 8


def test_the_floor_far_away_has_the_light_of_the_open_sky_and_less_beside_the_foot():
    size = 128
    image = floor(Scene("even", environment=1.0, size=size, shape="ball"))
    np.testing.assert_allclose(image[0, [0, -1]], PAPER, rtol=0.05)  # 512 directions
    assert (image <= PAPER * 1.01).all()
    below = image[int(0.93 * size), size // 2]
    assert (below < 0.7 * PAPER).all()


def test_the_ball_stands_on_the_floor(hosts):
    host = hosts("gl")
    [shader] = host.compile(WHITE)
    image, paper = (
        still(host, shader, replace(STUDIO, size=SIZE)),
        floor(replace(STUDIO, size=SIZE)),
    )
    np.testing.assert_array_equal(image[0, [0, -1]], paper[0, [0, -1]])
    assert (image[SIZE // 4, SIZE // 2] > 1.5 * paper[SIZE // 4, SIZE // 2]).all()


def test_the_tone_curve_keeps_dark_colors_but_for_the_reflectance_of_a_dielectric():
    colors = np.array([[0.5, 0.3, 0.2], [0.7, 0.1, 0.3]])
    np.testing.assert_allclose(pbr_neutral(colors), colors - 0.04)
    bright = pbr_neutral(np.array([[4.0, 2.0, 1.0], [100.0, 50.0, 25.0]]))
    assert (bright <= 1.0).all() and (np.diff(bright, axis=-1) < 0.0).all()
