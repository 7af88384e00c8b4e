# SPDX-License-Identifier: Apache-2.0
"""Scenes to render: a shape and its light, seen by an orthographic camera that looks along -z.

In the world frame, x points to the right, y up, and z towards the viewer. A picture shows the
square [-1, 1]^2 of x and y, and row 0 is the top row. The module only needs NumPy, because hosts
and checks both import the module and share no other code.
"""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import InputError, assert_known
from mxeon.io.images import Floats

SHAPES = ("sphere", "ball")
MESHES = (".obj", ".glb")
LARGEST = 8192  # pixels; every OpenGL 4 device supports such images, which take some gigabytes
MOST_SAMPLES = 65536  # a picture of 512 x 512 pixels then takes one CPU core a day
MOST_BOUNCES = 1024  # maximum of Blender's Cycles


@dataclass(frozen=True)
class Paths:
    """Samples and bounces of a path-traced picture; None lets the host decide.

    >>> Paths(samples=64).bounces is None
    True
    """

    samples: int | None = None  # samples per pixel, in [1, MOST_SAMPLES]
    bounces: int | None = None  # maximum bounces, in [1, MOST_BOUNCES]

    def __post_init__(self) -> None:
        for name, most in (("samples", MOST_SAMPLES), ("bounces", MOST_BOUNCES)):
            number = getattr(self, name)
            if number is not None and not 1 <= number <= most:
                raise InputError(f"{name} must lie in [1, {most}]; got {number}")


@dataclass(frozen=True)
class Lamp:
    """A light of one of MaterialX's types. The angles of a spot light are given as cosines."""

    type: int = 1  # number of the type: 1 directional, 2 point, 3 spot
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    intensity: float = np.pi
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)  # direction of travel of the light
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    decay_rate: float = 2.0
    inner_angle: float = 0.0
    outer_angle: float = 0.0


Matrix: TypeAlias = tuple[float, ...]  # 16 numbers in column-major order
ONE: Matrix = tuple(np.eye(4).ravel().tolist())
TURN: Matrix = tuple(np.diag([-1.0, 1.0, -1.0, 1.0]).ravel().tolist())


@dataclass(frozen=True, eq=False)
class Client:
    """Values that an application binds, without the scene. MaterialX has the same defaults."""

    lamps: tuple[Lamp, ...] = ()
    turn: Matrix = TURN  # maps the world to the environment map's frame
    intensity: float = 1.0  # scale of the environment
    radiance: NDArray[np.float32] | None = None  # environment map, used instead of the scene's map
    irradiance: NDArray[np.float32] | None = None
    two_sided: bool = False  # whether transmitted light is tinted both on entry and on exit
    shadow: Matrix = ONE  # maps the world to the coordinates [-1, 1] of the shadow map
    # The first two moments of depth, which are constant over the shadow map.
    moments: tuple[float, float] = (1.0, 1.0)
    ambient: float = 1.0  # value of the ambient occlusion map
    gain: float = 1.0  # gain of ambient occlusion
    alpha: bool = False  # whether pictures show alpha instead of the color


CLIENT = Client()


@dataclass(frozen=True)
class Scene:
    """A shape and its light."""

    name: str  # one lower-case word, used in file names
    # Unit vector towards a distant light of irradiance pi. A pixel has the value pi f cos(theta_i),
    # which is 1 for a white Lambertian surface that faces the light.
    light: tuple[float, float, float] | None = None
    # Radiance of a uniform environment, or a latitude-longitude image.
    environment: float | Path | None = None
    size: int = 256  # width and height in pixels, in [1, LARGEST]
    paths: Paths = Paths()  # hosts that do not trace paths only accept the default
    # "sphere" (the unit sphere), "ball" (the shader ball), or the file of a mesh. The hosts gl and
    # webgl support all shapes.
    shape: str = "sphere"
    client: Client = CLIENT  # only gl and webgl support other values

    def __post_init__(self) -> None:
        if not 1 <= self.size <= LARGEST:
            raise InputError(f"size must lie in [1, {LARGEST}]; got {self.size}")
        if self.shape not in SHAPES and not self.shape.lower().endswith(MESHES):
            names = ", ".join((*SHAPES, f"a file {' or '.join(MESHES)}"))
            raise InputError(f"shape must be one of {names}; got {self.shape!r}")


def direction(azimuth: float, polar: float) -> tuple[float, float, float]:
    """Unit vector at `polar` degrees from the z axis and `azimuth` degrees from x towards y."""
    theta, phi = np.radians(polar), np.radians(azimuth)
    return (
        float(np.sin(theta) * np.cos(phi)),
        float(np.sin(theta) * np.sin(phi)),
        float(np.cos(theta)),
    )


VIEW = (0.0, 0.0, 1.0)  # towards the viewer
FRONT = Scene("front", light=(0.0, 0.0, 1.0))
SIDE = Scene("side", light=direction(azimuth=20, polar=60))
BACK = Scene("back", light=direction(azimuth=160, polar=130))
FURNACE = Scene("furnace", environment=1.0)
SCENES = (FRONT, SIDE, BACK, FURNACE)
# The studio has a light from behind and an environment map with a floor, a ceiling and three soft
# boxes, which tools/site/gallery.py paints.
STUDIO = Scene("studio", BACK.light, Path(__file__).with_name("studio.exr"), shape="ball")


def scene(name: str) -> Scene:
    """The scene with this name: one of SCENES, or STUDIO.

    >>> scene("furnace").environment
    1.0
    """
    scenes = {each.name: each for each in (*SCENES, STUDIO)}
    assert_known("scene", name, scenes)
    return scenes[name]


@dataclass(frozen=True, eq=False)  # compared by identity
class VisiblePoints:
    """The visible points of a shape, one for each position in the picture."""

    mask: NDArray[np.bool_]  # whether each position shows the shape
    position: Floats  # points (..., 3); meaningless outside the mask
    normal: Floats  # outward unit vectors; outside the mask, any unit vector
    # Latitude-longitude coordinates in [0, 1]. The point at (0.5, 0.5) faces the viewer, and v
    # increases upwards.
    texcoord: Floats
    tangent: Floats | None = None  # unit vectors; None stands for the result of `tangents`

    def __post_init__(self) -> None:
        for array in vars(self).values():
            if array is not None:
                array.flags.writeable = False  # because all callers share the array


def pixel_centers(size: int, margin: int = 0) -> tuple[Floats, Floats]:
    """x and y of a picture's pixel centers, with `margin` additional pixels on each side."""
    axis = (2.0 * np.arange(-margin, size + margin) + 1.0) / size - 1.0
    x, y = np.meshgrid(axis, -axis)
    return x, y


@lru_cache(maxsize=8)
def sphere(size: int) -> VisiblePoints:
    """Points of the unit sphere under the pixel centers of a `size` x `size` picture."""
    return sphere_at(*pixel_centers(size))


def sphere_at(x: Floats, y: Floats) -> VisiblePoints:
    """Points of the unit sphere at positions in the picture.

    Positions outside the sphere have z = 0 and the normal of the nearest point of the rim.
    """
    radius = np.hypot(x, y)
    mask = radius < 1.0
    scale = 1.0 / np.maximum(radius, 1.0)
    z = np.sqrt(np.maximum(0.0, 1.0 - radius * radius))
    position = np.stack([x, y, z], axis=-1)
    normal = np.stack([x * scale, y * scale, z], axis=-1)
    u = 0.5 + np.arctan2(normal[..., 0], normal[..., 2]) / (2.0 * np.pi)
    v = 0.5 + np.arcsin(np.clip(normal[..., 1], -1.0, 1.0)) / np.pi
    return VisiblePoints(mask, position, normal, np.stack([u, v], axis=-1))


def local_directions(
    normal: NDArray[np.float64], direction: tuple[float, float, float]
) -> NDArray[np.float64]:
    """A world direction in the local frames of unit normals (N, 3), as unit vectors (N, 3)."""
    helper = np.where(np.abs(normal[:, :1]) < 0.5, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    tangent = np.cross(helper, normal)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    axes = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    local = axes @ np.asarray(direction)
    unit: NDArray[np.float64] = local / np.linalg.norm(local, axis=1, keepdims=True)
    return unit


def tangents(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Eastward unit tangents (N, 3) at unit normals (N, 3) of the sphere; 0 for normals along y."""
    east = np.stack([normal[:, 2], np.zeros(len(normal)), -normal[:, 0]], axis=1)
    unit: NDArray[np.float64] = east / np.maximum(
        np.linalg.norm(east, axis=1, keepdims=True), 1e-30
    )
    return unit
