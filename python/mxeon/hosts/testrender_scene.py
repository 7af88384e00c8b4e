# SPDX-License-Identifier: Apache-2.0
"""A scene in testrender's format in which each pixel shows its own pair of directions.

The camera sees a small triangle in each pixel, and a small light lies outside the picture. The
position of a triangle on the ray of a pixel sets the angle between view and light. The shading
frame is rotated accordingly, because the normal and tangent of a shader are independent inputs.

    camera ------- d ------> P        wo = -d
                            /         P = F + |F| cot(angle of wo and wi) d, where F is the point of
                           /          the ray nearest to the light
                       light
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.base import Array
from mxeon.hosts.pairs import CORNERS, TurnedPairs, Vectors, frames, unit

SCENE, POINTS, LIGHT = "scene.xml", "points.obj", "light.obj"
EYE = 40.0  # height of the camera above the light, which lies at the origin
NEAREST = 0.5  # least distance from the light to a ray
CENTER = 1.5  # x of the picture's center, at the height of the light
FOV = 5.725  # field of view in degrees; the frame is tan(FOV / 2) wide at distance 1
LIGHT_RADIUS = 2.0**-18
# Size of a triangle divided by the distance from the camera. The size exceeds the camera's error,
# 2^-24, and is too small for the triangle to hide the light.
TRIANGLE = 2e-5
PLACE = "u, v"  # coordinates at which a point reads an image
# A pixel has LIGHT_SAMPLES^2 paths with a light, or SKY_SAMPLES^2 paths with a sky. One path is
# enough for the light, because the light is almost a point.
LIGHT_SAMPLES, SKY_SAMPLES = 1, 8

WORLD = """<World>
  <Option no_jitter="int 1" />
  <Option max_bounces="int 1" />
  <Camera eye="0,0,{eye:.9g}" dir="{center:.9g},0,-{eye:.9g}" up="0,1,0" fov="{fov:.9g}" />
  <ShaderGroup name="points">
    shader {shader} material ;
    shader mxeon_root root ;
    connect material.out root.material ;
  </ShaderGroup>
  <Model filename="{points}" />
{light}
</World>
"""
LIGHT_GROUP = f"""  <ShaderGroup name="light" is_light="yes">
    shader mxeon_light light ;
  </ShaderGroup>
  <Model filename="{LIGHT}" />"""
# Resolution 0 means that testrender computes no table for sampling the sky, which is uniform.
SKY_GROUP = """  <ShaderGroup name="sky">
    shader mxeon_sky sky ;
  </ShaderGroup>
  <Background resolution="0" />"""


@dataclass(frozen=True)
class PairScene(TurnedPairs):
    size: int  # pixels on a side of the picture
    rays: Vectors  # unit vectors (N, 3) from the camera through the pixels' centers, row 0 first
    points: Vectors  # centers of the triangles, (N, 3), rounded to float32

    @property
    def irradiance(self) -> NDArray[np.float64]:
        """Irradiance on surfaces that face the light, whose radiance is 1, (N,)."""
        area = 0.5 * np.cross(*np.diff(_light_corners(), axis=0))
        squared = (self.points**2).sum(axis=1)
        return np.asarray(np.abs(self.points @ area) / squared**1.5)

    def files(self, shader: str, lit: bool) -> dict[str, str]:
        """Names and texts of the files that describe a scene with the light or a white sky."""
        light = LIGHT_GROUP if lit else SKY_GROUP
        world = WORLD.format(
            eye=EYE, center=CENTER, fov=FOV, shader=shader, points=POINTS, light=light
        )
        texts = {SCENE: world, POINTS: self._model()}
        return texts | ({LIGHT: _model(_light_corners()[np.newaxis])} if lit else {})

    def _model(self) -> str:
        """A triangle around each point, edge-on to the light and with the front to the camera."""
        # The first axis in the plane of a triangle points to the light.
        toward = -unit(self.points)
        across = unit(np.cross(toward, self.rays))  # the normal faces the camera
        reach = TRIANGLE * np.linalg.norm(self.points - [0.0, 0.0, EYE], axis=1)
        axes = np.stack([toward, across], axis=1) * reach[:, np.newaxis, np.newaxis]
        # Corners share texture coordinates, so the whole triangle reads one pixel of an image.
        column, row = np.arange(len(self.rays)) % self.size, np.arange(len(self.rays)) // self.size
        places = (np.stack([column, row], axis=1) + 0.5) / self.size
        corners = self.points[:, np.newaxis] + np.array(CORNERS) @ axes
        return _model(corners, places)


def pair_scene(wo: Array, wi: Array, size: int) -> PairScene:
    """Scene that shows N <= size^2 pairs of directions, with sines of at least LEAST_SINE."""
    # Directions of the camera's rays.
    axis = (np.arange(size) + 0.5) / size - 0.5
    x, y = (each.ravel()[: len(wo), np.newaxis] for each in np.meshgrid(axis, -axis))
    ahead = unit(np.array([[CENTER, 0.0, -EYE]]))
    right = unit(np.cross(ahead, [[0.0, 1.0, 0.0]]))
    width = np.tan(np.radians(FOV) / 2.0)  # testrender's frame is half as wide as usual
    rays = unit(ahead + width * (x * right + y * np.cross(right, ahead)))
    # Points at which the angle between view and light is as required.
    eye = np.array([0.0, 0.0, EYE])
    foot = eye - (rays @ eye)[:, np.newaxis] * rays
    across = np.cross(wo, wi)
    cotangent = (wo * wi).sum(axis=1) / np.linalg.norm(across, axis=1)
    points = foot + (np.linalg.norm(foot, axis=1) * cotangent)[:, np.newaxis] * rays
    points = points.astype(np.float32).astype(np.float64)
    # Rotate each pair so that wo points to the camera and wi points to the light.
    local = frames(wo, wi)
    world = frames(-rays, -unit(points))
    return PairScene(world @ np.swapaxes(local, 1, 2), size, rays, points)


def _light_corners() -> Vectors:
    """Corners of the light, which is a triangle that faces the center of the picture."""
    return LIGHT_RADIUS * np.array([(0.0, x, y) for x, y in CORNERS])


def _model(corners: NDArray[np.float64], places: Vectors | None = None) -> str:
    """Text of an OBJ file with triangles (N, 3, 3) and one texture coordinate per triangle."""
    count = len(corners)
    rows = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners.reshape(-1, 3)]
    first = 3 * np.arange(count) + 1
    if places is None:
        faces = [f"f {n} {n + 1} {n + 2}" for n in first]
    else:
        rows += [f"vt {u:.9g} {v:.9g}" for u, v in places]
        faces = [
            f"f {n}/{each} {n + 1}/{each} {n + 2}/{each}" for each, n in enumerate(first, start=1)
        ]
    return "\n".join([*rows, *faces, ""])
