# SPDX-License-Identifier: Apache-2.0
"""Checks of the hair node alone: its lobes apart, where they are wide, narrow, or seen straight."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from mxeon.conformance.accuracy.hair import HAIR_REGION
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import with_inputs
from mxeon.conformance.diagnosis.candidates import Diagnosis, explain
from mxeon.conformance.diagnosis.faults import DIRECT_FAULTS
from mxeon.conformance.nodes.hair_regions import REGIONS
from mxeon.conformance.probes.cases import over_condition
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.measurement import Case, scaled
from mxeon.models.hair.defects import FORMS, TILTED
from mxeon.models.nodes.hair import HAIR_NODE

CLAIMS = {
    "each_lobe": "Each lobe matches the equations: R, TT, and TRT with all higher orders.",
    "narrow_lobes": "R and TT match the equations where they are narrow.",
    "tilted_lobes": "R and TT match the equations for every tilt of the cuticle.",
    "wide_lobes": "R and TT match the equations beyond a roughness of 1.",
    "straight_views": "R and TT match the equations for a view along the normal.",
    "low_index": "R and TT match the equations for an index below 1, including total reflection.",
}


def _case(probe: Probe, key: str) -> Case:
    """Values of a region, and the expected ones."""
    batch = probe.region(key)
    return Case(batch, probe.direct(batch), probe.expected(batch))


def _measure(key: str) -> Callable[[Probe], Iterable[Case]]:
    """Values of a region against those of the equations, over their condition."""
    return lambda probe: [over_condition(probe, _case(probe, key))]


def _diagnose(key: str) -> Callable[[Probe], Diagnosis]:
    """The explanation of the values of a region."""

    def diagnose(probe: Probe) -> Diagnosis:
        others = set(FORMS) - {REGIONS[key].form, TILTED}  # which may be the same there
        candidates = [each for each in probe.value_candidates if each.title not in others]
        case = _case(probe, key)
        brightest = min(float(case.expected.max()), 1.0)
        tolerance = replace(HAIR_REGION, metric=scaled, value=brightest * HAIR_REGION.value)
        return explain(probe, [case], candidates, DIRECT_FAULTS, tolerance)

    return diagnose


TURN_FIBER = with_inputs(
    "the normal is turned about the fiber by a tenth", normal=(0.0, 0.1, 0.995)
)

CHECKS = tuple(
    Check(
        key,
        claim,
        (HAIR_NODE.name,),
        _measure(key),
        TURN_FIBER,
        HAIR_REGION,
        lit=True,
        diagnose=_diagnose(key),
        open=True,
    )
    for key, claim in CLAIMS.items()
)
