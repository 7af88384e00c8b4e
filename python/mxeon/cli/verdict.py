# SPDX-License-Identifier: Apache-2.0
"""A run, printed as the options say, and its exit status."""

from __future__ import annotations

import argparse
from collections import Counter
from typing import TYPE_CHECKING

from mxeon.cli.output import fail
from mxeon.errors import FAILED, MISUSE, NOT_RUN, PASSED, one_line, printable

if TYPE_CHECKING:
    from mxeon.conformance.results import Run


def show_run(run: Run, options: argparse.Namespace) -> int:
    """Write the report of a run and print its verdict; return the exit status."""
    from mxeon import report
    from mxeon.conformance.verdict import summarize

    page = report.write(run, options.report) if options.report else None
    summary = summarize(run.results, run.missing, run.errors)
    if options.json:
        print(report.to_json(run))
    else:
        _print_not_run(run)
        _print_failed(run)
        for note in run.notes:
            print(printable(" ".join(f"note: {note}".split())))
        print(printable(summary.sentence))
        if page:
            print(f"report: {page}")
    for error in run.errors:
        fail(MISUSE, error)
    if run.errors:
        return MISUSE
    return {"passed": PASSED, "failed": FAILED, "not run": NOT_RUN}[summary.verdict]


def _print_not_run(run: Run) -> None:
    """Print each reason that kept checks from running, with their number."""
    from mxeon.conformance.verdict import place

    reasons = Counter(
        (place(result), result.reason) for result in run.results if result.verdict == "not run"
    )
    for (where, reason), count in reasons.items():
        print(one_line(f"not run: {where}, {count} checks: {reason}"))


def _print_failed(run: Run) -> None:
    from mxeon.conformance.verdict import explained, place

    for result in run.results:
        if result.verdict == "failed":
            where = f"{place(result)}, {result.check}, {result.subject}"
            print(one_line(f"failed: {where}: {explained(result)}"))
