# SPDX-License-Identifier: Apache-2.0
"""Renderers whose pictures show one pair of directions per pixel, so they evaluate any pairs."""

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

PATHS = 1 << 12  # pixels of a picture with a sky, each of the host's own number of paths
DIRECT, TRANSMITTED, EMITTED = "direct", "transmission", "emission"  # branches of `evaluate`
LAMP, SKY, DARK = "lamp", "sky", ""  # lights of a scene
BASE = "    {output} = layer({output}, uniform_edf(color(1)));\n"  # what shines through a layer


class PairHost(base.Host):
    """A renderer that compiles OSL and shows pairs of directions."""

    target = "osl"
    language = "osl"

    def _values(self, query: Query) -> Array:
        """The values of a shader's closures in a renderer; see `mxeon.hosts.base.Host`.

        The throughput is the visible part of a white emission below. The environment is sampled, so it
        has noise; what comes through the surface is part of it. InputError if a pair in the light of a
        point is not `mxeon.hosts.pairs.visible`.
        """
        shader, wo, wi, inputs, branch, output, irradiance = query
        through = output == "throughput"
        if irradiance is not None or (branch == TRANSMITTED and not through):
            raise self._unsupported("uneven environment, and none below alone", "gl")
        if branch == DIRECT and output == "response":
            if not visible(wo, wi).all():
                raise InputError(
                    f"{self.name}: the sine of each pair must be at least {LEAST_SINE}"
                )
            return self._pixels(shader, wo, wi, inputs, "", LAMP)
        # What does not depend on the light: each view has one across it, and a sky several pixels.
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
        """What pairs look like, (N, 3), where the OSL `last`, a pattern of its `output`, ends the shader.

        `light` is LAMP, of irradiance 1 on what faces it, SKY, a uniform radiance 1, or DARK.
        """


Vectors = NDArray[np.float64]

LEAST_SINE = 0.08  # of the angle between view and light: the camera would see the light, or have points behind it
FARTHER = 1.001 * LEAST_SINE  # beyond roundings
NO_SINE = 1e-6  # of directions that are the same up to the roundings of float32
CORNERS = ((1.0, 0.0), (-0.5, 0.75**0.5), (-0.5, -(0.75**0.5)))  # of a triangle


def frames(first: Vectors, other: Vectors) -> Vectors:
    """Axes as columns, (N, 3, 3): the first vector, what is across both, and what is across these."""
    across = unit(np.cross(first, other))
    return np.stack([first, across, np.cross(first, across)], axis=-1)


def perpendicular(vectors: Array) -> Vectors:
    """Unit vectors across others, (N, 3)."""
    axes = np.where(np.abs(vectors[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    return unit(np.cross(vectors, axes))


def visible(wo: Array, wi: Array) -> NDArray[np.bool_]:
    """Which pairs of directions a scene can show, (N,)."""
    return np.asarray(np.linalg.norm(np.cross(wo, wi), axis=1) >= LEAST_SINE)


def apart(wo: Array, wi: Array) -> Array:
    """Lights turned away from the view, or from its opposite, until a renderer shows the pair."""
    # The direction across the view in which a light lies, or any where it has none.
    cosine = (wo * wi).sum(axis=1, keepdims=True)
    across = wi - cosine * wo
    sine = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(sine > NO_SINE, across, perpendicular(wo))
    along = np.sign(cosine) * np.sqrt(1.0 - FARTHER**2)
    moved = unit(along * wo + FARTHER * unit(across))  # wo is one up to its roundings
    return np.where(visible(wo, wi)[:, np.newaxis], wi, moved)


def unit(vectors: Vectors) -> Vectors:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


PIXEL = 2.0**-5  # width
JITTER = 0.5 * 0.01 * 2.0**0.5  # of a sample about the middle of its pixel, in pixels
DISTANCE = 256.0  # of the light from the middle of the picture, at its height
TRIANGLE = 0.4 * PIXEL  # of its corners from the middle of the pixel
HEIGHT = 16.0 * DISTANCE  # of the camera: the nearest point is 12.5 times the distance high
VIEW = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class TurnedPairs:
    turn: Vectors  # (N, 3, 3), from the frame of the pairs to that of the scene

    def turned(self, vectors: Array) -> Vectors:
        """Vectors of the frame of the pairs, (N or 1, 3), in that of the scene."""
        each = np.broadcast_to(np.asarray(vectors, np.float64), (len(self.turn), 3))
        return np.asarray((self.turn @ each[:, :, np.newaxis])[:, :, 0])


@dataclass(frozen=True)
class TiltedTriangles(TurnedPairs):
    width: float  # of the picture
    corners: Vectors  # (N, 3, 3)
    irradiance: Vectors  # (N, 1), of a surface that faces the light, of radiant intensity 1

    @property
    def place(self) -> str:
        """OSL expressions of the coordinates at which a point reads its pixel of an image."""
        return f"0.5 + P[0] / {self.width:.9g}, 0.5 - P[1] / {self.width:.9g}"


def tilted_triangles(wo: Array, wi: Array, size: int) -> TiltedTriangles:
    """Triangles that show pairs (N, 3), N <= size^2, with a sine of at least LEAST_SINE.

    The camera looks down from far away with parallel rays, and a light of one point lies beside the
    picture. The depth of a triangle on the ray of its pixel sets the angle between view and
    light. It is turned so that its own normal and the shaded one are the same.
    """
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
    return TiltedTriangles(turn, PIXEL * size, corners, 1.0 / squared)
