# SPDX-License-Identifier: Apache-2.0
"""Checks of the utility nodes, in units in which the roundings of their values are alike."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from mxeon.conformance import diagnosis
from mxeon.conformance.case import Case
from mxeon.conformance.check import check, drop_changes, no_number, of_family, shifted
from mxeon.conformance.checks.lobes import inputs
from mxeon.conformance.diagnosis import Diagnosis, explain
from mxeon.conformance.diagnosis.regions import span
from mxeon.conformance.samples import Array, Batch, Candidate
from mxeon.conformance.specs.utilities import ROUND_TRIPS, UtilitySpec
from mxeon.conformance.tolerance import (
    Compared,
    Measurement,
    count_not_finite,
    count_of,
)

is_utility = of_family(UtilitySpec)


def explained(case: Case) -> Diagnosis:
    """The explanation of a case's outputs."""
    unit, tolerance = case.of(UtilitySpec).unit, case.tolerance("value")

    def in_unit(candidate: Candidate) -> Candidate:
        def values(batch: Batch) -> Array:
            return np.asarray(unit(candidate.values(batch), batch))

        return replace(candidate, values=values)

    candidates = list(map(in_unit, case.value_candidates))
    return explain(case, list(output(case)), candidates, (), tolerance, output)


@check(is_utility, shifted, "value", open=True, diagnose=explained)
def output(case: Case) -> Iterator[Compared]:
    """The output of the utility node matches its equations."""
    unit = case.of(UtilitySpec).unit
    for batch in case.batches:
        measured, expected = case.direct(batch), case.expected(batch)
        yield Compared(batch, unit(measured, batch), unit(expected, batch))


@check(lambda spec: "round_trip" in spec.errors, shifted, diagnose=explained)
def round_trip(case: Case) -> Iterator[Compared]:
    """The outputs lead back to the reflectivity or the albedo that they were computed from."""
    spec = case.of(UtilitySpec)
    others = {
        name: case.another(replace(spec, output=name))
        for name in spec.row.outputs
        if name != spec.output
    }
    for batch in case.batches:
        outputs = {name: each.direct(batch) for name, each in {spec.output: case, **others}.items()}
        yield Compared(batch, *ROUND_TRIPS[spec.node](outputs, batch))


@check(
    is_utility,
    drop_changes,
    tolerance=count_of("inputs"),
    diagnose=diagnosis.diagnose_inputs,
)
def output_inputs(case: Case) -> Measurement:
    """Every input of the utility node changes the outputs that depend on it."""
    return inputs(case)


def explained_finite(case: Case) -> Diagnosis:
    """How many outputs are not finite, and the range of an input that has all of them."""
    batch = case.samples.take(case.of(UtilitySpec).outside)
    values = case.direct(batch)
    finite, none = np.isfinite(values), np.zeros_like(values)
    if finite.all():
        return Diagnosis()
    compared = Compared(batch, np.where(finite, 0.0, np.nan), none)
    place = span([compared], count_of("values"))
    share = f"{int((~finite).any(axis=1).sum())} of {len(values)} outputs are not finite"
    return Diagnosis(f"{share}, all {place}" if place else share)


@check(
    lambda spec: is_utility(spec) and not spec.libraries,
    no_number,
    tolerance=count_of("values"),
    pairs=True,
    diagnose=explained_finite,
)
def output_finite(case: Case) -> Measurement:
    """Every output is finite, at the ends of the ranges and beyond."""
    batch = case.samples.take(case.of(UtilitySpec).outside)
    return count_not_finite(batch, case.direct(batch))
