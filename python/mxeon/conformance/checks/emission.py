# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that emit light."""

from mxeon.conformance.accuracy import emission as tolerances
from mxeon.conformance.accuracy.diffuse import count_of
from mxeon.conformance.accuracy.engine import widen_for_engine
from mxeon.conformance.checks import emission_measures as measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import gray, mistake, offset, scale, shifted, with_inputs
from mxeon.conformance.checks.names import EMITTER, MEDIUM_NAMES
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.comparisons import BACK, RADIANCE, TRANSMITTANCE, VALUE
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.emission import (
    UNIMPLEMENTED,
)
from mxeon.conformance.probes.cases import (
    back_cases,
    conditioned,
    value_cases,
)
from mxeon.conformance.probes.probe import Probe


@mistake("the node is one that nothing implements")
def unimplemented(probe: Probe) -> Probe:
    return probe.of(UNIMPLEMENTED)


def diagnose_missing(probe: Probe) -> Diagnosis:
    """The node that the target lacks."""
    return Diagnosis(f"{probe.host.target} has no implementation of {probe.subject.title}")


def diagnose_opacity(probe: Probe) -> Diagnosis:
    """Whether the opacity is dropped."""
    full = max(
        tolerances.OPACITY.metric(
            case.measured, probe.expected(case.batch.altered(opacity=1.0))
        ).max()
        for case in value_cases(probe)
    )
    return Diagnosis("the opacity is ignored" if full <= tolerances.OPACITY.value else "")


CHECKS = (
    Check(
        "implemented",
        "The target implements the node.",
        (*EMITTER, *MEDIUM_NAMES, kinds.ABSENT),
        measures.implemented,
        unimplemented,
        count_of("nodes"),
        diagnose=diagnose_missing,
    ),
    Check(
        "radiance",
        "The radiance matches the node's equation for every view from the front.",
        EMITTER,
        conditioned(value_cases),
        gray,
        "value",
        diagnose=RADIANCE.diagnose,
        adapt=widen_for_engine,
    ),
    Check(
        "back",
        "The back of the surface emits what the equation gives.",
        EMITTER,
        conditioned(back_cases),
        offset,
        "value",
        pairs=True,
        diagnose=BACK.diagnose,
        open=True,
        adapt=widen_for_engine,
    ),
    Check(
        "exitance",
        "The radiance integrates to the power that the equation gives.",
        EMITTER,
        measures.exitance,
        scale("the radiance is 1 % too low", 0.99),
        "integral",
        diagnose=RADIANCE.diagnose,
        adapt=widen_for_engine,
    ),
    Check(
        "transmittance",
        "Over one meter, a medium transmits what its coefficients give.",
        MEDIUM_NAMES,
        TRANSMITTANCE,
        shifted,
        adapt=widen_for_engine,
    ),
    Check(
        "opacity",
        "The light that a surface emits is scaled by its opacity.",
        (kinds.EMITTING_SURFACE,),
        VALUE,
        with_inputs("the opacity is 1", opacity=1.0),
        diagnose=diagnose_opacity,
    ),
)
