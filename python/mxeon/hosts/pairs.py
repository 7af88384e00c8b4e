# SPDX-License-Identifier: Apache-2.0
"""Renderers that evaluate any pair of directions. Each pixel of a picture shows one pair."""

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

PATHS = 1 << 12  # number of pixels in a picture with a sky
DIRECT, TRANSMITTED, EMITTED = "direct", "transmission", "emission"  # branches of `evaluate`
LAMP, SKY, DARK = "lamp", "sky", ""  # kinds of light in a scene
# Last statement of a shader, which adds white emission below the surface.
BASE = "    {output} = layer({output}, uniform_edf(color(1)));\n"


class PairHost(base.Host):
    """A renderer that compiles OSL and shows pairs of directions."""

    target = "osl"
    language = "osl"

    def _values(self, query: Query) -> Array:
        """Values of a shader in a renderer; see `mxeon.hosts.base.Host`.

        The throughput is measured with white emission below the surface. The environment is sampled
        with noise and also lights the surface from below. Raises InputError if the lamp cannot
        light a pair.
        """
        shader, wo, wi, inputs, branch, output, irradiance, _ = query
        through = output == "throughput"
        if irradiance is not None or (branch == TRANSMITTED and not through):
            raise self._unsupported(
                "uneven environment, and no environment only below the surface", "gl"
            )
        if branch == DIRECT and output == "response":
            if not visible(wo, wi).all():
                raise InputError(
                    f"{self.name}: the sine of each pair must be at least {LEAST_SINE}"
                )
            return self._pixels(shader, wo, wi, inputs, "", LAMP)
        # Results for emission and for a sky do not depend on wi, so wi is any vector normal to wo.
        # A mean over several pixels reduces the noise under a sky.
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
        """Radiance towards wo for each pair of directions, (N, 3).

        `last` is the last OSL statement of the shader, with {output} for the output's name. `light`
        is LAMP (irradiance 1 on a surface that faces the lamp), SKY (uniform radiance 1) or DARK.
        """


Vectors = NDArray[np.float64]

# Least sine of the angle between wo and wi. If the sine is smaller, the light is in view or the
# point is behind the camera.
LEAST_SINE = 0.08
FARTHER = 1.001 * LEAST_SINE  # sine after turning a direction, with a margin for rounding
NO_SINE = 1e-6  # directions with a smaller sine between them are equal up to float32 rounding
CORNERS = ((1.0, 0.0), (-0.5, 0.75**0.5), (-0.5, -(0.75**0.5)))  # an equilateral triangle


def frames(first: Vectors, other: Vectors) -> Vectors:
    """Frames of pairs of vectors, as matrices (N, 3, 3) whose columns are the axes.

    The first axis is the first vector, the second axis is perpendicular to both vectors, and the
    third axis is the cross product of the other axes.
    """
    across = unit(np.cross(first, other))
    return np.stack([first, across, np.cross(first, across)], axis=-1)


def perpendicular(vectors: Array) -> Vectors:
    """Unit vectors that are perpendicular to the given vectors, (N, 3)."""
    axes = np.where(np.abs(vectors[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    return unit(np.cross(vectors, axes))


def visible(wo: Array, wi: Array) -> NDArray[np.bool_]:
    """Mask of the pairs of directions that a scene can show, (N,)."""
    return np.asarray(np.linalg.norm(np.cross(wo, wi), axis=1) >= LEAST_SINE)


def apart(wo: Array, wi: Array) -> Array:
    """Turn each wi that is too close to wo or -wo, so that the angle to wo has the sine FARTHER."""
    # Component of wi perpendicular to wo. If the component is 0, any perpendicular vector is used.
    cosine = (wo * wi).sum(axis=1, keepdims=True)
    across = wi - cosine * wo
    sine = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(sine > NO_SINE, across, perpendicular(wo))
    along = np.sign(cosine) * np.sqrt(1.0 - FARTHER**2)
    moved = unit(along * wo + FARTHER * unit(across))  # the length of wo is 1 only up to rounding
    return np.where(visible(wo, wi)[:, np.newaxis], wi, moved)


def unit(vectors: Vectors) -> Vectors:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


PIXEL = 2.0**-5  # width of a pixel
JITTER = 0.5 * 0.01 * 2.0**0.5  # maximum distance of a sample from a pixel's center, in pixels
DISTANCE = 256.0  # horizontal distance of the light from the center of the picture
TRIANGLE = 0.4 * PIXEL  # distance of a triangle's corners from the center of the pixel
HEIGHT = 16.0 * DISTANCE  # height of the camera; the highest point is at 12.5 DISTANCE
VIEW = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class TurnedPairs:
    turn: Vectors  # rotations from the frames of pairs to the frame of the scene, (N, 3, 3)

    def turned(self, vectors: Array) -> Vectors:
        """Vectors (N or 1, 3), rotated from the frames of the pairs to the frame of the scene."""
        each = np.broadcast_to(np.asarray(vectors, np.float64), (len(self.turn), 3))
        return np.asarray((self.turn @ each[:, :, np.newaxis])[:, :, 0])


@dataclass(frozen=True)
class TiltedTriangles(TurnedPairs):
    width: float  # width of the picture
    corners: Vectors  # three corners of each triangle, (N, 3, 3)
    irradiance: Vectors  # irradiance of a surface facing a light of radiant intensity 1, (N, 1)

    @property
    def place(self) -> str:
        """OSL expressions of the two image coordinates of a point."""
        return f"0.5 + P[0] / {self.width:.9g}, 0.5 - P[1] / {self.width:.9g}"


def tilted_triangles(wo: Array, wi: Array, size: int) -> TiltedTriangles:
    """Triangles that show N <= size^2 pairs of directions, with sines of at least LEAST_SINE.

    The camera looks down from far away with parallel rays, and a point light is beside the picture.
    The depth of a triangle along the ray of a pixel sets the angle between view and light. The
    geometric normal and the shading normal are equal.
    """
    # Points at which the angle between view and light is as required.
    wo, wi = (np.asarray(each, np.float64) for each in (wo, wi))
    axis = PIXEL * (np.arange(size) + 0.5 - size / 2.0)
    x, y = (each.ravel()[: len(wo)] for each in np.meshgrid(axis, -axis))
    cotangent = (wo * wi).sum(axis=1) / np.linalg.norm(np.cross(wo, wi), axis=1)
    z = -np.hypot(DISTANCE + x, y) * cotangent
    points = np.stack([x, y, z], axis=1).astype(np.float32).astype(np.float64)
    # Rotate each pair so that wo points to the camera and wi points to the light.
    light = np.array([-DISTANCE, 0.0, 0.0]) - points
    world = frames(np.broadcast_to(VIEW, points.shape), unit(light))
    turn = world @ np.swapaxes(frames(wo, wi), 1, 2)
    # Corners in the plane perpendicular to the shading normal.
    normal = turn[:, :, 2]
    offsets = TRIANGLE * np.array(CORNERS)
    depth = -(normal[:, :2] @ offsets.T) / normal[:, 2:]
    flat = np.broadcast_to(offsets, (len(points), 3, 2))
    corners = points[:, np.newaxis] + np.concatenate([flat, depth[:, :, np.newaxis]], axis=2)
    squared = (light * light).sum(axis=1, keepdims=True)
    return TiltedTriangles(turn, PIXEL * size, corners, 1.0 / squared)
