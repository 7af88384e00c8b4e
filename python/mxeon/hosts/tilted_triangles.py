# SPDX-License-Identifier: Apache-2.0
"""A scene of Blender's in which each pixel shows a pair of directions of its own.

The camera looks down from far away with parallel rays, and a light of one point lies beside the picture. At
which depth a triangle lies on the ray of its pixel decides about the angle between view and light. It is
turned so that its own normal and the shaded one are the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.base import Array
from mxeon.hosts.pair_frames import CORNERS, frames, unit

Vectors = NDArray[np.float64]
PIXEL = 2.0**-5  # width
JITTER = (
    0.5 * 0.01 * 2.0**0.5
)  # of a sample beside the middle of its pixel, in pixels, by its filter
DISTANCE = 256.0  # of the light from the middle of the picture, at its height
TRIANGLE = 0.4 * PIXEL  # of its corners from the middle of the pixel
HEIGHT = 16.0 * DISTANCE  # of the camera: the nearest point is 12.5 times the distance high
VIEW = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class TiltedTriangles:
    """Triangles that show pairs of directions to a camera."""

    width: float  # of the picture
    corners: Vectors  # (N, 3, 3)
    turn: Vectors  # (N, 3, 3), from the frame of the pairs to that of the scene
    irradiance: Vectors  # (N, 1), of a surface that faces the light, of radiant intensity 1

    def turned(self, vectors: Array) -> Vectors:
        """Vectors of the frame of the pairs, (N or 1, 3), in that of the scene."""
        each = np.broadcast_to(np.asarray(vectors, np.float64), (len(self.turn), 3))
        return np.asarray((self.turn @ each[:, :, np.newaxis])[:, :, 0])

    @property
    def place(self) -> str:
        """OSL expressions of the coordinates at which a point reads its pixel of an image."""
        return f"0.5 + P[0] / {self.width:.9g}, 0.5 - P[1] / {self.width:.9g}"


def tilted_triangles(wo: Array, wi: Array, size: int) -> TiltedTriangles:
    """Triangles that show pairs (N, 3), N <= size^2, with a sine of at least LEAST_SINE."""
    # Points at which the light appears at the angle.
    wo, wi = (np.asarray(each, np.float64) for each in (wo, wi))
    axis = PIXEL * (np.arange(size) + 0.5 - size / 2.0)
    x, y = (each.ravel()[: len(wo)] for each in np.meshgrid(axis, -axis))
    cotangent = (wo * wi).sum(axis=1) / np.linalg.norm(np.cross(wo, wi), axis=1)
    z = -np.hypot(DISTANCE + x, y) * cotangent
    points = np.stack([x, y, z], axis=1).astype(np.float32).astype(np.float64)
    # The frames of both pairs, which have the view as their first axis.
    light = np.array([-DISTANCE, 0.0, 0.0]) - points
    world = frames(np.broadcast_to(VIEW, points.shape), unit(light))
    turn = world @ np.swapaxes(frames(wo, wi), 1, 2)
    # Corners in the plane across the shaded normal.
    normal = turn[:, :, 2]
    offsets = TRIANGLE * np.array(CORNERS)
    depth = -(normal[:, :2] @ offsets.T) / normal[:, 2:]
    flat = np.broadcast_to(offsets, (len(points), 3, 2))
    corners = points[:, np.newaxis] + np.concatenate([flat, depth[:, :, np.newaxis]], axis=2)
    squared = (light * light).sum(axis=1, keepdims=True)
    return TiltedTriangles(PIXEL * size, corners, turn, 1.0 / squared)
