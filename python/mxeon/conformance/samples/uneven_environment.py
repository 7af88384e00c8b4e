# SPDX-License-Identifier: Apache-2.0
"""An uneven sky: its irradiance tells the normal at which it is looked up."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.samples.batch import Array
from mxeon.hosts.base import TURN
from mxeon.hosts.textures import latlong_directions

ROWS = 128  # of its map, which has twice as many columns
SLOPE = 0.5  # of the irradiance over a component of the normal


def sky(normal: Array) -> Array:
    """Irradiance over pi at normals (N, 3): each channel grows along an axis of its own."""
    return 0.5 + SLOPE * normal


def sky_behind(values: Array) -> Array:
    """Means of the sky with every normal turned around, from those with none."""
    return 1.0 - values


@lru_cache(maxsize=1)
def sky_map() -> NDArray[np.float32]:
    """The irradiance over pi as a latitude-longitude map, (ROWS, 2 ROWS, 3)."""
    directions, _ = latlong_directions(ROWS, 2 * ROWS)
    return sky(directions @ TURN[:3, :3]).reshape(ROWS, 2 * ROWS, 3).astype(np.float32)
