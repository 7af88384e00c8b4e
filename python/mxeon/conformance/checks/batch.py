# SPDX-License-Identifier: Apache-2.0
"""Batches of pairs of directions with the inputs of a node, and random ones."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mxeon.models import table as reference
from mxeon.models.table import Model
from mxeon.shaders.scene import Scene

SEED = 1
PAIRS = 1 << 20
FEW = 1 << 16  # pairs of the checks that do not ask for a million
GRAZING = 1e-6  # smallest cosine of the random pairs
RIM = 0.05  # smallest cosine judged in a picture: nearer to the rim a pixel's place is uncertain
LOBE_RIM = 0.25  # of a lobe below others

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Batch:
    """Pairs of directions and the node's inputs for them.

    Attributes
    ----------
    wo, wi : ndarray, shape (N, 3)
        Local frame; float32 numbers, so that a float32 host sees the same pairs.
    inputs : mapping of str to array
        Node inputs, (N, ...) or constant.
    scene : Scene or None
        The picture whose points these are.
    """

    wo: Array
    wi: Array
    inputs: Mapping[str, Any]
    scene: Scene | None = None

    def altered(self, **inputs: Any) -> "Batch":
        """The same pairs with other inputs."""
        return replace(self, inputs={**self.inputs, **inputs})

    def first(self, count: int) -> "Batch":
        """The first pairs of the batch."""
        inputs = {name: values[:count] for name, values in self.inputs.items()}
        return replace(self, wo=self.wo[:count], wi=self.wi[:count], inputs=inputs)

    def expected(self, model: str) -> Array:
        """pi f cos(theta_i) of a model or a known defect, (N, 3)."""
        row = reference.model(model)
        parameter = [self.inputs["roughness"]] if row.parameter else []
        value: Array = row.brdf(self.wo, self.wi, self.inputs["color"], *parameter)
        return np.pi * value * self.wi[..., 2:]


def directions(rng: np.random.Generator, count: int) -> Array:
    """Random directions: cosines uniform, a quarter of them log-uniform down to GRAZING."""
    mu = rng.random(count)
    mu[: count // 4] = GRAZING ** rng.random(count // 4)
    rng.shuffle(mu)
    mu = mu.astype(np.float32).astype(np.float64)
    radius, azimuth = np.sqrt(1.0 - mu * mu), 2.0 * np.pi * rng.random(count)
    return _float32([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])


def random_inputs(rng: np.random.Generator, count: int, row: Model) -> dict[str, Array]:
    """Random colors and roughnesses; an eighth of each lies on either end of its range."""
    color, roughness = rng.random((count, 3)), rng.random(count)
    color = np.clip(1.25 * color - 0.125, 0.0, 1.0)
    roughness = row.largest * np.clip(1.25 * roughness - 0.125, 0.0, 1.0)
    roughness = np.minimum(roughness.astype(np.float32), np.nextafter(np.float32(row.largest), 0))
    return {"color": _float32(color.T), "roughness": roughness.astype(np.float64)}


def _float32(columns: Iterable[Array]) -> Array:
    """Columns as rows of float32 numbers in float64."""
    return np.stack(list(columns), axis=-1).astype(np.float32).astype(np.float64)
