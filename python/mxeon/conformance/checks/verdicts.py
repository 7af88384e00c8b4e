# SPDX-License-Identifier: Apache-2.0
"""Results of the table of checks: measurement, control and, on failure, a diagnosis."""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from mxeon.conformance.checks.measures import Measurement, integrated
from mxeon.conformance.checks.table import CHECKS, Check
from mxeon.conformance.samples.tolerance import Tolerance
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, Control, Curve, Result
from mxeon.errors import NotRun, ShaderError
from mxeon.shaders.hosts.base import RendererWarning

CURVE_COLOR, CURVE_ROUGHNESS = (0.8, 0.4, 0.1), 1.0
CURVE_COSINES = np.linspace(0.05, 1.0, 20)


def applies(check: Check, subject: Any, kind: str, host: str) -> bool:
    """Whether a check applies to a subject, with a kind of probe, on a host."""
    return (
        subject.model in check.models and kind in check.tolerances and check.applies(subject, host)
    )


def judge_subject(probe: Any, checks: Sequence[Check] = CHECKS) -> tuple[Result, ...]:
    """Results of the checks that apply to a node on its host.

    Parameters
    ----------
    probe : PairProbe, PictureProbe or CallableProbe
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


def judge_curve(probe: Any) -> tuple[Curve, ...]:
    """The node's directional albedo over the cosine, integrated from its values.

    Parameters
    ----------
    probe : PairProbe

    Returns
    -------
    tuple of Curve
    """
    measured, expected = integrated(probe, CURVE_COSINES, CURVE_COLOR, CURVE_ROUGHNESS)
    return (
        Curve(
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


def judge_measurements(
    fields: dict[str, Any],
    tolerance: Tolerance,
    right: Measurement,
    variant: str,
    wrong: Measurement,
    diagnosis: Diagnosis,
) -> Result:
    """The result of a check from its measurement and that of its control.

    Parameters
    ----------
    fields : dict of str
        Check, claim, subject, host and library of the result.
    tolerance : Tolerance
    right, wrong : Measurement
        Of the probe and of its control.
    variant : str
        The error that the control makes.
    diagnosis : Diagnosis

    Returns
    -------
    Result
    """
    caught = wrong.error > tolerance.value
    verdict = DIFFERS if diagnosis.permitted else FAILED
    return Result(
        **fields,
        verdict=PASSED if right.error <= tolerance.value and caught else verdict,
        error=right.error,
        unit=tolerance.unit,
        tolerance=tolerance.value,
        derivation=tolerance.derivation,
        worst=right.worst,
        diagnosis=diagnosis.text,
        distances=diagnosis.distances,
        control=Control(variant, wrong.error, caught),
    )


def not_measured(fields: dict[str, Any], error: NotRun | ShaderError) -> Result:
    """The result of a check without a measurement: not run, or failed by a shader error."""
    if isinstance(error, NotRun):
        return Result(**fields, verdict=NOT_RUN, reason=str(error))
    return Result(**fields, verdict=FAILED, diagnosis=str(error))


@contextmanager
def renderer_warnings() -> Iterator[list[str]]:
    """The renderer's own warnings in a block, each once; others are passed on."""
    notes: list[str] = []
    with warnings.catch_warnings(record=True) as records:
        warnings.simplefilter("always", RendererWarning)
        yield notes
    for record in records:
        if not isinstance(record.message, RendererWarning):
            warnings.warn(record.message, stacklevel=3)
        elif str(record.message) not in notes:
            notes.append(str(record.message))


def judge_check(check: Check, probe: Any) -> Result:
    """The result of a row of the table for a probe, with its control and a diagnosis."""
    fields = {
        "check": check.key,
        "claim": check.claim,
        "subject": probe.subject.title,
        "host": probe.host.name,
        "library": probe.library,
        **getattr(probe, "claims", {}),  # of a renderer's own node
    }
    tolerance = check.adapt(check.tolerances[probe.kind], probe)
    diagnosis = Diagnosis()
    try:
        with renderer_warnings() as notes:
            right = check.measure(probe, tolerance.metric)
            wrong = check.measure(check.control(probe), tolerance.metric)
            if right.error > tolerance.value:
                diagnosis = check.diagnose(probe)
    except (NotRun, ShaderError) as error:
        return not_measured(fields, error)
    diagnosis = replace(diagnosis, permitted=check.open and diagnosis.permitted)
    if diagnosis.text:
        diagnosis = replace(diagnosis, text="; ".join([diagnosis.text, *notes]))
    return judge_measurements(fields, tolerance, right, check.variant, wrong, diagnosis)
