# SPDX-License-Identifier: Apache-2.0
"""Points of a shader ball, which is a ball with a grooved belt on a foot, seen from slightly above.

The shape is a signed distance field. Each ray of the picture finds the surface by sphere tracing,
and the gradient of the field is the normal. There are no shadows, because shaders are evaluated at
one point at a time.
"""

import numpy as np
from numpy.typing import NDArray

from mxeon.io.images import Floats
from mxeon.shaders.scene import VisiblePoints

CENTER, RADIUS = np.array([0.0, 0.2, 0.0]), 0.72
BELT_HEIGHT = 0.13  # half of the height of the belt
GROOVE, FILLET = 0.035, 0.02  # radius of the grooves next to the belt, radius of rounded edges
FOOT_HEIGHT, FOOT_RADIUS = 0.1, 0.5
GROUND = -0.6 - FOOT_HEIGHT  # height of the floor, under the foot
TILT, ROLL = np.radians(20.0), np.radians(-24.0)  # radians: tilt of the view, roll of the belt

NEAR, FAR = 2.0, -2.0  # z at both ends of a ray
# Maximum number of steps of sphere tracing, and the distance at which a ray hits the surface. Rays
# along an edge take hundreds of steps.
STEPS, CLOSE = 2000, 1e-5
STEP = 1e-4  # step of the central differences that yield normals


def _rotation(angle: float, axis: int) -> NDArray[np.float64]:
    """Rotation matrix about the x axis (`axis` is 0) or the z axis (2)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    matrix = np.eye(3)
    matrix[[i, i, j, j], [i, j, i, j]] = cosine, -sine, sine, cosine
    return matrix


OBJECT = _rotation(-TILT, 0)  # rotates from the picture's frame to the foot's frame
BELT = _rotation(ROLL, 2) @ _rotation(0.35, 0)  # rotates from the foot's frame to the belt's frame


def _cylinder(points: Floats, radius: float, height: float) -> Floats:
    """Signed distance from a cylinder with rounded edges; the y axis is the cylinder's axis."""
    across = np.hypot(points[..., 0], points[..., 2]) - radius + FILLET
    along = np.abs(points[..., 1]) - height + FILLET
    outside = np.hypot(np.maximum(across, 0.0), np.maximum(along, 0.0))
    distance: Floats = np.minimum(np.maximum(across, along), 0.0) + outside - FILLET
    return distance


def distance(points: Floats) -> Floats:
    """Lower bound of the signed distance from the shape to points (..., 3) in picture space."""
    upright = points @ OBJECT.T
    inside = (upright - CENTER) @ BELT.T
    radius = np.linalg.norm(inside, axis=-1)
    across = np.hypot(inside[..., 0], inside[..., 2])
    ring = np.sqrt(RADIUS**2 - BELT_HEIGHT**2)
    groove = np.hypot(across - ring, np.abs(inside[..., 1]) - BELT_HEIGHT) - GROOVE
    ball = np.maximum(radius - RADIUS, -groove)
    foot = _cylinder(upright - [0.0, -0.6, 0.0], FOOT_RADIUS, FOOT_HEIGHT)
    nearest: Floats = np.minimum(ball, foot)
    return nearest


def shader_ball_at(x: Floats, y: Floats) -> VisiblePoints:
    """The visible points of the shader ball at positions in the picture."""
    points = np.stack([x, y, np.full_like(x, NEAR)], axis=-1)
    rays, mask = points.reshape(-1, 3), np.zeros(x.size, dtype=bool)
    running = np.arange(x.size)
    for _ in range(STEPS):
        if not running.size:
            break
        step = distance(rays[running])
        rays[running, 2] -= step
        mask[running] = step < CLOSE
        running = running[(step >= CLOSE) & (rays[running, 2] > FAR)]
    found = mask.reshape(x.shape)
    gradient = [distance(points + each) - distance(points - each) for each in STEP * np.eye(3)]
    normal = np.stack(gradient, axis=-1)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), STEP**2)
    normal[~found] = 0.0, 0.0, 1.0
    outward = points @ OBJECT.T - CENTER
    u = 0.5 + np.arctan2(outward[..., 0], outward[..., 2]) / (2.0 * np.pi)
    v = 0.5 + np.arctan2(outward[..., 1], np.hypot(outward[..., 0], outward[..., 2])) / np.pi
    return VisiblePoints(found, points, normal, np.stack([u, v], axis=-1))
