# SPDX-License-Identifier: Apache-2.0
"""The table of checks applied: a node on a host, with its controls and, on failure, a diagnosis."""

import numpy as np

from mxeon.conformance.checks.measures import integrated
from mxeon.conformance.checks.nodes import FLAG
from mxeon.conformance.checks.probes import probe_type
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.diagnosis import Diagnosis, nearest_albedo, nearest_value
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, Control, Curve, Result
from mxeon.errors import NotRun, ShaderError
from mxeon.shaders.hosts import front_lit_only

SURROUNDED = ("environment", "furnace")
CURVE = {"color": (0.8, 0.4, 0.1), "roughness": 1.0}
CURVE_COSINES = np.linspace(0.05, 1.0, 20)


def applies(check, subject, kind, host):
    """Whether a row of the table can be asked about a subject, by a kind of probe, on a host."""
    return (
        subject.model in check.models
        and kind in check.tolerances
        and not (check.key == "flag" and FLAG not in subject.inputs)
        and not (check.key in SURROUNDED and front_lit_only(host, subject.model))
    )


def judge_subject(probe, checks=CHECKS):
    """Results of the checks that apply to a node, as its host can be asked.

    Parameters
    ----------
    probe : PairProbe or PictureProbe
    checks : sequence of Check
        The rows to go through.

    Returns
    -------
    tuple of Result
    """
    place = {
        "subject": probe.subject.title,
        "host": probe.host.name,
        "library": probe.library,
    }
    return tuple(
        _judge(check, probe, check.tolerances[probe.kind], place, _diagnose)
        for check in checks
        if applies(check, probe.subject, probe.kind, probe.host.name)
    )


def judge_twins(host, library, checks=CHECKS):
    """Results of the checks of the shader twins, which are the same whatever library is judged."""
    place = {"subject": "shader twins", "host": host.name, "library": library}
    kind = probe_type(host.name).kind
    return tuple(
        _judge(check, host.call, check.tolerances[kind], place, lambda check, probe: Diagnosis())
        for check in checks
        if not check.models
    )


def judge_curve(probe):
    """The node's directional albedo over the cosine, integrated from its values.

    Parameters
    ----------
    probe : PairProbe

    Returns
    -------
    tuple of Curve
    """
    measured, expected = integrated(probe, CURVE_COSINES, CURVE["color"], CURVE["roughness"])
    return (
        Curve(
            probe.subject.title,
            probe.host.name,
            probe.library,
            CURVE["color"],
            CURVE["roughness"],
            CURVE_COSINES,
            measured,
            expected,
        ),
    )


def _judge(check, probe, tolerance, place, diagnose):
    try:
        found = check.measure(probe, tolerance.error)
        wrong = check.measure(check.control(probe), tolerance.error)
    except NotRun as reason:
        return Result(check.key, check.claim, **place, verdict=NOT_RUN, reason=str(reason))
    except ShaderError as error:
        return Result(check.key, check.claim, **place, verdict=FAILED, diagnosis=str(error))
    right, caught = found.error <= tolerance.limit, wrong.error > tolerance.limit
    diagnosis = Diagnosis() if right else diagnose(check, probe)
    return Result(
        check.key,
        check.claim,
        **place,
        verdict=PASSED if right and caught else FAILED,
        error=found.error,
        unit=tolerance.unit,
        tolerance=tolerance.limit,
        derivation=tolerance.derivation,
        worst=found.worst,
        diagnosis=diagnosis.text,
        distances=diagnosis.distances,
        control=Control(check.variant, wrong.error, caught),
    )


def _diagnose(check, probe):
    return nearest_albedo(probe) if check.key in SURROUNDED else nearest_value(probe)
