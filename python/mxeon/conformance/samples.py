# SPDX-License-Identifier: Apache-2.0
"""Random and special pairs of directions with a node's inputs, rotated frames, and a sky map.

All samples are float32 values stored in float64, so that engines and models use equal numbers.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.hosts import base, textures
from mxeon.models.nodes.node import BLACK as BLACK
from mxeon.models.nodes.node import WHITE as WHITE
from mxeon.shaders.scene import Scene

# Seed of all samples. Shaders cannot predict the seed, and verdicts must not depend on the seed.
SEED: ContextVar[int] = ContextVar("seed", default=1)
GOLDEN_RATIO = 0.618  # multiples of this number modulo 1 are evenly spread
PAIRS = 1 << 16
FEW = 1 << 14  # default number of pairs for expensive checks
GRAZING = 1e-6  # smallest cosine of the random pairs
RIM = 0.05  # smallest cosine judged in pictures; nearer the rim, values vary inside a pixel
LOBE_RIM = 0.25  # smallest cosine judged in pictures of a diffuse lobe below other lobes

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Rng: TypeAlias = np.random.Generator
Values: TypeAlias = Mapping[str, ArrayLike]  # values of a node's inputs, by name
Changes: TypeAlias = tuple[Values, Values]  # inputs before and after a change of one input


@dataclass(frozen=True)
class Counts:
    """Numbers of samples that a spec draws."""

    pairs: int = PAIRS  # number of random pairs
    few: int = FEW  # number of random pairs in negative controls and in expensive checks
    diagnosed: int = FEW  # number of pairs per batch in a diagnosis
    albedos: int = 1 << 7  # number of views whose albedos are measured
    materials: int = 64  # number of materials in checks of integrals and averages
    nodes: int = 48  # number of quadrature nodes per axis
    mirrored: int = 1 << 11  # number of views with lights near the mirror direction

    def varied(self) -> "Counts":
        """Counts reduced by up to 1/8, depending on the seed. No shader can expect fixed counts."""
        share = 1.0 - (SEED.get() - 1) * GOLDEN_RATIO % 1.0 / 8.0
        names = "pairs", "few", "albedos", "mirrored"
        return replace(self, **{name: math.ceil(share * getattr(self, name)) for name in names})


def arrays(inputs: Values) -> dict[str, Array]:
    return {name: np.asarray(each) for name, each in inputs.items()}


@dataclass(frozen=True)
class Batch:
    """Pairs of directions, and the node's inputs for each pair."""

    wo: Array  # directions to the viewer in local frames, (N, 3), on or above the horizon
    wi: Array  # directions to the light in local frames, (N, 3)
    # Inputs of the node, and the input "occlusion", (N, ...) or constant. Normals and tangents are
    # in world space.
    inputs: Mapping[str, Array]
    scene: Scene | None = None  # scene of a picture, if the pairs are points of the picture
    frame: Array | None = None  # axes of local frames as columns, (N, 3, 3); world axes if None

    def altered(self, **inputs: ArrayLike) -> "Batch":
        return replace(self, inputs={**self.inputs, **arrays(inputs)})

    def with_row(self, row: int, wo: ArrayLike, **inputs: ArrayLike) -> "Batch":
        """A copy of the batch with another view and other inputs in a single row."""
        changed = {name: self.inputs[name].copy() for name in inputs}
        copy = replace(self.altered(**changed), wo=self.wo.copy())
        copy.wo[row] = wo
        for name, value in inputs.items():
            copy.inputs[name][row] = value
        return copy

    def first(self, count: int) -> "Batch":
        return self.where(slice(count))

    def where(self, rows: slice | NDArray[np.bool_] | NDArray[np.integer]) -> "Batch":
        count = len(self.wo)
        inputs = {
            name: values[rows] if np.shape(values)[:1] == (count,) else values
            for name, values in self.inputs.items()
        }
        frame = None if self.frame is None else self.frame[rows]
        return replace(self, wo=self.wo[rows], wi=self.wi[rows], inputs=inputs, frame=frame)

    def world(self, local: Array) -> Array:
        """Directions (N, 3), converted from local frames to world space and rounded to float32."""
        if self.frame is None:
            return local
        return float32((self.frame @ local[:, :, np.newaxis])[:, :, 0])

    @property
    def normal(self) -> Array:
        """Surface normals on the viewer's side, in world space, (N, 3)."""
        return self.world(np.broadcast_to([0.0, 0.0, 1.0], self.wo.shape))

    @property
    def strength(self) -> Array:
        """The node's weight, or 0 for a negative weight, (N, 1) or (1, 1)."""
        return np.maximum(np.reshape(self.inputs.get("weight", np.ones(1)), (-1, 1)), 0.0)

    @property
    def rough(self) -> Array:
        """The roughness of each pair, (N,): the larger of two alphas, or 0 without roughness."""
        roughness = np.asarray(self.inputs.get("roughness", 0.0), np.float64)
        if roughness.shape[-1:] == (2,):
            roughness = roughness.max(axis=-1)
        return np.broadcast_to(roughness, len(self.wo))


@dataclass(frozen=True)
class Candidate:
    """A function that may explain measured values."""

    title: str
    values: Callable[[Batch], Array]
    permitted: bool = False  # whether the specification permits the function
    anisotropic: bool = False  # whether the function equals the model if both alphas are equal


def generator() -> Rng:
    """A new random generator with the run's seed. Each kind of samples has its own generator."""
    return np.random.default_rng(SEED.get())


def directions(rng: Rng, count: int) -> Array:
    """Random directions. 3/4 of the cosines are uniform, and 1/4 is log-uniform down to 1e-6."""
    mu = rng.random(count)
    mu[: count // 4] = GRAZING ** rng.random(count // 4)
    rng.shuffle(mu)
    return directions_at(mu, 2.0 * np.pi * rng.random(count))


def float32(values: ArrayLike) -> Array:
    return np.asarray(values, np.float32).astype(np.float64)


def rounded(columns: Iterable[Array]) -> Array:
    """A table with the given columns, rounded to float32 and stored in float64."""
    return float32(np.stack(list(columns), axis=-1))


EACH = 256  # number of pairs of each special kind
GRID = (1.0, 0.999, 0.6, 0.25, 0.05, 1e-3, 1e-5, 1e-6, 3e-7, 1e-7)  # cosines of special pairs
AZIMUTHS = (0.0, 0.5 * np.pi, np.pi)
ABOVE_ONE = 1.0 + 2.0**-23  # cosine of equal unit vectors after one upward float32 rounding
HORIZON = 0.1  # smallest cosine of a direction if the other direction is on or below the horizon
POLE = 0.99  # largest |y| of normals in rotated frames, which excludes the poles of the sky map
TURNED = (0.25, 0.95)  # range of cosines in rotated frames; roundings matter near 0 and 1
LEAST_SHEEN = 0.01  # smallest sheen roughness; the Zeltner model clamps smaller values
LEAST_COLOR82 = 0.5  # smallest color82 of lobes with measured albedos; see docs/loading.md
LEAST_TURNED = 0.1  # smallest roughness of microfacets in rotated frames
WEIGHTS = (-0.5, 0.0, 1e-4, 0.01, 0.5)
OCCLUSIONS = (0.0, 1e-3, 0.5)


def special_directions(rng: Rng) -> tuple[Array, Array]:
    """Exact directions `wo` and `wi`, on or above the horizon.

    The pairs contain a grid of cosines down to 1e-7 with equal, perpendicular and opposite
    azimuths. Other pairs are exact retroreflections and mirror reflections. In the remaining pairs,
    one direction is random and the other direction is the normal or on the horizon.
    """
    mu_o, mu_i, azimuth = np.array(list(product(GRID, GRID, AZIMUTHS))).T
    free, other = directions(rng, EACH), directions(rng, EACH)
    high = _between(rng, EACH, HORIZON, 1.0)
    rim = directions_at(np.zeros(EACH), 2.0 * np.pi * rng.random(EACH))
    normal = np.broadcast_to([0.0, 0.0, 1.0], free.shape)
    grid, lit = directions_at(mu_o, 0.0 * mu_o), directions_at(mu_i, azimuth)
    mirrored, up = free * [-1.0, -1.0, 1.0], normal[:1]
    views = [grid, free, free, normal, free, up, rim, high, free]
    lights = [lit, free, mirrored, free, normal, up, high, rim, other]
    return np.concatenate(views), np.concatenate(lights)


def outside_directions(rng: Rng) -> tuple[Array, Array]:
    """Pairs outside the models' domain, with light from below the horizon or a cosine above 1."""
    below = directions(rng, EACH) * [1.0, 1.0, -1.0]
    high = _between(rng, EACH, HORIZON, 1.0)
    straight = np.broadcast_to([0.0, 0.0, ABOVE_ONE], below.shape)
    wo = np.concatenate([high, straight, directions(rng, EACH)])
    wi = np.concatenate([below, directions(rng, EACH), straight])
    return wo, wi


def turned_frames(rng: Rng, count: int) -> Array:
    """Up to `count` random frames with axes as columns. Normals point to middles of sky texels."""
    axes, _ = np.linalg.qr(rng.standard_normal((count, 3, 3)))
    axes = axes[np.abs(axes[:, 1, 2]) <= POLE]
    return aimed(axes, axes[:, :, 2], texel_middles(axes[:, :, 2]))


def aimed(axes: Array, of: Array, to: Array) -> Array:
    """Frames (N, 3, 3), rotated so that the unit vectors `of` become the unit vectors `to`, (N, 3).

    The smallest rotation from `of` to `to` is half a turn about the bisector, followed by half a
    turn about `to`.
    """
    for vectors in (of + to, to):
        about = vectors[:, :, np.newaxis]
        along = np.sum(about * axes, axis=1, keepdims=True)
        along = along / np.sum(about**2, axis=1, keepdims=True)
        axes = 2.0 * along * about - axes
    return axes


def turned_directions(rng: Rng, count: int) -> Array:
    return _between(rng, count, *TURNED)


def _between(rng: Rng, count: int, low: float, high: float) -> Array:
    return directions_at(low + (high - low) * rng.random(count), 2.0 * np.pi * rng.random(count))


def with_edges(rng: Rng, values: Array, edges: ArrayLike) -> Array:
    """Values rounded to float32. Random elements of `edges` replace about half of the values."""
    picked = rng.choice(np.asarray(edges, np.float64), np.shape(values))
    return float32(np.where(rng.random(np.shape(values)) < 0.5, picked, values))


def directions_at(mu: ArrayLike, azimuth: ArrayLike) -> Array:
    """Directions (..., 3) from cosines and azimuths. The cosines are first rounded to float32."""
    mu = float32(mu)
    radius = np.sqrt(1.0 - mu * mu)
    columns = radius * np.cos(azimuth), radius * np.sin(azimuth), mu
    return rounded(np.broadcast_arrays(*columns))


FRAMES = 1 << 12  # maximum number of pairs with individual frames
LEAN = 0.3  # largest slope of a tangent relative to the surface
SKY_ROWS = 128  # number of rows of the sky map, which has twice as many columns
SLOPE = 0.5  # derivative of a channel of the sky's irradiance along the channel's axis


def sky(normal: Array) -> Array:
    """Irradiance of the sky divided by pi, at normals (N, 3). Each channel grows along one axis."""
    return 0.5 + SLOPE * normal


@lru_cache(maxsize=1)
def sky_map() -> NDArray[np.float32]:
    """Latitude-longitude map of the sky's irradiance divided by pi, (SKY_ROWS, 2 SKY_ROWS, 3)."""
    directions, _ = textures.latlong_directions(SKY_ROWS, 2 * SKY_ROWS)
    return sky(directions @ base.TURN[:3, :3]).reshape(SKY_ROWS, 2 * SKY_ROWS, 3).astype(np.float32)


def texel_middles(near: Array) -> Array:
    """Directions to the middles of sky texels that contain the unit vectors `near`, both (N, 3).

    In the middle of a texel, every filter reads a single texel. The direction opposite to a middle
    is also the middle of a texel.
    """
    polar = np.arccos(np.clip(near[:, 1], -1.0, 1.0)) / np.pi
    azimuth = np.arctan2(near[:, 0], -near[:, 2]) / (2.0 * np.pi) + 0.5
    row = np.minimum((SKY_ROWS * polar).astype(int), SKY_ROWS - 1)
    column = (2 * SKY_ROWS * azimuth).astype(int) % (2 * SKY_ROWS)
    middles, _ = textures.latlong_directions(SKY_ROWS, 2 * SKY_ROWS)
    return np.asarray(middles[2 * SKY_ROWS * row + column])
