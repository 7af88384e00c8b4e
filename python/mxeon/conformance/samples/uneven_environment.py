# SPDX-License-Identifier: Apache-2.0
"""An uneven sky: its irradiance tells the normal at which it is looked up."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.samples.batch import Array
from mxeon.hosts.base import TURN
from mxeon.hosts.textures import latlong_directions

SKY_ROWS = 128  # of its map, which has twice as many columns
SLOPE = 0.5  # of the irradiance over a component of the normal


def sky(normal: Array) -> Array:
    """Irradiance over pi at normals (N, 3): each channel grows along an axis of its own."""
    return 0.5 + SLOPE * normal


def sky_behind(values: Array) -> Array:
    """Means of the sky with every normal turned around, from those with none."""
    return 1.0 - values


@lru_cache(maxsize=1)
def sky_map() -> NDArray[np.float32]:
    """The irradiance over pi as a latitude-longitude map, (SKY_ROWS, 2 SKY_ROWS, 3)."""
    directions, _ = latlong_directions(SKY_ROWS, 2 * SKY_ROWS)
    return sky(directions @ TURN[:3, :3]).reshape(SKY_ROWS, 2 * SKY_ROWS, 3).astype(np.float32)


def texel_middles(near: Array) -> Array:
    """The directions to the middles of texels of the map next to unit vectors, both (N, 3).

    There every filter reads one texel. So is the opposite direction such a middle.
    """
    polar = np.arccos(np.clip(near[:, 1], -1.0, 1.0)) / np.pi
    azimuth = np.arctan2(near[:, 0], -near[:, 2]) / (2.0 * np.pi) + 0.5
    row = np.minimum((SKY_ROWS * polar).astype(int), SKY_ROWS - 1)
    column = (2 * SKY_ROWS * azimuth).astype(int) % (2 * SKY_ROWS)
    middles, _ = latlong_directions(SKY_ROWS, 2 * SKY_ROWS)
    return np.asarray(middles[2 * SKY_ROWS * row + column])
