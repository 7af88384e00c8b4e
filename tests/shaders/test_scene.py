# SPDX-License-Identifier: Apache-2.0
"""Points of the sphere and the shader ball lie under the pixel centers, with correct normals."""

import numpy as np
import pytest

from mxeon.shaders.scene import pixel_centers, sphere
from mxeon.shaders.shader_ball import CENTER, CLOSE, OBJECT, RADIUS, STEP, distance, shader_ball_at


def test_points_of_the_shader_ball_lie_on_it_with_their_normals():
    points = shader_ball_at(*pixel_centers(64))
    seen = points.position[points.mask]
    assert np.abs(distance(seen)).max() <= CLOSE
    # No part of the ball lies in front of a visible point.
    assert (distance(seen + [0.0, 0.0, 0.01]) > 0.0).all()
    outward = seen - CENTER @ OBJECT
    ball = np.abs(np.linalg.norm(outward, axis=-1) - RADIUS) <= CLOSE
    assert 0.7 < ball.mean() < 0.9
    # The tolerance is the step of central differences, plus twice the tolerance of a point.
    away = np.abs(points.normal[points.mask][ball] * RADIUS - outward[ball]).max(axis=-1)
    # At least 98 % of the points agree. All other points lie at edges of grooves.
    assert np.percentile(away, 98) <= STEP + 2.0 * CLOSE


def test_nothing_shows_between_the_ball_and_the_foot_behind_its_edge():
    down = np.linspace(-0.52, -0.54, 500)[:, None]
    assert shader_ball_at(np.zeros_like(down), down).mask.all()


@pytest.mark.parametrize("size", [1, 2, 7, 64])
def test_points_lie_on_the_sphere_under_the_pixel_centres(size):
    points = sphere(size)
    x, y, z = np.moveaxis(points.position, -1, 0)
    np.testing.assert_allclose(x[0], (2.0 * np.arange(size) + 1.0) / size - 1.0, atol=1e-15)
    np.testing.assert_array_equal(y, -x.T)  # row 0 is at the top
    np.testing.assert_array_equal(points.mask, np.hypot(x, y) < 1.0)
    np.testing.assert_allclose((points.position**2).sum(axis=-1)[points.mask], 1.0, atol=1e-15)
    np.testing.assert_array_equal(points.normal[points.mask], points.position[points.mask])
    assert (z[~points.mask] == 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(points.normal, axis=-1), 1.0, atol=1e-15)
