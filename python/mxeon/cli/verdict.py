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

    # Write the report.
    page = report.write(run, options.report) if options.report else None
    summary = run.summary
    # Print the results, or what a person has to know of them.
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
    # Print the documents that were refused.
    for error in run.errors:
        fail(MISUSE, error)
    # Turn the verdict into a status.
    if run.errors:
        return MISUSE
    return {"passed": PASSED, "failed": FAILED, "not run": NOT_RUN}[summary.verdict]


def _print_not_run(run: Run) -> None:
    """Print each reason that kept checks from running, with their number."""
    reasons = Counter(
        (result.location, result.reason) for result in run.results if result.verdict == "not run"
    )
    for (where, reason), count in reasons.items():
        print(one_line(f"not run: {where}, {count} checks: {reason}"))


def _print_failed(run: Run) -> None:
    """Print the checks that failed, and those that differ where they may."""
    for result in run.results:
        if result.verdict in ("failed", "differs"):
            where = f"{result.location}, {result.check}, {result.subject}"
            print(one_line(f"{result.verdict}: {where}: {result.explanation}"))
