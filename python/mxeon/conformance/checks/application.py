# SPDX-License-Identifier: Apache-2.0
"""Results of the table of checks: measurement, control and, on failure, a diagnosis."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mxeon.conformance.checks.measures import integrated
from mxeon.conformance.checks.table import CHECKS, Check
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.verdicts import judge_measurements, not_measured, renderer_warnings
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.results import AlbedoCurve, Place, Result
from mxeon.errors import NotRun, ShaderError

CURVE_COLOR, CURVE_ROUGHNESS = (0.8, 0.4, 0.1), 1.0
CURVE_COSINES = np.linspace(0.05, 1.0, 20)


def applies(check: Check, subject: Subject, kind: str, host: str) -> bool:
    """Whether a check applies to a subject, with a kind of probe, on a host."""
    asked = subject.model in check.models and check.applies(subject, host)
    return asked and check.tolerance(kind) is not None


def judge_subject(probe: Probe, checks: Sequence[Check] = CHECKS) -> tuple[Result, ...]:
    """Results of the checks that apply to a node on its host.

    Parameters
    ----------
    probe : Probe
    checks : sequence of Check
        Rows of the table.

    Returns
    -------
    tuple of Result
    """
    return tuple(
        judge_check(check, probe)
        for check in checks
        if applies(check, probe.subject, probe.kind, probe.host.name)
    )


def judge_curve(probe: Probe) -> tuple[AlbedoCurve, ...]:
    """The node's directional albedo over the cosine, integrated from its values.

    Parameters
    ----------
    probe : PairProbe

    Returns
    -------
    tuple of AlbedoCurve
    """
    measured, expected = integrated(probe, CURVE_COSINES, CURVE_COLOR, CURVE_ROUGHNESS)
    return (
        AlbedoCurve(
            probe.subject.title,
            probe.host.name,
            probe.library,
            CURVE_COLOR,
            CURVE_ROUGHNESS,
            CURVE_COSINES,
            measured,
            expected,
        ),
    )


def judge_check(check: Check, probe: Probe) -> Result:
    """The result of a row of the table for a probe, with its control and a diagnosis."""
    # What the result is of, and how wrong it may be.
    place: Place = {
        "check": check.key,
        "claim": check.claim,
        "subject": probe.subject.title,
        "host": probe.host.name,
        "library": probe.library,
        **probe.claims,
    }
    allowed = check.tolerance(probe.kind)
    assert allowed is not None, f"{check.key} cannot be asked of {probe.kind}"
    tolerance = check.adapt(allowed, probe.subject, probe.kind, probe.host)
    # The error, that of the control, and what explains a failure.
    diagnosis = Diagnosis()
    try:
        with renderer_warnings() as notes:
            right = check.measured(probe, tolerance.metric)
            wrong = check.measured(check.control.make(probe), tolerance.metric)
            if right.error > tolerance.value:
                diagnosis = check.explain(probe)
    except (NotRun, ShaderError) as error:
        return not_measured(place, error)
    # A permitted function excuses an open check alone.
    diagnosis = replace(diagnosis, permitted=check.open and diagnosis.permitted)
    if diagnosis.text:
        diagnosis = replace(diagnosis, text="; ".join([diagnosis.text, *notes]))
    return judge_measurements(place, tolerance, right, check.control.words, wrong, diagnosis)
