# SPDX-License-Identifier: Apache-2.0
"""Frames and triangles with which renderers show pairs of directions, one pair in each pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.base import Array

Vectors = NDArray[np.float64]

LEAST_SINE = 0.08  # of the angle between view and light: the camera would see the light, or have points behind it
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


def unit(vectors: Vectors) -> Vectors:
    """The vectors, each of length 1."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
