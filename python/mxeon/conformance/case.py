# SPDX-License-Identifier: Apache-2.0
"""A case evaluates a node of a library on an engine, for comparison with expected values.

A negative control is a case with deliberately wrong inputs or outputs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from typing import TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance import backends, cache, results
from mxeon.conformance.samples import Array, Batch, Candidate, Changes
from mxeon.conformance.spec import LobeSpec, Spec, ValueSpec
from mxeon.conformance.specs import lobes, microfacets
from mxeon.conformance.tolerance import ROUNDING, Compared, Tolerance
from mxeon.hosts.base import Engine, Host

F = TypeVar("F", bound=Spec)
Change = Callable[[Batch, Array], Array]  # changes the values of a batch
# Engines may compile two documents differently, so values that should be equal may differ by
# rounding errors.
ROUNDED = 64 * ROUNDING


@lru_cache(maxsize=6)  # three quantities of two specs: a case's spec and a related spec
def model_values(spec: Spec, quantity: str) -> Callable[[Batch], Array]:
    """The model's function for a quantity, with a cache of values."""
    return cache.remembered(getattr(spec, quantity))


@lru_cache(maxsize=4)  # albedo and throughput of a case's spec and of a related spec
def candidates(spec: Spec, quantity: str) -> tuple[Candidate, ...]:
    """Functions that may explain the albedo or the throughput, with caches of their values."""
    functions: tuple[Candidate, ...] = getattr(spec, f"{quantity}_candidates")
    return tuple(replace(each, values=cache.remembered(each.values)) for each in functions)


@dataclass(frozen=True, eq=False)
class Case:
    """A node on a backend. Controls and diagnoses change some of the fields."""

    spec: Spec
    backend: backends.Backend
    # Mistakes that a negative control makes in inputs, in values, and in throughputs of layers.
    inputs: Callable[[Batch], Batch] = lambda batch: batch
    outputs: Change = lambda batch, values: values
    throughputs: Change = lambda batch, values: values
    control: bool = False  # whether the case is a negative control, which needs few samples
    chosen: tuple[Batch, ...] = ()  # batches that replace the samples in a diagnosis
    explained: dict[object, results.Diagnosis] = field(default_factory=dict, init=False)  # cache

    @property
    def host(self) -> Host:
        return self.backend.host

    @property
    def library(self) -> str:
        return self.backend.library

    def of(self, family: type[F]) -> F:
        """The spec, cast to the family of specs that a check applies to."""
        assert isinstance(self.spec, family), f"{self.spec.title} is not a {family.__name__}"
        return self.spec

    @property
    def opaque(self) -> bool:
        """Whether the engine uses opacity for transmission, without an environment lookup."""
        return self.host.active.transmission == "opacity"

    @property
    def lobe(self) -> LobeSpec:
        return self.of(LobeSpec)

    @property
    def valued(self) -> ValueSpec:
        return self.of(ValueSpec)

    def another(self, spec: Spec) -> Case:
        return make_case(type(self.backend), self.host, spec, self.library)

    @property
    def batches(self) -> tuple[Batch, ...]:
        return self.chosen or (self.backend.few if self.control else self.backend.batches)

    @property
    def few(self) -> tuple[Batch, ...]:
        return self.chosen or self.backend.few

    @property
    def views(self) -> tuple[Batch, ...]:
        return self.chosen or self.backend.views[: 1 if self.control else None]

    def direct(self, batch: Batch) -> Array:
        return self.measured(self.backend.direct, batch)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        return self.outputs(batch, self.backend.albedo(self.inputs(batch), irradiance))

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        return self.outputs(batch, self.evaluating.transmitted(self.inputs(batch), radiance))

    def throughput(self, batch: Batch, branch: str) -> Array:
        return self.throughputs(batch, self.evaluating.throughput(self.inputs(batch), branch))

    def measured(self, evaluate: Callable[[Batch], Array], batch: Batch) -> Array:
        return self.outputs(batch, evaluate(self.inputs(batch)))

    def compared(self, batch: Batch) -> Compared:
        """Measured and expected values in direct light."""
        return Compared(batch, self.direct(batch), self.expected(batch))

    @property
    def evaluating(self) -> backends.Evaluating:
        assert isinstance(self.backend, backends.Evaluating), f"{self.host.name} evaluates no pairs"
        return self.backend

    def expected(self, batch: Batch) -> Array:
        return model_values(self.valued, "value")(batch)

    def expected_albedo(self, batch: Batch) -> Array:
        return model_values(self.lobe, "albedo")(batch)

    def expected_throughput(self, batch: Batch) -> Array:
        return model_values(self.of(lobes.ScatteringSpec), "throughput")(batch)

    @property
    def changes(self) -> Mapping[str, Changes]:
        """For each input that can be set, all inputs before and after a change of that input."""
        changes, unset = self.spec.changes, self.backend.unset
        return {name: changes[name] for name in changes if name not in unset}

    def candidates(self, quantity: str) -> tuple[Candidate, ...]:
        return candidates(self.spec, quantity)

    def tolerance(self, *quantities: str) -> Tolerance:
        """The first of the quantities' tolerances that exists, plus the engine's errors."""
        errors = self.backend.errors(self.spec)
        for quantity in quantities:
            if error := errors.get(quantity):
                return error.plus(*self.backend.precision(quantity))
        raise LookupError(f"{self.spec.title} has no {quantities[-1]}")


def make_case(backend: type[backends.Backend], host: Engine, spec: Spec, library: str) -> Case:
    spec = spec.within(library)
    made = backend(cast(Host, host), spec, library)
    if (judged := made.judged()) is not spec:
        made = backend(cast(Host, host), judged, library)
    return Case(made.spec, made)


SCATTERING = ("direct", "environment", "transmission")  # kinds of scattered light
BRANCHES = (*SCATTERING, "emission")
LIGHT = ("direct", "environment")  # kinds of light from above


def values(case: Case) -> Iterator[Compared]:
    return map(case.compared, case.batches)


def albedos(case: Case) -> Iterator[Compared]:
    """Values in an environment, compared with the albedo or with MaterialX's fit of the albedo."""
    spec, fitted = case.spec, case.backend.prefiltered
    for batch in case.views:
        if fitted and isinstance(spec, microfacets.FacetSpec):
            expected = spec.prefiltered(batch)
        else:
            expected = case.expected_albedo(batch)
        yield Compared(batch, case.albedo(batch), expected)


def throughputs(case: Case, *branches: str) -> Iterator[Compared]:
    """Throughputs of a layer for given kinds of light. The expected throughput is 1 - albedo."""
    for branch, batch in product(branches, case.views):
        yield Compared(batch, case.throughput(batch, branch), case.expected_throughput(batch))


def frames(case: Case) -> Iterator[Compared]:
    """Values in rotated frames, compared with values in unrotated frames."""
    turned = case.backend.turned
    # Use a fifth of the pairs, because sums over the environment are slow.
    subset = turned.where(slice(None, None, 5))
    outputs = [(case.direct, turned), (case.albedo, subset)]
    for each in case.spec.inputs:
        if each.type == "boolean" and each.name in case.changes.keys() - case.spec.fixed.keys():
            outputs.append((case.direct, subset.altered(**{each.name: True})))
    for output, batch in outputs:
        local = replace(batch.altered(normal=(0.0, 0.0, 1.0), tangent=(1.0, 0.0, 0.0)), frame=None)
        yield Compared(batch, output(batch), output(local))


def dead_inputs(
    case: Case, batch: Batch | None = None, evaluate: Callable[[Batch], Array] | None = None
) -> list[str]:
    """Names of inputs that do not affect the values of `evaluate`, by default `case.direct`."""
    batch, evaluate = batch or case.few[0], evaluate or case.direct
    original = evaluate(batch)  # values of the unchanged batch
    dead = []
    for name, (before, after) in case.changes.items():
        values = evaluate(batch.altered(**before)) if before else original
        if unchanged(values, evaluate(batch.altered(**after))).all():
            dead.append(name)
    return dead


def unchanged(before: Array, after: Array) -> NDArray[np.bool_]:
    return np.isclose(before, after, rtol=ROUNDED, atol=ROUNDED, equal_nan=True)


def edge_values(case: Case) -> Compared:
    """Values and albedos, which must be finite, at the edges of the domain."""
    batch = case.backend.edges
    values = np.concatenate([case.direct(batch), case.albedo(batch)], axis=1)
    return Compared(batch, values, np.zeros_like(values))
