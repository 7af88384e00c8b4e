# SPDX-License-Identifier: Apache-2.0
"""A lit plane seen by a perspective camera: every pixel is another pair of directions.

The camera stands 1 above the origin and looks along y, down by 90 degrees less TILT.
"""

import numpy as np
from numpy.typing import NDArray

from mxeon.shaders.scene import Scene

FOV = 90.0  # degrees, of the whole frame, which is 2 tan(FOV / 2) wide at distance 1
TILT = np.radians(60.0)  # of the camera's axis, from straight down
DISTANCE = 1000.0  # of the light
LIGHT_RADIUS = 1.0 / 64.0
LIGHTS = (20.0, 75.0)  # degrees from the normal towards x


def plane_pairs(scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions at the points of the plane under the pixel centers.

    Returns
    -------
    wo, wi : ndarray, shape (size * size, 3)
        Row 0 of the picture first; wi is wo where there is no distant light.
    """
    points = plane_points(scene.size)
    wo = _unit([0.0, 0.0, 1.0] - points)
    return wo, wo if scene.light is None else _unit(DISTANCE * np.array(scene.light) - points)


def plane_points(size: int) -> NDArray[np.float64]:
    """Points of the plane under the pixel centers, (size * size, 3)."""
    axis = (np.arange(size) + 0.5) / size - 0.5
    x, y = (values.ravel() for values in np.meshgrid(axis, -axis))
    width = np.tan(np.radians(FOV) / 2.0)
    ahead, up = np.array([0.0, np.sin(TILT), -np.cos(TILT)]), [0.0, np.cos(TILT), np.sin(TILT)]
    ray = ahead + width * (x[:, np.newaxis] * [1.0, 0.0, 0.0] + y[:, np.newaxis] * np.array(up))
    points: NDArray[np.float64] = [0.0, 0.0, 1.0] - ray / ray[:, 2:]
    return points


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    unit: NDArray[np.float64] = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return unit
