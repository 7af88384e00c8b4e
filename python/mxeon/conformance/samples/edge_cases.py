# SPDX-License-Identifier: Apache-2.0
"""Pairs and inputs that random ones miss: exact directions, edges of ranges, turned frames."""

from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.samples.batch import (
    Array,
    Batch,
    directions,
    float32,
    random_inputs,
    rounded,
    rounded_roughness,
)
from mxeon.conformance.samples.uneven_environment import texel_middles
from mxeon.models.table import Model

EACH = 256  # pairs of each kind
GRID = (1.0, 0.999, 0.6, 0.25, 0.05, 1e-3, 1e-5, 1e-6, 3e-7, 1e-7)  # cosines
AZIMUTHS = (0.0, 0.5 * np.pi, np.pi)
ABOVE_ONE = 1.0 + 2.0**-23  # a cosine of unit vectors, by a rounding of float32
HORIZON = 0.1  # least cosine of the other direction where one is at the horizon or below it
POLE = 0.99  # largest height of a normal in turned frames: a map of the sky ends at the poles
TURNED = (0.25, 0.95)  # cosines in turned frames, where a cosine has roundings
LEAST_SHEEN = 0.01  # roughness of the other lobes, which the Zeltner sheen has at least
LEAST_COLOR82 = 0.5  # of a lobe whose albedo is asked; see docs/loading.md
LEAST_TURNED = 0.1  # roughness of microfacets in turned frames
TINY = (0.0, 1e-6, 1e-3, 1.0)  # of a color channel
SMOOTH = (0.0, 1e-6, 1e-3, 1.0)  # roughness, in units of the largest
WEIGHTS = (-0.5, 0.0, 1e-4, 0.01, 0.5)
OCCLUSIONS = (0.0, 1e-3, 0.5)


def special_directions(rng: np.random.Generator) -> tuple[Array, Array]:
    """Exact directions `wo` and `wi`, above the horizon or on it.

    A grid of cosines down to 1e-7 with equal, perpendicular and opposite azimuths; and with a random
    other direction: exact retro-reflection, the mirror direction, the viewer or the light along the
    normal, the viewer or the light on the horizon.
    """
    mu_o, mu_i, azimuth = np.array(list(product(GRID, GRID, AZIMUTHS))).T
    free, other = directions(rng, EACH), directions(rng, EACH)
    high = _directions(HORIZON + (1.0 - HORIZON) * rng.random(EACH), 2.0 * np.pi * rng.random(EACH))
    rim = _directions(np.zeros(EACH), 2.0 * np.pi * rng.random(EACH))
    normal = np.broadcast_to([0.0, 0.0, 1.0], free.shape)
    pairs = (
        (_directions(mu_o, 0.0 * mu_o), _directions(mu_i, azimuth)),
        (free, free),
        (free, free * [-1.0, -1.0, 1.0]),
        (normal, free),
        (free, normal),
        (normal[:1], normal[:1]),
        (rim, high),
        (high, rim),
        (free, other),
    )
    wo, wi = (np.concatenate(each) for each in zip(*pairs, strict=True))
    return wo, wi


def special_inputs(rng: np.random.Generator, count: int, row: Model) -> dict[str, Array]:
    """Colors and roughnesses of a diffuse model, of which half lie on an edge."""
    inputs = random_inputs(rng, count, row)
    inputs["color"] = with_edges(rng, inputs["color"], TINY)
    roughness = with_edges(rng, inputs["roughness"], [row.largest * x for x in SMOOTH])
    inputs["roughness"] = rounded_roughness(roughness, row)
    return inputs


def outside_directions(rng: np.random.Generator) -> tuple[Array, Array]:
    """Directions that no model has: light from below the horizon, and cosines that exceed 1."""
    below = directions(rng, EACH) * [1.0, 1.0, -1.0]
    high = _directions(HORIZON + (1.0 - HORIZON) * rng.random(EACH), 2.0 * np.pi * rng.random(EACH))
    straight = np.broadcast_to([0.0, 0.0, ABOVE_ONE], below.shape)
    wo = np.concatenate([high, straight, directions(rng, EACH)])
    wi = np.concatenate([below, directions(rng, EACH), straight])
    return wo, wi


def turned_frames(rng: np.random.Generator, count: int) -> Array:
    """Axes of at most so many random frames, as columns.

    Each normal points to the middle of a texel of the sky, and none to a pole.
    """
    axes, _ = np.linalg.qr(rng.standard_normal((count, 3, 3)))
    axes = axes[np.abs(axes[:, 1, 2]) <= POLE]
    return aimed(axes, axes[:, :, 2], texel_middles(axes[:, :, 2]))


def aimed(axes: Array, of: Array, to: Array) -> Array:
    """Frames (N, 3, 3), turned the shortest way that takes unit vectors `of` to others `to`, (N, 3).

    That is half a turn about the middle of both, and half a turn about the second.
    """
    for vectors in (of + to, to):
        about = vectors[:, :, np.newaxis]
        along = np.sum(about * axes, axis=1, keepdims=True) / np.sum(
            about**2, axis=1, keepdims=True
        )
        axes = 2.0 * along * about - axes
    return axes


def turned_directions(rng: np.random.Generator, count: int) -> Array:
    """Directions for turned frames, (count, 3)."""
    low, high = TURNED
    return _directions(low + (high - low) * rng.random(count), 2.0 * np.pi * rng.random(count))


def diffuse_edges() -> Batch:
    """Pairs, colors and roughnesses at the edges of the domain of a diffuse node."""
    cosine = [0.0, 1e-30, 1e-6, 0.5, 1.0]
    rows = product(cosine, cosine, [0.0, 1.0, 2.0, np.pi], [0.0, 1e-6, 1.0], [0.0, 0.5, 1.0])
    mu_o, mu_i, azimuth, roughness, color = np.array(list(rows)).T
    S_o, S_i = np.sqrt(1.0 - mu_o**2), np.sqrt(1.0 - mu_i**2)
    wo = np.stack([S_o, 0.0 * S_o, mu_o], axis=-1)
    wi = np.stack([S_i * np.cos(azimuth), S_i * np.sin(azimuth), mu_i], axis=-1)
    return Batch(wo, wi, {"color": np.stack([color] * 3, axis=-1), "roughness": roughness})


def node_inputs(rng: np.random.Generator, count: int) -> dict[str, Array]:
    """Random weights and occlusions: 1 for half of the pairs, an edge for many others."""
    return {
        name: np.where(rng.random(count) < 0.5, 1.0, with_edges(rng, rng.random(count), edges))
        for name, edges in (("weight", WEIGHTS), ("occlusion", OCCLUSIONS))
    }


def with_edges(rng: np.random.Generator, values: Array, edges: ArrayLike) -> Array:
    """Values of which half are replaced by random edges, as float32 numbers."""
    picked = rng.choice(np.asarray(edges, np.float64), np.shape(values))
    mixed = np.where(rng.random(np.shape(values)) < 0.5, picked, values)
    return float32(mixed)


def _directions(mu: Array, azimuth: Array) -> Array:
    """Directions of given cosines, float32 numbers, and azimuths."""
    mu = float32(mu)
    radius = np.sqrt(1.0 - mu * mu)
    return rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])
