# SPDX-License-Identifier: Apache-2.0
"""A run, printed as the options say, and its exit status."""

from __future__ import annotations

import argparse
from collections.abc import Collection
from typing import TYPE_CHECKING

from mxeon.cli.output import fail
from mxeon.errors import FAILED, MISUSE, NOT_RUN, PASSED, as_output, one_line, printable

if TYPE_CHECKING:
    from mxeon.conformance.results import Result, Run


def show_run(run: Run, options: argparse.Namespace, said: Collection[str] = ()) -> int:
    """Write the report of a run and print its answer; return the exit status.

    Errors of documents that were `said` already are not printed again.
    """
    from mxeon import report
    from mxeon.cli.answer import answer

    page = report.write(run, options.report) if options.report else None
    if options.json:
        print(as_output(report.to_json(run)))
    else:
        files = [
            one_line(f"library {folder}: {origin}: {', '.join(names) or 'nothing'}")
            for folder, origins in run.libraries.items()
            for origin, names in origins.items()
        ]
        checks = [*map(_line, run.results), *files] if options.full else []
        print(printable("\n".join([*checks, *answer(run, options.full)])))
        if page:
            print(f"report: {page}")
    if run.refused:
        return fail(MISUSE, *(each for each in run.errors if each not in said))
    return {"passed": PASSED, "failed": FAILED, "not run": NOT_RUN}[run.summary.verdict]


def _line(result: Result) -> str:
    """A check with its error and tolerance, or why it did not pass."""
    numbers = result.reason or result.explanation
    if result.verdict == "passed":
        error, tolerance = result.error or 0.0, result.tolerance or 0.0
        numbers = f"{error:.3g} <= {tolerance:.3g} {result.unit}" if tolerance else ""
    about = f"{result.verdict}: {result.location}, {result.check}, {result.subject}"
    return one_line(f"{about}: {numbers}".rstrip(": "))
