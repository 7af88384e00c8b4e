# SPDX-License-Identifier: Apache-2.0
"""Batches of pairs of directions with the inputs of a node, and random ones."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.models import table as reference
from mxeon.models.table import Model
from mxeon.shaders.scene import Scene

SEED = 1
PAIRS = 1 << 16
FEW = 1 << 14  # pairs of the checks that do not ask for all
GRAZING = 1e-6  # smallest cosine of the random pairs
RIM = 0.05  # smallest cosine judged in a picture: nearer to the rim a pixel's place is uncertain
LOBE_RIM = 0.25  # of a lobe below others

Array = NDArray[np.float64]
Values: TypeAlias = Mapping[str, ArrayLike]  # of a node's inputs, by name
Changes: TypeAlias = tuple[Values, Values]  # inputs before and after a change of one of them


@dataclass(frozen=True)
class Counts:
    """How many samples a probe draws."""

    pairs: int = PAIRS  # random pairs, and those of them for what takes long
    few: int = FEW
    diagnosed: int = FEW  # pairs of each batch that a diagnosis looks at
    albedos: int = 1 << 7  # views whose albedo is asked
    # Materials whose values are integrated or averaged, and nodes of a quadrature on each axis.
    materials: int = 64
    nodes: int = 48
    mirrored: int = 1 << 11  # views with lights near the mirror direction


@dataclass(frozen=True)
class Batch:
    """Pairs of directions and the node's inputs for them."""

    # Local frame; float32 numbers, so that a float32 host sees the same pairs. `wo` is on or above
    # the horizon.
    wo: Array
    wi: Array
    # Node inputs and "occlusion", (N, ...) or constant. The normal is in world space.
    inputs: Mapping[str, Any]  # array_like, which NumPy types so that nobody can compute with it
    scene: Scene | None = None  # the picture whose points these are
    # World axes of the local frames, as columns; None where they are the same.
    frame: Array | None = None

    def altered(self, **inputs: ArrayLike) -> "Batch":
        return replace(self, inputs={**self.inputs, **inputs})

    def first(self, count: int) -> "Batch":
        return self.where(slice(count))

    def where(self, rows: slice | NDArray[np.bool_] | NDArray[np.integer]) -> "Batch":
        """Some pairs of the batch: a slice, a mask or indices of them."""
        count = len(self.wo)
        inputs = {
            name: values[rows] if np.shape(values)[:1] == (count,) else values
            for name, values in self.inputs.items()
        }
        frame = None if self.frame is None else self.frame[rows]
        return replace(self, wo=self.wo[rows], wi=self.wi[rows], inputs=inputs, frame=frame)

    def world(self, local: Array) -> Array:
        """Local directions (N, 3) in world space, as float32 numbers."""
        if self.frame is None:
            return local
        return rounded((self.frame @ local[:, :, np.newaxis])[:, :, 0].T)

    @property
    def normal(self) -> Array:
        """Normals on the viewer's side, in world space, (N, 3)."""
        return self.world(np.broadcast_to([0.0, 0.0, 1.0], self.wo.shape))

    @property
    def strength(self) -> Array:
        """Factor of an albedo, (N, 1) or (1, 1): the weight; a negative one counts as 0."""
        return np.maximum(np.reshape(self.inputs.get("weight", 1.0), (-1, 1)), 0.0)

    @property
    def rough(self) -> Array:
        """Roughness of each pair, the larger of two; 0 where there is none, (N,)."""
        roughness = np.asarray(self.inputs.get("roughness", 0.0), np.float64)
        if roughness.shape[-1:] == (2,):
            roughness = roughness.max(axis=-1)
        return np.broadcast_to(roughness, len(self.wo))

    def expected(self, model: str) -> Array:
        """pi f cos(theta_i) of a model or a known defect with weight and occlusion, (N, 3).

        It is 0 for light from below the horizon.
        """
        row = reference.model(model)
        parameter = [self.inputs["roughness"]] if row.parameter else []
        above = self.wi * np.where(self.wi[:, 2:] < 0.0, [1.0, 1.0, -1.0], 1.0)
        value: Array = row.brdf(self.wo, above, self.inputs["color"], *parameter)
        occlusion = np.reshape(self.inputs.get("occlusion", 1.0), (-1, 1))
        return np.pi * value * np.clip(self.wi[:, 2:], 0.0, 1.0) * (self.strength * occlusion)

    def albedo(self, model: str) -> Array:
        """Directional albedo of a model or a known defect with weight, (N, 3)."""
        row = reference.model(model)
        parameter = [self.inputs["roughness"]] if row.parameter else []
        mu = np.minimum(self.wo[:, 2], 1.0)
        return self.strength * row.closed_albedo_dir(mu, self.inputs["color"], *parameter)


@dataclass(frozen=True)
class Candidate:
    """A function that may explain some values."""

    title: str
    values: Callable[[Batch], Array]
    permitted: bool = False  # whether the specification leaves it open


def directions(rng: np.random.Generator, count: int) -> Array:
    """Random directions: cosines uniform, a quarter of them log-uniform down to GRAZING."""
    mu = rng.random(count)
    mu[: count // 4] = GRAZING ** rng.random(count // 4)
    rng.shuffle(mu)
    mu = float32(mu)
    radius, azimuth = np.sqrt(1.0 - mu * mu), 2.0 * np.pi * rng.random(count)
    return rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])


def random_inputs(rng: np.random.Generator, count: int, row: Model) -> dict[str, Array]:
    """Random colors and roughnesses; a tenth of each lies on either end of its range.

    The last colors are gray.
    """
    color, roughness = rng.random((count, 3)), rng.random(count)
    color = np.clip(1.25 * color - 0.125, 0.0, 1.0)
    color[-(count // 16) :] = color[-(count // 16) :, :1]
    roughness = row.largest * np.clip(1.25 * roughness - 0.125, 0.0, 1.0)
    return {"color": rounded(color.T), "roughness": rounded_roughness(roughness, row)}


def rounded_roughness(roughness: Array, row: Model) -> Array:
    """Roughnesses as float32 numbers, none of which exceeds the model's largest by a rounding."""
    largest = np.float32(row.largest)
    if float(largest) > row.largest:
        largest = np.nextafter(largest, np.float32(0.0))
    return np.minimum(roughness.astype(np.float32), largest).astype(np.float64)


def float32(values: ArrayLike) -> Array:
    """Values rounded to float32, in float64."""
    return np.asarray(values, np.float32).astype(np.float64)


def rounded(columns: Iterable[Array]) -> Array:
    """Columns as rows of float32 numbers in float64."""
    return float32(np.stack(list(columns), axis=-1))


class FilmViews(NamedTuple):
    """Views of lobes under thin films, in mirrored lights, each for one term."""

    # Rough lobes under films of few fringes, of which masking takes the facets whose curve is
    # another.
    steep: Batch
    fringed: Batch  # the same under films of up to many fringes
    # Lobes whose visible facets are much alike, so that few cosines stand for them, under films of
    # few fringes.
    glossy: Batch
    ordered: Batch  # smooth lobes at grazing under films so thin that all orders count
    # Smooth lobes, in which a film's curve is seen at one cosine, under films whose first orders
    # count.
    sharp: Batch
