# SPDX-License-Identifier: Apache-2.0
"""Probes of the utility nodes: their outputs for many inputs at once."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.utilities import UtilitySubject
from mxeon.conformance.probes.probe import ValueProbe
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts
from mxeon.hosts.calls import GRAPH
from mxeon.shaders.generation import Shader


class UtilityProbe(ValueProbe):
    """An output of a utility node on a host that evaluates a shader's graph."""

    usual: ClassVar[Counts] = Counts(1 << 12, 1 << 9, 1 << 9)

    subject: UtilitySubject

    @cached_property
    def _shader(self) -> Shader:
        return self.host.compile(self.subject.document(), library=self.library)[0]

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        return (
            _batch(self.subject.random_inputs(rng, count)),
            _batch(self.subject.special_inputs(rng, count)),
        )

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        return tuple(batch.first(self.counts.few) for batch in self.batches)

    @property
    def edges(self) -> Batch:
        rng = np.random.default_rng(SEED)
        return _batch(self.subject.outside_inputs(rng, self.counts.pairs))

    def direct(self, batch: Batch) -> Array:
        values = self.host.evaluate(self._shader, batch.wo, batch.wi, batch.inputs, GRAPH)
        return values.astype(np.float64)

    def other(self, output: str) -> "UtilityProbe":
        return self.of(replace(self.subject, output=output))


class UtilityOslProbe(UtilityProbe):
    """An output of a utility node on a renderer with OSL, which has mathematics of its own."""

    shown: ClassVar[str] = kinds.UTILITY_OSL

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        batches = super().batches
        names = batches[0].inputs
        together = {name: np.concatenate([each.inputs[name] for each in batches]) for name in names}
        return (_batch(together),)

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        return self.batches


def _batch(inputs: Mapping[str, Array]) -> Batch:
    """A batch of inputs, whose directions mean nothing."""
    count = len(next(iter(inputs.values())))
    up = np.broadcast_to([0.0, 0.0, 1.0], (count, 3))
    return Batch(up, up, inputs)
