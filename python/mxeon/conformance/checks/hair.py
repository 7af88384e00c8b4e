# SPDX-License-Identifier: Apache-2.0
"""Checks of the hair node alone: its lobes apart, where they are wide, narrow, or seen straight."""

from dataclasses import replace
from functools import partial

from mxeon.conformance.case import Case, over_condition
from mxeon.conformance.check import check, of_family, with_inputs
from mxeon.conformance.diagnosis import Diagnosis, explain
from mxeon.conformance.diagnosis.faults import DIRECT_FAULTS
from mxeon.conformance.specs.hair import REGION, REGIONS, HairSpec
from mxeon.conformance.tolerance import Compared, Term, scaled
from mxeon.models.nodes.lobes import FORMS, TILTED

TURN_FIBER = with_inputs(
    "the normal is turned about the fiber by a tenth", normal=(0.0, 0.1, 0.995)
)


def _values(key: str, case: Case) -> Compared:
    """Values of a region, and the expected ones."""
    batch = case.of(HairSpec).region(key, case.samples.counts.few)
    return Compared(batch, case.direct(batch), case.expected(batch))


def _measure(key: str, case: Case) -> Compared:
    """Values of a region against those of the equations, over their condition."""
    return over_condition(case, _values(key, case))


def _diagnose(key: str, case: Case) -> Diagnosis:
    """The explanation of the values of a region."""
    others = set(FORMS) - {REGIONS[key].form, TILTED}  # which may be the same there
    candidates = [each for each in case.value_candidates if each.title not in others]
    compared = _values(key, case)
    brightest = min(float(compared.expected.max()), 1.0)
    terms = (Term(brightest * REGION.value, "a region"),)
    tolerance = replace(REGION, terms=terms, metric=scaled, exact=True)
    return explain(case, [compared], candidates, DIRECT_FAULTS, tolerance)


for _key, _region in REGIONS.items():
    check(
        of_family(HairSpec),
        TURN_FIBER,
        key=_key,
        claim=_region.claim,
        lit=True,
        open=True,
        diagnose=partial(_diagnose, _key),
    )(partial(_measure, _key))
