# SPDX-License-Identifier: Apache-2.0
"""Stills are antialiased and tone mapped, and show a floor with the shadow of the ball."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.errors import InputError
from mxeon.hosts.path_tracer import PathTracerHost
from mxeon.hosts.points import visible
from mxeon.hosts.still import PAPER, floor, still
from mxeon.io.srgb import pbr_neutral
from mxeon.shaders.nodes import material_text
from mxeon.shaders.scene import FURNACE, STUDIO, Scene
from mxeon.shaders.shader_ball import OBJECT
from tests.support.availability import package

WHITE = material_text("eon_diffuse_bsdf", {"color": (1.0, 1.0, 1.0), "roughness": 1.0})
SIZE = 64


def test_a_pixel_at_the_edge_has_the_share_of_the_sphere_in_it(hosts):
    host = hosts("gl")
    [shader] = host.compile(WHITE)
    image = still(host, shader, replace(FURNACE, size=SIZE))
    # The disk's edge crosses about 4 * SIZE pixels, and each pixel has 16 samples. The disk's area
    # is therefore exact to 0.1 percent.
    np.testing.assert_allclose(image.mean(), np.pi / 4.0, rtol=1e-3)
    assert len(np.unique(image.round(4))) > 8


def test_the_floor_far_away_has_the_light_of_the_open_sky_and_less_beside_the_foot():
    size = 128
    image = floor(Scene("even", environment=1.0, size=size, shape="ball"))
    # Error of an average over 512 directions.
    np.testing.assert_allclose(image[0, [0, -1]], PAPER, rtol=0.05)
    assert (image <= PAPER * 1.01).all()
    below = image[int(0.93 * size), size // 2]
    assert (below < 0.7 * PAPER).all()


def test_the_ball_stands_on_the_floor(hosts):
    host = hosts("gl")
    [shader] = host.compile(WHITE)
    scene = replace(STUDIO, size=SIZE)
    image, paper = still(host, shader, scene), floor(scene)
    np.testing.assert_array_equal(image[0, [0, -1]], paper[0, [0, -1]])
    assert (image[SIZE // 4, SIZE // 2] > 1.5 * paper[SIZE // 4, SIZE // 2]).all()


def test_the_tone_curve_keeps_dark_colors_but_for_the_reflectance_of_a_dielectric():
    colors = np.array([[0.5, 0.3, 0.2], [0.7, 0.1, 0.3]])
    np.testing.assert_allclose(pbr_neutral(colors), colors - 0.04)
    bright = pbr_neutral(np.array([[4.0, 2.0, 1.0], [100.0, 50.0, 25.0]]))
    assert (bright <= 1.0).all() and (np.diff(bright, axis=-1) < 0.0).all()


@pytest.fixture(params=[".obj", ".glb"])
def wall(request, tmp_path):
    """Mesh file with a square that faces the viewer; u increases to the right, v upward."""
    trimesh, _ = package("trimesh"), package("embreex")
    corners = np.array([[0, 0], [3, 0], [3, 3], [0, 3]])
    square = trimesh.Trimesh(
        np.column_stack([corners, np.zeros(4)]),
        [[0, 1, 2], [0, 2, 3]],
        visual=trimesh.visual.TextureVisuals(uv=corners / 3.0),
        process=False,
    )
    square.export(tmp_path / f"wall{request.param}")
    return str(tmp_path / f"wall{request.param}")


def test_a_mesh_has_its_normals_texture_coordinates_and_tangents(wall):
    seen = visible(SIZE, wall)
    assert 0.2 < seen.mask.mean() < 0.6
    rows, columns = np.nonzero(seen.mask)
    for normal in seen.normal[seen.mask]:
        np.testing.assert_allclose(OBJECT @ normal, [0, 0, 1], atol=1e-6)
    for tangent in seen.tangent[seen.mask]:
        np.testing.assert_allclose(OBJECT @ tangent, [1, 0, 0], atol=1e-6)
    u, v = seen.texcoord[seen.mask].T
    # The pixel size limits the accuracy of the texture coordinates.
    np.testing.assert_allclose([u.min(), u.max()], [0, 1], atol=1.0 / np.ptp(columns))
    assert u[columns.argmin()] < u[columns.argmax()] and v[rows.argmin()] > v[rows.argmax()]


def test_a_mesh_shades_the_floor_and_is_drawn_on_it(hosts, wall):
    host, scene = hosts("gl"), replace(STUDIO, size=SIZE, shape=wall)
    [shader] = host.compile(WHITE)
    image, paper = still(host, shader, scene), floor(scene)
    outside = ~visible(SIZE, wall, 0).mask
    np.testing.assert_array_equal(image[0, [0, -1]], paper[0, [0, -1]])
    assert (image[~outside] > 0.0).all()
    rows, columns = np.nonzero(~outside)
    below = paper[rows.max() + 1, columns[rows == rows.max()]]
    assert below.mean() < 0.9 * paper[-1, 0].mean()


def test_the_path_tracer_refuses_a_mesh(wall):
    host = PathTracerHost()
    [shader] = host.compile(WHITE)
    words = "--integrator path: shape must be sphere or ball; got .*wall"
    with pytest.raises(InputError, match=words):
        host.picture(shader, replace(STUDIO, size=SIZE, shape=wall))
    host.close()


def test_a_mesh_without_triangles_is_refused_in_one_line(tmp_path):
    package("trimesh"), package("embreex")
    for name, text in (("empty.obj", ""), ("point.obj", "v 0 0 0\n"), ("bad.glb", "no glb")):
        (tmp_path / name).write_text(text)
        with pytest.raises(InputError, match=rf"{name}: must"):
            visible(SIZE, str(tmp_path / name))
