# SPDX-License-Identifier: Apache-2.0
"""The scene of a lit plane in testrender's files, and its light.

Plane and light are one triangle each: a shadow ray that ends on the common edge of two triangles
may hit the other one, and is lost then.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.hosts.base import Array
from mxeon.shaders.plane import DISTANCE, FOV, LIGHT_RADIUS, TILT, plane_points
from mxeon.shaders.scene import Scene

SCENE, PLANE, LIGHT = "scene.xml", "plane.obj", "light.obj"
CORNERS = ((-300.0, -100.0, 0.0), (300.0, -100.0, 0.0), (0.0, 500.0, 0.0))  # of the plane
EQUILATERAL = ((1.0, 0.0), (-0.5, 0.75**0.5), (-0.5, -(0.75**0.5)))

WORLD = """<World>
  <Option no_jitter="int 1" />
  <Camera eye="0,0,1" dir="0,{sine:.9g},{cosine:.9g}" up="0,0,1" fov="{fov:.9g}" />
  <ShaderGroup name="plane">
    shader {shader} material ;
    shader mxeon_root root ;
    connect material.out root.material ;
  </ShaderGroup>
  <Model filename="{plane}" />
{light}
</World>
"""
LIGHT_GROUP = """  <ShaderGroup name="light" is_light="yes">
    param float radiance {radiance:.9g} ;
    shader mxeon_light light ;
  </ShaderGroup>
  <Model filename="{light}" />"""
# Of resolution 0: no table of a sky that is uniform.
SKY_GROUP = """  <ShaderGroup name="sky">
    param float radiance {radiance:.9g} ;
    shader mxeon_sky sky ;
  </ShaderGroup>
  <Background resolution="0" />"""


def files(shader: str, scene: Scene) -> dict[str, str]:
    """Texts of the files of a scene, by name.

    Parameters
    ----------
    shader : str
        Name of the plane's shader, whose output is `out`.
    scene : Scene
        A distant light, or a uniform environment.
    """
    texts = {PLANE: _model(np.array(CORNERS))}
    if scene.light is None:
        light = SKY_GROUP.format(radiance=scene.environment)
    else:
        light = LIGHT_GROUP.format(radiance=_radiance(scene.light), light=LIGHT)
        texts[LIGHT] = _model(_corners(scene.light))
    texts[SCENE] = WORLD.format(
        sine=np.sin(TILT), cosine=-np.cos(TILT), fov=FOV, shader=shader, plane=PLANE, light=light
    )
    return texts


def irradiance(light: ArrayLike, size: int) -> NDArray[np.float64]:
    """Irradiance over pi of a surface that faces the light, (size * size,): nearly 1."""
    corners = _corners(light)
    away = corners.mean(axis=0) - plane_points(size)
    squared = (away**2).sum(axis=1)
    # The product with the area's vector: area times the cosine at the light times the distance.
    solid: NDArray[np.float64] = np.abs(away @ _area(corners)) / squared**1.5
    return solid * _radiance(light) / np.pi


def _radiance(light: ArrayLike) -> float:
    """Radiance of the light: its irradiance is about pi."""
    return float(np.pi * DISTANCE**2 / np.linalg.norm(_area(_corners(light))))


def _corners(light: ArrayLike) -> NDArray[np.float64]:
    """Corners of the light, (3, 3): float32 numbers, as testrender has them."""
    toward = np.asarray(light)
    x = np.cross([0.0, 1.0, 0.0] if abs(toward[1]) < 0.9 else [1.0, 0.0, 0.0], toward)
    x = x / np.linalg.norm(x)
    y = np.cross(toward, x)
    offsets: NDArray[np.float64] = np.array(EQUILATERAL) @ [x, y]
    corners = DISTANCE * toward + LIGHT_RADIUS * offsets
    return corners.astype(np.float32).astype(np.float64)


def _area(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normal of a triangle, as long as its area is large."""
    return 0.5 * np.cross(corners[1] - corners[0], corners[2] - corners[0])


def _model(corners: Array) -> str:
    """A triangle as an OBJ file."""
    rows = "".join("v {:.9g} {:.9g} {:.9g}\n".format(*corner) for corner in corners)
    return f"{rows}f 1 2 3\n"
