# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes that emit light."""

from dataclasses import replace
from typing import Any

from mxeon.conformance import diagnosis
from mxeon.conformance.checks.controls import offset, scale, shifted
from mxeon.conformance.checks.emission import measures, tolerances
from mxeon.conformance.checks.emission.subjects import ABSENT, KINDS, UNIMPLEMENTED
from mxeon.conformance.checks.measures import value
from mxeon.conformance.checks.table.check import Check
from mxeon.conformance.checks.table.names import EMITTER
from mxeon.conformance.checks.tolerances import count_of
from mxeon.conformance.diagnosis import Diagnosis


def unimplemented(probe: Any) -> Any:
    """A control that asks for a node that its document defines, and that nothing implements."""
    return replace(probe, subject=UNIMPLEMENTED)


def of_missing(probe: Any) -> Diagnosis:
    """The node that the target lacks."""
    return Diagnosis(f"{probe.host.target} has no implementation of {probe.subject.node}")


CHECKS = (
    Check(
        "implemented",
        "The target has an implementation of the node.",
        (*EMITTER, ABSENT),
        measures.implemented,
        "a node is asked for that nothing implements",
        unimplemented,
        dict.fromkeys((*KINDS, ABSENT), count_of("nodes")),
        diagnose=of_missing,
    ),
    Check(
        "radiance",
        "The radiance is that of the node's equation for every view from the front.",
        EMITTER,
        value,
        "each view has the inputs of another",
        shifted,
        tolerances.RADIANCES,
        diagnose=diagnosis.of_radiance,
        adapt=tolerances.on_engine,
    ),
    Check(
        "back",
        "The back of the surface emits what the equation has for it.",
        EMITTER,
        measures.back,
        "a thousandth is added to every value",
        offset,
        tolerances.RADIANCES,
        diagnose=diagnosis.of_back,
        open=True,
        adapt=tolerances.on_engine,
    ),
    Check(
        "exitance",
        "The radiance integrates to the power that the equation has.",
        EMITTER,
        measures.exitance,
        "the radiance is 0.99 times as large",
        scale(0.99),
        tolerances.EXITANCES,
        diagnose=diagnosis.of_radiance,
        adapt=tolerances.on_engine,
    ),
)
