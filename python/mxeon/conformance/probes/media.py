# SPDX-License-Identifier: Apache-2.0
"""Probe of the VDF nodes: what a surface over a medium lets through."""

from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes.media import MediumSubject
from mxeon.conformance.probes.emission import NodeProbe
from mxeon.conformance.probes.probe import ValueProbe
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts, directions


class MediumProbe(NodeProbe, ValueProbe):
    """A VDF node on a host that evaluates what a surface over it lets through."""

    usual: ClassVar[Counts] = Counts(1 << 8)

    subject: MediumSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random views, and random inputs of the node."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        wo = directions(rng, count)
        inputs = self.subject.random_inputs(rng, count)
        return (Batch(wo, wo * [1.0, 1.0, -1.0], inputs),)

    def direct(self, batch: Batch) -> Array:
        """Share of the light from below that passes a surface without weight, (N, 3)."""
        return self._evaluate(batch.altered(**{"top/weight": 0.0}), "throughput")

    @cached_property
    def through(self) -> Array:
        (batch,) = self.batches
        coefficients = (each for each in self.subject.inputs if np.shape(batch.inputs[each])[1:])
        clear = batch.altered(**dict.fromkeys(coefficients, (0.0, 0.0, 0.0)))
        with np.errstate(divide="ignore", invalid="ignore"):
            return self._evaluate(batch, "response") / self._evaluate(clear, "response")

    def _evaluate(self, batch: Batch, output: str) -> Array:
        evaluate = self.host.evaluate
        values = evaluate(
            self.shader, batch.wo, batch.wi, batch.inputs, "transmission", output=output
        )
        return np.asarray(values, np.float64)
