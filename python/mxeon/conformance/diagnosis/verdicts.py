# SPDX-License-Identifier: Apache-2.0
"""Verdicts: results from a measurement, that of a control, and a diagnosis."""

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, Control, Place, Result
from mxeon.conformance.tolerance import Measurement, Tolerance
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.base import RendererWarning

CANNOT_TELL = "inconclusive: the values are right, but the control passed too:"


def judge(
    place: Place,
    tolerance: Tolerance,
    measure: Callable[[bool], Measurement],
    variant: str,
    diagnose: Callable[[], Diagnosis],
) -> Result:
    """The result of a check that measures a subject, and its control if True, whose mistake is `variant`.

    A check whose engine is not there is not run; a shader error fails it.
    """
    try:
        with renderer_warnings() as notes:
            right, wrong = measure(False), measure(True)
            diagnosis = diagnose() if right.error > tolerance.value else Diagnosis()
    except (NotRun, ShaderError) as error:
        return not_measured(place, error)
    caught, passed = wrong.error > tolerance.value, right.error <= tolerance.value
    text = "; ".join([diagnosis.text, *notes]) if diagnosis.text else ""
    return Result(
        **place,
        verdict=PASSED if passed and caught else DIFFERS if diagnosis.permitted else FAILED,
        error=right.error,
        unit=tolerance.unit,
        tolerance=tolerance.value,
        derivation=tolerance.derivation,
        worst=right.worst,
        diagnosis=f"{CANNOT_TELL} {variant}" if passed and not caught else text,
        distances=diagnosis.distances,
        control=Control(variant, wrong.error, caught),
    )


def not_measured(place: Place, error: NotRun | ShaderError) -> Result:
    """The result of a check without a measurement: not run, or failed by a shader error."""
    if isinstance(error, NotRun):
        return Result(**place, verdict=NOT_RUN, reason=str(error))
    return Result(**place, verdict=FAILED, diagnosis=str(error))


@contextmanager
def renderer_warnings() -> Iterator[list[str]]:
    """The renderer's own warnings in a block, each once; others are shown with their own lines."""
    notes: list[str] = []
    with warnings.catch_warnings(record=True) as records:
        warnings.simplefilter("always", RendererWarning)
        yield notes
    for record in records:
        if not isinstance(record.message, RendererWarning):
            warnings.showwarning(record.message, record.category, record.filename, record.lineno)
        elif str(record.message) not in notes:
            notes.append(str(record.message))
