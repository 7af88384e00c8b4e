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
    """The verdict on a whole run."""

    # FAILED if any check failed, else NOT_RUN if any or all did not run or are missing, else PASSED.
    verdict: str
    counts: dict[str, int]  # number of checks that ended with each of VERDICTS
    sentence: str


def summarize(
    results: Sequence[Result],
    missing: Sequence[str] = (),
    refused: Sequence[str] = (),
    elsewhere: int = 0,
) -> Summary:
    """Verdict on results, with the tasks that are missing and the documents that were refused.

    `elsewhere` is the number of failures for inputs that no document uses.

    Examples
    --------
    >>> summarize((), (), ["clay.mtlx"]).sentence
    'Refused and not judged: clay.mtlx. No check ran.'
    """
    summary = _summarize_results(results)
    if elsewhere:
        words = f" {elsewhere} of them for inputs that no document uses."
        summary = replace(summary, sentence=summary.sentence + words)
    if not missing and not refused:
        return summary
    # Without what is not there nothing has passed.
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
    total = counted(len(results), "check")

    def summary(verdict: str, sentence: str) -> Summary:
        return Summary(verdict, counts, sentence)

    if counts[FAILED]:
        failed = Counter(result.location for result in results if result.verdict == FAILED)
        listed = "; ".join(f"{count} on {location}" for location, count in failed.items())
        return summary(FAILED, f"{counts[FAILED]} of {total} failed: {listed}.")
    if not counts[PASSED] + counts[DIFFERS]:
        return summary(NOT_RUN, "No check ran.")
    if counts[NOT_RUN]:
        return summary(NOT_RUN, f"Nothing failed, but {counts[NOT_RUN]} of {total} did not run.")
    hosts = " and ".join(dict.fromkeys(result.location for result in results))
    if counts[DIFFERS]:
        differ = "differs" if counts[DIFFERS] == 1 else "differ"
        return summary(
            PASSED,
            f"{counts[PASSED]} of {total} passed on {hosts}; {counts[DIFFERS]} {differ} where the "
            "specification leaves it open.",
        )
    passed = "The check" if len(results) == 1 else f"All {len(results)} checks"
    return summary(PASSED, f"{passed} passed on {hosts}.")


def counted(count: int, noun: str) -> str:
    """A number of things.

    Examples
    --------
    >>> counted(1, "check"), counted(2, "check")
    ('1 check', '2 checks')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"
