# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes on a host that tells closures: those of a host that evaluates, over the closures' values."""

from collections.abc import Sequence
from functools import cached_property
from typing import TypeVar, cast

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.nodes.surface_shaders import SurfaceShader
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.reference.closures import evaluated
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts
from mxeon.hosts.base import Host

P = TypeVar("P", bound=Probe)
# The closures are few, and their values are those of the models: more pairs would tell the models apart.
USUAL = Counts(1 << 12, 1 << 6, 1 << 8, albedos=16, materials=8, mirrored=1 << 8)
SOME = 1 << 8  # pairs of every kind but the random ones


class ClosureSamples(Probe):
    """What a probe of closures has in common: its host's values, and fewer samples."""

    def __init__(
        self, host: Host, subject: Subject, library: str, counts: Counts | None = None
    ) -> None:
        super().__init__(evaluated(host), subject, library, counts)

    @classmethod
    def kind_of(cls, subject: Subject) -> str:
        return kinds.closure_kind(super().kind_of(subject))

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The same pairs with weights of at least 0: OSL multiplies a closure by any number.

        Some dielectrics have the index 0, for which a shader may make another closure.
        """
        random, *others = map(_altered, super().batches)
        return (random, *(batch.first(SOME) for batch in others))

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Few of each, together where that is possible: a run takes its time however few they are."""
        groups: dict[tuple[str, ...], list[Batch]] = {}
        for batch in self.batches:
            few, names = batch.first(self.counts.few), tuple(sorted(batch.inputs))
            groups.setdefault((*names, str(batch.frame is None)), []).append(few)
        return tuple(map(_joined, groups.values()))

    @property
    def unset(self) -> tuple[str, ...]:
        """Frames of a surface shader's lobes: its text takes them from the surface, and has no input."""
        names = self.subject.inputs if isinstance(self.subject, SurfaceShader) else ()
        return tuple(each for each in names if each.endswith(("normal", "tangent")))

    @cached_property
    def turned(self) -> Batch:
        return super().turned.first(SOME)

    @cached_property
    def edges(self) -> Batch:
        edges = super().edges
        return edges.where(np.random.default_rng(SEED).permutation(len(edges.wo))[:SOME])


def closures_of(probe: type[P]) -> type[P]:
    """The class of the same probes on a host that tells closures."""
    usual = probe.usual if probe.usual.pairs < USUAL.pairs else USUAL
    return cast(
        type[P], type(f"Closure{probe.__name__}", (ClosureSamples, probe), {"usual": usual})
    )


def _joined(batches: Sequence[Batch]) -> Batch:
    """One batch of all pairs, whose inputs have the same names."""
    if len(batches) == 1:
        return batches[0]
    wo, wi = (np.concatenate(each) for each in ([b.wo for b in batches], [b.wi for b in batches]))
    inputs = {name: np.concatenate([_each(b, name) for b in batches]) for name in batches[0].inputs}
    frames = [batch.frame for batch in batches if batch.frame is not None]
    return Batch(wo, wi, inputs, frame=np.concatenate(frames) if frames else None)


def _each(batch: Batch, name: str) -> Array:
    """An input of each pair."""
    values = np.asarray(batch.inputs[name])
    constant = values.shape[:1] != (len(batch.wo),)
    return np.broadcast_to(values, (len(batch.wo), *values.shape)) if constant else values


def _altered(batch: Batch) -> Batch:
    changes: dict[str, Array] = {}
    if "weight" in batch.inputs:
        changes["weight"] = np.maximum(batch.inputs["weight"], 0.0)
    if {"tint", "ior"} <= batch.inputs.keys():
        index = _each(batch, "ior")
        changes["ior"] = np.where(np.arange(len(index)) % 7 == 3, 0.0, index)
    return batch.altered(**changes)
