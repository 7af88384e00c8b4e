# SPDX-License-Identifier: Apache-2.0
"""Renderers that evaluate any pairs of directions: each pixel of their pictures shows one pair."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import InputError
from mxeon.hosts import base
from mxeon.hosts.base import Array, Inputs, Query

if TYPE_CHECKING:
    from mxeon.shaders.generation import Shader

PATHS = 1 << 12  # pixels of a picture with a sky
DIRECT, TRANSMITTED, EMITTED = "direct", "transmission", "emission"  # branches of `evaluate`
LAMP, SKY, DARK = "lamp", "sky", ""  # lights of a scene
# Last statement of a shader that adds white emission below the surface.
BASE = "    {output} = layer({output}, uniform_edf(color(1)));\n"


class PairHost(base.Host):
    """A renderer that compiles OSL and shows pairs of directions."""

    target = "osl"
    language = "osl"

    def _values(self, query: Query) -> Array:
        """Values of a shader in a renderer; see `mxeon.hosts.base.Host`.

        The throughput is the visible part of white emission below the surface. The environment is
        sampled with noise, and includes transmitted light. InputError if a pair under the lamp is
        not `visible`.
        """
        shader, wo, wi, inputs, branch, output, irradiance, _ = query
        through = output == "throughput"
        if irradiance is not None or (branch == TRANSMITTED and not through):
            raise self._unsupported(
                "uneven environment, and none that is only below the surface", "gl"
            )
        if branch == DIRECT and output == "response":
            if not visible(wo, wi).all():
                raise InputError(
                    f"{self.name}: the sine of each pair must be at least {LEAST_SINE}"
                )
            return self._pixels(shader, wo, wi, inputs, "", LAMP)
        # Emission and sky ignore wi: use one perpendicular to wo. A sky needs several pixels.
        sky = not through and branch != EMITTED
        repeats = max(1, PATHS // len(wo)) if sky else 1
        rows = np.repeat(np.arange(len(wo)), repeats)
        spread = {
            name: np.asarray(each)[rows] if np.shape(each)[:1] == (len(wo),) else each
            for name, each in inputs.items()
        }
        last, across = BASE if through else "", perpendicular(wo)[rows]
        pixels = self._pixels(shader, wo[rows], across, spread, last, SKY if sky else DARK)
        return np.asarray(pixels.reshape(len(wo), repeats, 3).mean(axis=1))

    @abstractmethod
    def _pixels(
        self, shader: Shader, wo: Array, wi: Array, inputs: Inputs, last: str, light: str
    ) -> NDArray[np.float64]:
        """Radiance of pairs, (N, 3); `last` with {output} is the shader's last OSL statement.

        `light` is LAMP with irradiance 1 on a facing surface, SKY with uniform radiance 1, or DARK.
        """


Vectors = NDArray[np.float64]

# Least sine between wo and wi; below it, the light is in view or points are behind the camera.
LEAST_SINE = 0.08
FARTHER = 1.001 * LEAST_SINE  # allows for rounding
NO_SINE = 1e-6  # sine of directions that are equal up to the rounding of float32
CORNERS = ((1.0, 0.0), (-0.5, 0.75**0.5), (-0.5, -(0.75**0.5)))  # corners of a triangle


def frames(first: Vectors, other: Vectors) -> Vectors:
    """Axes as columns, (N, 3, 3): the first vectors, perpendiculars to both, and cross products."""
    across = unit(np.cross(first, other))
    return np.stack([first, across, np.cross(first, across)], axis=-1)


def perpendicular(vectors: Array) -> Vectors:
    """Perpendicular unit vectors, (N, 3)."""
    axes = np.where(np.abs(vectors[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    return unit(np.cross(vectors, axes))


def visible(wo: Array, wi: Array) -> NDArray[np.bool_]:
    """Mask of the pairs of directions that a scene can show, (N,)."""
    return np.asarray(np.linalg.norm(np.cross(wo, wi), axis=1) >= LEAST_SINE)


def apart(wo: Array, wi: Array) -> Array:
    """Lights turned away from the view, or from its opposite, until the pairs are visible."""
    # Component of the light perpendicular to the view; any perpendicular if it is 0.
    cosine = (wo * wi).sum(axis=1, keepdims=True)
    across = wi - cosine * wo
    sine = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(sine > NO_SINE, across, perpendicular(wo))
    along = np.sign(cosine) * np.sqrt(1.0 - FARTHER**2)
    moved = unit(along * wo + FARTHER * unit(across))  # wo only has unit length up to rounding
    return np.where(visible(wo, wi)[:, np.newaxis], wi, moved)


def unit(vectors: Vectors) -> Vectors:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


PIXEL = 2.0**-5  # width of a pixel
JITTER = 0.5 * 0.01 * 2.0**0.5  # distance of a sample from the middle of its pixel, in pixels
DISTANCE = 256.0  # horizontal distance of the light from the middle of the picture
TRIANGLE = 0.4 * PIXEL  # distance of a triangle's corners from the middle of the pixel
HEIGHT = 16.0 * DISTANCE  # height of the camera; the highest point is at 12.5 DISTANCE
VIEW = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class TurnedPairs:
    turn: Vectors  # rotations from the pairs' frames to the scene's, (N, 3, 3)

    def turned(self, vectors: Array) -> Vectors:
        """Vectors (N or 1, 3) of the pairs' frames in the scene's frame."""
        each = np.broadcast_to(np.asarray(vectors, np.float64), (len(self.turn), 3))
        return np.asarray((self.turn @ each[:, :, np.newaxis])[:, :, 0])


@dataclass(frozen=True)
class TiltedTriangles(TurnedPairs):
    width: float  # width of the picture
    corners: Vectors  # three corners of each triangle, (N, 3, 3)
    irradiance: Vectors  # irradiance of a surface facing a light of radiant intensity 1, (N, 1)

    @property
    def place(self) -> str:
        """OSL expressions of a point's coordinates in an image."""
        return f"0.5 + P[0] / {self.width:.9g}, 0.5 - P[1] / {self.width:.9g}"


def tilted_triangles(wo: Array, wi: Array, size: int) -> TiltedTriangles:
    """Triangles that show pairs (N, 3), N <= size^2, with a sine of at least LEAST_SINE.

    The camera looks down from far away with parallel rays, and a point light is to the side of the
    picture. The depth of a triangle along its pixel's ray sets the angle between view and light.
    Geometric and shaded normal are equal.
    """
    # Points that see the light at the required angle.
    wo, wi = (np.asarray(each, np.float64) for each in (wo, wi))
    axis = PIXEL * (np.arange(size) + 0.5 - size / 2.0)
    x, y = (each.ravel()[: len(wo)] for each in np.meshgrid(axis, -axis))
    cotangent = (wo * wi).sum(axis=1) / np.linalg.norm(np.cross(wo, wi), axis=1)
    z = -np.hypot(DISTANCE + x, y) * cotangent
    points = np.stack([x, y, z], axis=1).astype(np.float32).astype(np.float64)
    # Frames of both pairs, with the view as their first axis.
    light = np.array([-DISTANCE, 0.0, 0.0]) - points
    world = frames(np.broadcast_to(VIEW, points.shape), unit(light))
    turn = world @ np.swapaxes(frames(wo, wi), 1, 2)
    # Corners in the plane perpendicular to the shaded normal.
    normal = turn[:, :, 2]
    offsets = TRIANGLE * np.array(CORNERS)
    depth = -(normal[:, :2] @ offsets.T) / normal[:, 2:]
    flat = np.broadcast_to(offsets, (len(points), 3, 2))
    corners = points[:, np.newaxis] + np.concatenate([flat, depth[:, :, np.newaxis]], axis=2)
    squared = (light * light).sum(axis=1, keepdims=True)
    return TiltedTriangles(turn, PIXEL * size, corners, 1.0 / squared)
