# SPDX-License-Identifier: Apache-2.0
"""What a case's values are compared with, by quantity, and what may explain a difference."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from weakref import WeakKeyDictionary

import numpy as np

from mxeon.conformance.case import LIGHT, Case, albedos, throughputs, values
from mxeon.conformance.diagnosis.candidates import Diagnosis, explain
from mxeon.conformance.diagnosis.faults import DIRECT_FAULTS, ENVIRONMENT_FAULTS, Fault
from mxeon.conformance.samples import Array, Batch, Candidate
from mxeon.conformance.specs.emission import EmissionSpec, MediumSpec
from mxeon.conformance.tolerance import Compared


@dataclass(frozen=True, eq=False)
class Comparison:
    """Values of a quantity against the ones expected."""

    quantity: str  # by whose error they are judged
    compared: Callable[[Case], Iterable[Compared]]
    candidates: Callable[[Case], Sequence[Candidate]]  # that may explain them, its own model first
    faults: Sequence[Fault] = ()  # of the way from the inputs to that model

    def __call__(self, case: Case) -> Iterable[Compared]:
        return self.compared(case)

    def diagnose(self, case: Case) -> Diagnosis:
        """The explanation of a case, made once: several checks of a node fail for one reason."""
        known = DIAGNOSES.setdefault(case, {})
        if self not in known:
            tolerance = case.tolerance(self.quantity, "value")
            compared = list(self.compared(case))
            candidates = self.candidates(case)
            known[self] = explain(case, compared, candidates, self.faults, tolerance, self.compared)
        return known[self]


# By case, which it does not keep alive: samples take some memory.
DIAGNOSES: WeakKeyDictionary[Case, dict[Comparison, Diagnosis]] = WeakKeyDictionary()


def _rests(case: Case) -> Sequence[Candidate]:
    """Functions that may explain throughputs: what each albedo leaves, or all light."""
    *own, nothing = case.albedo_candidates
    named = [*own, replace(nothing, title="all light passes", permitted=False)]
    return [replace(each, values=partial(_rest, each)) for each in named]


def _rest(candidate: Candidate, batch: Batch) -> Array:
    return np.maximum(1.0 - candidate.values(batch), 0.0)


def _backs(case: Case) -> Iterator[Compared]:
    """Radiance towards views from the back."""
    batch = case.samples.take(case.of(EmissionSpec).backs)
    yield Compared(batch, case.direct(batch), case.expected(batch))


def _transmittances(case: Case) -> Iterator[Compared]:
    """Light through a medium and the throughput of a surface over it, against its transmittance."""
    spec, evaluate = case.of(MediumSpec), case.evaluating.evaluate
    [batch] = case.batches
    expected = case.expected(batch)
    yield Compared(batch, case.direct(batch), expected)
    lit = batch.altered(**{"top/weight": 1.0})
    coefficients = (each for each in spec.names if np.shape(batch.inputs[each])[1:])
    clear = lit.altered(**dict.fromkeys(coefficients, (0.0, 0.0, 0.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        through = evaluate(lit, "transmission") / evaluate(clear, "transmission")
    yield Compared(batch, through, expected)


VALUE = Comparison("value", values, attrgetter("value_candidates"), DIRECT_FAULTS)
ALBEDO = Comparison("albedo", albedos, attrgetter("albedo_candidates"), ENVIRONMENT_FAULTS)
# Of a layer, for light from above, and for light through the base.
THROUGHPUT = Comparison("throughput", lambda case: throughputs(case, *LIGHT), _rests)
TRANSMISSION = Comparison("throughput", lambda case: throughputs(case, "transmission"), _rests)
RADIANCE = Comparison(
    "value", values, attrgetter("value_candidates")
)  # of an emission from the front
BACK = Comparison("value", _backs, attrgetter("value_candidates"))
TRANSMITTANCE = Comparison("value", _transmittances, attrgetter("value_candidates"))
