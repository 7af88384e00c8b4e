# SPDX-License-Identifier: Apache-2.0
"""Probes: values and albedos of one node on a host, over batches of pairs.

A host that evaluates takes any pairs, a host that only makes pictures takes the points of a sphere;
both answer in the same form, so a check is written once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes.subject import DrawnSubject
from mxeon.conformance.probes.memory import Evaluations
from mxeon.conformance.probes.probe import LobeProbe
from mxeon.conformance.samples.batch import SEED, Array, Batch, directions, rounded
from mxeon.conformance.samples.edge_cases import (
    diffuse_edges,
    node_inputs,
    outside_directions,
    special_directions,
    turned_directions,
    turned_frames,
)

if TYPE_CHECKING:
    from mxeon.shaders.generation import Shader

FRAMES = 1 << 12  # pairs in frames of their own
LEAN = 0.3  # slope of their tangents

Draw: TypeAlias = Callable[[np.random.Generator, int], dict[str, Array]]


class PairProbe(LobeProbe):
    """A node on a host that evaluates any pairs."""

    subject: DrawnSubject

    @cached_property
    def _shader(self) -> Shader:
        return self.host.compile(self.subject.document(), library=self.library)[0]

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs, a quarter of each direction grazing; special ones; and outside ones."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        pairs = directions(rng, count), directions(rng, count)
        return (
            self._batch(rng, self._lit(pairs), self.subject.random_inputs),
            self._batch(rng, self._lit(special_directions(rng)), self.subject.special_inputs),
            self._batch(rng, self._lit(outside_directions(rng)), self.subject.random_inputs),
        )

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Few of the random pairs, and the special ones; none of them is outside."""
        pairs, special, *_ = self.batches
        return pairs.first(self.counts.few), special

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """Directions for the environment branch, which does not depend on `wi`."""
        return (*self.few, self.batches[-1])

    @property
    def edges(self) -> Batch:
        return diffuse_edges()

    @cached_property
    def turned(self) -> Batch:
        """FRAMES pairs in frames of their own.

        Half of the normals face away from the viewer. Tangents lean out of the surface by up to LEAN,
        as those of a geometry do where a picture turns the normal.
        """
        rng = np.random.default_rng(SEED)
        frames = turned_frames(rng, FRAMES)
        count = len(frames)
        wo, wi = turned_directions(rng, count), turned_directions(rng, count)
        facing = np.where(np.arange(count) % 2, 1.0, -1.0)[:, np.newaxis]
        normal = facing * rounded(frames[:, :, 2].T)
        lean = LEAN * np.linspace(-1.0, 1.0, count)[:, np.newaxis]
        tangent = frames[:, :, 0] + lean * frames[:, :, 2]
        axes = {"normal": normal, "tangent": rounded(tangent.T)}
        inputs = {**self.subject.random_inputs(rng, count), **axes}
        return Batch(wo, wi, inputs, frame=frames)

    def direct(self, batch: Batch) -> Array:
        return np.pi * self._evaluate(batch, "direct")

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        return self._evaluate(batch, "environment", irradiance=irradiance)

    def throughput(self, batch: Batch, branch: str) -> Array:
        return self._evaluate(batch, branch, output="throughput")

    def _lit(self, pairs: tuple[Array, Array]) -> tuple[Array, Array]:
        """Pairs with the light on the side from which the node scatters it."""
        return pairs

    def _batch(self, rng: np.random.Generator, pairs: tuple[Array, Array], inputs: Draw) -> Batch:
        """Pairs with random inputs, weights and occlusions."""
        wo, wi = pairs
        return Batch(wo, wi, {**inputs(rng, len(wo)), **node_inputs(rng, len(wo))})

    def _evaluate(
        self,
        batch: Batch,
        branch: str,
        output: str = "response",
        irradiance: NDArray[np.float32] | None = None,
    ) -> Array:
        def evaluate() -> Array:
            inputs = self.subject.with_flag(batch.inputs)
            wo, wi = batch.world(batch.wo), batch.world(batch.wi)
            values = self.host.evaluate(
                self._shader, wo, wi, inputs, branch, output=output, irradiance=irradiance
            )
            return values.astype(np.float64)

        return self._evaluations.values(batch, (branch, output, irradiance), evaluate)

    @cached_property
    def _evaluations(self) -> Evaluations:
        return Evaluations()
