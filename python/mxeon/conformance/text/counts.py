# SPDX-License-Identifier: Apache-2.0
"""Results of the checks of text: counts of faults, each of which must be 0."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, SOURCE, Control, Result
from mxeon.errors import NotRun, ShaderError


@dataclass(frozen=True)
class Claim:
    """A check of text."""

    key: str  # one word, and what has to be true
    sentence: str
    unit: str  # what is counted
    variant: str  # the error that the control makes


def counted(
    claim: Claim, subject: str, library: str, count: float, control: float, meaning: str
) -> Result:
    caught = control > 0 and control >= count
    return Result(
        check=claim.key,
        claim=claim.sentence,
        subject=subject,
        host=SOURCE,
        library=library,
        verdict=PASSED if count == 0 and caught else FAILED,
        error=count,
        unit=claim.unit,
        tolerance=0,
        derivation="a count",
        diagnosis=meaning if count else "",
        control=Control(claim.variant, control, caught),
    )


def judged(
    claim: Claim, subject: str, library: str, faults: Callable[[], tuple[Sequence[str], float]]
) -> Result:
    """Result of faults in words and of the number that the control has, where the text can be read."""
    place = (claim.key, claim.sentence, subject, SOURCE, library)
    try:
        found, control = faults()
    except NotRun as error:
        return Result(*place, verdict=NOT_RUN, reason=str(error))
    except ShaderError as error:
        return Result(*place, verdict=FAILED, diagnosis=f"{subject.rpartition(', ')[2]}: {error}")
    return counted(claim, subject, library, len(found), control, "; ".join(found))
