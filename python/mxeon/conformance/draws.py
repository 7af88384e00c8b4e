# SPDX-License-Identifier: Apache-2.0
"""Directions that were drawn, against the density that they should have: a chi-square test on the sphere.

Cells divide the angle from a pole, and the azimuth about it. The first ring is narrow, for a lobe that is nearly a
single direction: let the pole be that direction.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CELLS = 32  # of the angle, and of the azimuth
NODES = 8  # of the quadrature of a cell, on each axis
CONE = 0.02  # radian, the first ring
LEAST = 1e-7  # radian, below which a density is constant
RARE = 10.0  # expected draws, below which cells are put together


def deviation(
    draws: Array, density: Callable[[Array], Array], pole: Array, nodes: int = NODES
) -> float:
    """Standard deviations by which the counts of draws leave a density, 0 for any less than chance brings.

    Infinite for a density that is no number.

    The cube root of chi-square over its degrees of freedom is nearly normal [WilsonHilferty1931].

    - `draws`: Unit vectors, (N, 3); zeros for draws that are lost, whose share is 1 minus the integral.
    - `density`: Of unit vectors (M, 3), in 1/sr, (M,).
    """
    w, area = quadrature(pole, nodes)
    shares = np.bincount(cell(w, pole), density(w) * area, minlength=(CELLS + 1) * CELLS)
    kept = np.linalg.norm(draws, axis=1) > 0.5
    counts = np.bincount(cell(draws[kept], pole), minlength=len(shares))
    mean = len(draws) * np.append(shares, 1.0 - shares.sum())
    observed = np.append(counts, len(draws) - kept.sum())
    rare = mean < RARE
    observed, mean = (np.append(each[~rare], each[rare].sum()) for each in (observed, mean))
    mean[-1] = max(mean[-1], RARE)
    freedom = len(mean) - 1
    spread = 2.0 / (9.0 * freedom)
    ratio = ((observed - mean) ** 2 / mean).sum() / freedom
    score = (ratio ** (1.0 / 3.0) - (1.0 - spread)) / np.sqrt(spread)
    return max(float(score), 0.0) if np.isfinite(score) else np.inf


def axes(pole: Array) -> Array:
    """Two unit vectors across the pole, and the pole, (3, 3)."""
    across = np.cross(pole, np.eye(3)[np.argmin(np.abs(pole))])
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(pole, across), pole])


def cell(w: Array, pole: Array) -> NDArray[np.int64]:
    """Number of the cell of each direction."""
    x, y, z = axes(pole) @ w.T
    angle, azimuth = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x) / (2.0 * np.pi) % 1.0
    ring = np.floor((angle - CONE) / (np.pi - CONE) * CELLS).clip(-1, CELLS - 1) + 1
    sector = np.minimum(np.floor(azimuth * CELLS), CELLS - 1)
    number: NDArray[np.int64] = (ring * CELLS + sector).astype(np.int64)
    return number


def quadrature(pole: Array, nodes: int) -> tuple[Array, Array]:
    """Directions and solid angles of the midpoint rule in each cell; in the first ring its steps grow by a factor."""
    inner = np.append(0.0, np.geomspace(LEAST, CONE, 8 * nodes))
    edges = np.append(inner, np.linspace(CONE, np.pi, CELLS * nodes + 1)[1:])
    angle, height = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    turn = 2.0 * np.pi / (CELLS * nodes)
    azimuth = turn * (np.arange(CELLS * nodes) + 0.5)
    ring = np.stack([np.cos(azimuth), np.sin(azimuth)])
    z = np.broadcast_to(np.cos(angle)[:, np.newaxis], (len(angle), len(azimuth)))
    local = np.stack([*(np.sin(angle)[:, np.newaxis] * each for each in ring), z], axis=-1)
    area = 2.0 * np.sin(angle) * np.sin(height) * turn
    return local.reshape(-1, 3) @ axes(pole), np.repeat(area, len(azimuth))
