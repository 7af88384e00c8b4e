# SPDX-License-Identifier: Apache-2.0
"""Environments are read, and converted to irradiance."""

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.hosts.textures import irradiance, read_latlong

# Ten times the error of the midpoint rule for a cosine on 64 x 128 pixels, which is the squared
# angle of a pixel, (pi / 64)^2, over 12.
SUM = 10.0 * (np.pi / 64.0) ** 2 / 12.0


def test_an_environment_without_colors_is_refused(tmp_path):
    path = tmp_path / "gray.exr"
    oiio.ImageBuf(np.ones((4, 8, 1), np.float32)).write(str(path))
    with pytest.raises(ValueError, match="gray.exr: must have red, green and blue; got 1 channels"):
        read_latlong(path)


@pytest.mark.parametrize("shape", [(64, 128), (128, 256), (640, 5), (3, 700)])
def test_a_sky_over_a_black_ground_lights_what_faces_it(shape):
    rows, columns = shape
    radiance = np.zeros((rows, columns, 3), dtype=np.float32)
    radiance[: rows // 2] = 1.0
    found = irradiance(radiance)
    assert found.shape == (32, 64, 3) and np.isfinite(found).all()
    assert found[0].min() > found[-1].max()
    if rows % 2 == 0 and rows < 640:  # exact: (1 + cos(theta)) / 2
        polar = np.pi * (np.arange(32) + 0.5) / 32
        expected = 0.5 * (1.0 + np.cos(polar))
        np.testing.assert_allclose(found[:, 0, 0], expected, rtol=0.0, atol=SUM)
