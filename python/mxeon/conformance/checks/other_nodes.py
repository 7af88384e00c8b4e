# SPDX-License-Identifier: Apache-2.0
"""Checks of nodes that do not scatter light: emissive nodes, media, and utility nodes."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from mxeon.conformance import backends, controls
from mxeon.conformance.case import LIGHT, Case
from mxeon.conformance.check import Check, family
from mxeon.conformance.diagnosis import BACK, OUTPUT, TRANSMITTANCE, VALUE, defect
from mxeon.conformance.diagnosis.regions import EXACT, correct_except, span, unbounded
from mxeon.conformance.results import Diagnosis, Kind, Quantity
from mxeon.conformance.spec import Ability
from mxeon.conformance.specs import emission, utilities
from mxeon.conformance.tolerance import Compared, Measurement, count_not_finite, count_of

EMISSIONS, MEDIA = family(emission.EmissionSpec), family(emission.MediumSpec)


def diagnose_opacity(case: Case) -> Diagnosis:
    opaque = [
        each._replace(expected=case.expected(each.batch.altered(opacity=1.0)))
        for each in VALUE(case)
    ]
    wrong = any(emission.OPACITY.wrong(each).any() for each in opaque)
    return Diagnosis() if wrong else defect("input_ignored", "opacity")


def above(case: Case) -> Iterator[Compared]:
    for batch, branch in product(case.batches, LIGHT):
        yield Compared(batch, case.throughput(batch, branch), np.ones((1, 3)))


def between(case: Case) -> Iterator[Compared]:
    """Compare light through a medium with the transmittance times the light without the medium."""
    clear = {each.name: np.zeros(3) for each in case.spec.inputs if each.type == "vector3"}
    for batch in case.batches:
        lit = batch.altered(**{"bottom/weight": 1.0})
        without = case.evaluating.transmitted(lit.altered(**clear))
        yield Compared(batch, case.transmitted(lit), without * case.expected(batch))


# --- utility nodes; errors are in units that make their roundings uniform -------------------------


def outside(case: Case) -> Compared:
    batch = case.backend.take(case.of(utilities.UtilitySpec).outside)
    return Compared(batch, case.direct(batch), np.zeros((1, 3)))


def diagnose_finite(case: Case) -> Diagnosis:
    """Report the number of non-finite outputs, and an input range that causes such outputs."""
    compared = [unbounded(outside(case))]
    cause = correct_except(compared, EXACT, span(compared, EXACT))
    return Diagnosis((replace(cause, kind=Kind.NOT_FINITE),))


# fmt: off
ROWS = (
    Check(key="implemented", claim="The target implements the node.",
          applies=EMISSIONS | MEDIA | family(emission.AbsentSpec),
          measure=lambda case: Measurement(
              float(backends.implementation(case.host, case.spec.document(), case.library) is None), {}),
          tolerance=count_of(Quantity.NODES),
          control=controls.Control(
              "the node has no implementation", lambda case: case.another(emission.UNIMPLEMENTED)),
          explain=lambda case: defect("not_implemented", case.host.target, case.spec.title)),
    Check(key="radiance",
          claim="The radiance matches the node's equation for every view from the front.",
          applies=EMISSIONS, measure=OUTPUT, control=controls.gray),
    Check(key="back", claim="The back of the surface emits the radiance of the node's equation.",
          applies=EMISSIONS, measure=BACK, control=controls.offset, requires=Ability.PAIRS, open=True),
    Check(key="transmittance",
          claim="Over one meter, a medium transmits as its coefficients require.",
          applies=MEDIA, measure=TRANSMITTANCE, control=controls.shifted),
    Check(key="above",
          claim="A medium does not absorb light that is reflected above it.",
          applies=MEDIA, measure=above, tolerance="value",
          control=controls.Control(
              "a medium absorbs a tenth",
              lambda case: replace(case, throughputs=lambda batch, values: 0.9 * values)),
          explain=defect("medium_in_reflection"), requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="between",
          claim="A medium between two lobes attenuates the light that the lower lobe transmits.",
          applies=MEDIA, measure=between, tolerance="value",
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=defect("medium_between"), requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="opacity", claim="The light that a surface emits is scaled by its opacity.",
          applies=family(emission.EmittingSurface), measure=VALUE,
          control=controls.with_inputs("the opacity is 1", opacity=1.0), explain=diagnose_opacity),
    Check(key="output", claim="The output of the utility node matches its equations.",
          applies=family(utilities.UtilitySpec), measure=OUTPUT, control=controls.shifted, open=True),
    Check(key="output_finite",
          claim="Every output is finite, at the ends of the ranges and beyond.",
          applies=family(utilities.UtilitySpec, lambda spec: not spec.libraries),
          measure=lambda case: count_not_finite(outside(case)),
          tolerance=count_of(Quantity.VALUES), control=controls.no_number, explain=diagnose_finite,
          requires=Ability.PAIRS),
)
# fmt: on
