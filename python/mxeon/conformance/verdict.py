# SPDX-License-Identifier: Apache-2.0
"""The verdict on a whole run, in a word, in numbers and in a sentence."""

from collections import Counter
from dataclasses import dataclass, replace

from mxeon.conformance.results import FAILED, NOT_RUN, PASSED


@dataclass(frozen=True)
class Summary:
    """The verdict on a whole run.

    Attributes
    ----------
    verdict : str
        FAILED if any check failed, else NOT_RUN if any or all did not run or the run is not
        finished, else PASSED.
    counts : dict of str to int
        How many checks ended as PASSED, FAILED, NOT_RUN.
    sentence : str
        The same for a reader.
    """

    verdict: str
    counts: dict
    sentence: str


def summarize(results, missing=(), errors=()):
    """Verdict on `results`, a sequence of `mxeon.conformance.results.Result`, as a Summary.

    Parameters
    ----------
    results : sequence of Result
    missing : sequence of str
        Items of an interrupted run that are not done yet.
    errors : sequence of str
        About documents that were refused.

    Examples
    --------
    >>> summarize(()).sentence
    'No check ran.'
    """
    summary = _summarize(results)
    if not missing and not errors:
        return summary
    verdict = FAILED if summary.verdict == FAILED else NOT_RUN
    sentence = summary.sentence
    if missing:
        sentence += f" The run is not finished: {len(missing)} items are missing."
    if errors:
        sentence += f" Refused: {len(errors)} documents."
    return replace(summary, verdict=verdict, sentence=sentence)


def _summarize(results):
    tally = Counter(result.verdict for result in results)
    counts = {verdict: tally[verdict] for verdict in (PASSED, FAILED, NOT_RUN)}
    total = len(results)
    if counts[FAILED]:
        where = Counter(place(result) for result in results if result.verdict == FAILED)
        listed = "; ".join(f"{count} on {name}" for name, count in where.items())
        return Summary(FAILED, counts, f"{counts[FAILED]} of {total} checks failed: {listed}.")
    if not counts[PASSED]:
        return Summary(NOT_RUN, counts, "No check ran.")
    if counts[NOT_RUN]:
        sentence = f"Nothing failed, but {counts[NOT_RUN]} of {total} checks did not run."
        return Summary(NOT_RUN, counts, sentence)
    hosts = " and ".join(dict.fromkeys(place(result) for result in results))
    return Summary(PASSED, counts, f"All {total} checks passed on {hosts}.")


def excess(result):
    """What made a check fail: a figure that is too large, or a control that was not caught."""
    control = result.control
    if result.figure is not None and not result.figure <= result.tolerance:
        return f"{result.figure:.3g} > {result.tolerance:.3g} {result.unit}".rstrip()
    if control and not control.caught:
        return f"the negative control is not caught: {control.variant}, {control.figure:.3g}"
    return ""


def explained(result):
    """Why a check failed: what made it, and what that shows."""
    return "; ".join(filter(None, (excess(result), result.diagnosis)))


def place(record):
    """Where a Result, Picture or Curve comes from, in words: host and library."""
    return f"{record.host} with {record.library}"
