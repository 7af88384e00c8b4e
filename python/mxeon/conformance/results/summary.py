# SPDX-License-Identifier: Apache-2.0
"""The verdict on a whole run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mxeon.conformance.results.result import DIFFERS, FAILED, NOT_RUN, PASSED, VERDICTS, Result

NAMED = 3  # documents that were refused, beside the number of the others


@dataclass(frozen=True)
class Summary:
    """The verdict on a whole run.

    Attributes
    ----------
    verdict : str
        FAILED if any check failed, else NOT_RUN if any or all did not run or the run is not
        finished, else PASSED.
    counts : dict of str to int
        Number of checks that ended with each of VERDICTS.
    sentence : str
        The same for a reader.
    """

    verdict: str
    counts: dict[str, int]
    sentence: str


def summarize(
    results: Sequence[Result],
    missing: Sequence[str] = (),
    refused: Sequence[str] = (),
    elsewhere: int = 0,
) -> Summary:
    """Verdict on `results`.

    Parameters
    ----------
    results : sequence of Result
    missing : sequence of str
        Tasks of an interrupted run that are not done yet.
    refused : sequence of str
        Documents that were refused.
    elsewhere : int
        Number of failures for inputs that no document uses.

    Examples
    --------
    >>> summarize((), (), ["clay.mtlx"]).sentence
    'Refused and not judged: clay.mtlx. No check ran.'
    """
    # Judge what there is.
    summary = _summarize_results(results)
    if elsewhere:
        words = f" {elsewhere} of them for inputs that no document uses."
        summary = replace(summary, sentence=summary.sentence + words)
    if not missing and not refused:
        return summary
    # Say what is not there: without it nothing has passed.
    verdict = FAILED if summary.verdict == FAILED else NOT_RUN
    sentence = summary.sentence
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        sentence += f" The run is not finished: {counted(len(missing), 'item')} {verb} missing."
    if refused:
        more = f" and {len(refused) - NAMED} more" if len(refused) > NAMED else ""
        sentence = f"Refused and not judged: {', '.join(refused[:NAMED])}{more}. {sentence}"
    return replace(summary, verdict=verdict, sentence=sentence)


def _summarize_results(results: Sequence[Result]) -> Summary:
    tally = Counter(result.verdict for result in results)
    counts = {verdict: tally[verdict] for verdict in VERDICTS}
    total = len(results)
    # A failure decides.
    if counts[FAILED]:
        failed = Counter(result.location for result in results if result.verdict == FAILED)
        listed = "; ".join(f"{count} on {location}" for location, count in failed.items())
        return Summary(
            FAILED, counts, f"{counts[FAILED]} of {counted(total, 'check')} failed: {listed}."
        )
    # Then what did not run.
    if not counts[PASSED] + counts[DIFFERS]:
        return Summary(NOT_RUN, counts, "No check ran.")
    if counts[NOT_RUN]:
        sentence = (
            f"Nothing failed, but {counts[NOT_RUN]} of {counted(total, 'check')} did not run."
        )
        return Summary(NOT_RUN, counts, sentence)
    # All ran: they passed, or differ where they may.
    hosts = " and ".join(dict.fromkeys(result.location for result in results))
    if counts[DIFFERS]:
        sentence = (
            f"{counts[PASSED]} of {counted(total, 'check')} passed on {hosts}; {counts[DIFFERS]} "
            f"{'differs' if counts[DIFFERS] == 1 else 'differ'} where the specification leaves it open."
        )
        return Summary(PASSED, counts, sentence)
    passed = "The check" if total == 1 else f"All {total} checks"
    return Summary(PASSED, counts, f"{passed} passed on {hosts}.")


def counted(count: int, noun: str) -> str:
    """A number of things.

    Examples
    --------
    >>> counted(1, "check"), counted(2, "check")
    ('1 check', '2 checks')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"
