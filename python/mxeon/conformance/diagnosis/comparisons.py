# SPDX-License-Identifier: Apache-2.0
"""What a probe's values are compared with, by quantity, and what may explain a difference: one row each."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from weakref import WeakKeyDictionary

import numpy as np

from mxeon.conformance.accuracy.accuracy import ACCURACY, Quantity
from mxeon.conformance.accuracy.engine import widen_for_engine
from mxeon.conformance.diagnosis.candidates import Diagnosis, explain
from mxeon.conformance.diagnosis.faults import DIRECT_FAULTS, ENVIRONMENT_FAULTS, Fault
from mxeon.conformance.probes.cases import (
    albedo_cases,
    back_cases,
    layering_cases,
    transmission_cases,
    transmittance_cases,
    value_cases,
)
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch, Candidate
from mxeon.conformance.samples.measurement import Case
from mxeon.conformance.samples.tolerance import Tolerance


@dataclass(frozen=True, eq=False)
class Comparison:
    """Values of a quantity against the ones expected.

    Attributes
    ----------
    quantity : Quantity
        By whose accuracy they are judged.
    cases : callable (probe) -> iterable of Case
        Measured and expected values.
    candidates : callable (probe) -> sequence of Candidate
        Functions that may explain them, its own model first.
    faults : sequence of Fault
        Of the way from the inputs to that model.
    """

    quantity: Quantity
    cases: Callable[[Probe], Iterable[Case]]
    candidates: Callable[[Probe], Sequence[Candidate]]
    faults: Sequence[Fault] = ()

    def __call__(self, probe: Probe) -> Iterable[Case]:
        """Its cases, as a check measures them."""
        return self.cases(probe)

    def diagnose(self, probe: Probe) -> Diagnosis:
        """The explanation of a probe's values, made once: several checks of a subject fail for one reason."""
        known = DIAGNOSES.setdefault(probe, {})
        if self not in known:
            cases = list(self.cases(probe))
            candidates, tolerance = self.candidates(probe), self.tolerance(probe)
            known[self] = explain(probe, cases, candidates, self.faults, tolerance)
        return known[self]

    def tolerance(self, probe: Probe) -> Tolerance:
        """The tolerance of a probe, a value's with the errors of the engine; a value's where there is no other."""
        accuracy = ACCURACY[probe.kind]
        tolerance = accuracy.of(self.quantity) or accuracy.value
        assert tolerance is not None, f"nothing is asked of {probe.kind}"
        if tolerance is accuracy.value:
            return widen_for_engine(tolerance, probe.subject, probe.kind, probe.host)
        return tolerance


# By probes, which are not kept alive by it: their samples take some memory.
DIAGNOSES: WeakKeyDictionary[Probe, dict[Comparison, Diagnosis]] = WeakKeyDictionary()


def _values(probe: Probe) -> Sequence[Candidate]:
    return probe.value_candidates


def _albedos(probe: Probe) -> Sequence[Candidate]:
    return probe.albedo_candidates


def _rests(probe: Probe) -> Sequence[Candidate]:
    """Functions that may explain throughputs: what each albedo leaves, or all light."""
    *albedos, nothing = probe.albedo_candidates
    rests = (Candidate(each.title, partial(_rest, each), each.permitted) for each in albedos)
    return (*rests, Candidate("all light passes", partial(_rest, nothing)))


def _rest(candidate: Candidate, batch: Batch) -> Array:
    """The light that a candidate's albedo leaves."""
    return np.maximum(1.0 - candidate.values(batch), 0.0)


VALUE = Comparison("value", value_cases, _values, DIRECT_FAULTS)
ALBEDO = Comparison("albedo", albedo_cases, _albedos, ENVIRONMENT_FAULTS)
THROUGHPUT = Comparison("throughput", layering_cases, _rests)  # of a layer, for light from above
TRANSMISSION = Comparison("throughput", transmission_cases, _rests)  # for light through the base
RADIANCE = Comparison("value", value_cases, _values)  # of an emission from the front
BACK = Comparison("value", back_cases, _values)  # of an emission from the back
TRANSMITTANCE = Comparison("value", transmittance_cases, _values)  # of a medium
