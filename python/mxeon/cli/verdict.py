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
    """Write the report of a run and print its verdict; return the exit status.

    Parameters
    ----------
    run : Run
    options : argparse.Namespace
        Those of `mxeon.cli.arguments.add_report`, `add_full` and `add_json`.
    said : collection of str
        Errors of documents that were printed already.
    """
    from mxeon import report
    from mxeon.cli.answer import answer

    # Write the report.
    page = report.write(run, options.report) if options.report else None
    # Print the results, or what a person has to know of them.
    if options.json:
        print(as_output(report.to_json(run)))
    else:
        if options.full:
            _print_all(run)
        else:
            print(printable("\n".join(answer(run))))
        if page:
            print(f"report: {page}")
    # Print why documents were refused, unless that was done first.
    if run.refused:
        return fail(MISUSE, *(each for each in run.errors if each not in said))
    return {"passed": PASSED, "failed": FAILED, "not run": NOT_RUN}[run.summary.verdict]


def _print_all(run: Run) -> None:
    """Print every check, those of the user's documents first, notes, and the verdict."""
    from mxeon.cli.answer import new_notes

    for result in run.results:
        where = f"{result.location}, {result.check}, {result.subject}"
        print(one_line(f"{result.verdict}: {where}: {_numbers(result)}"))
    for note in new_notes(run):
        print(printable(" ".join(f"note: {note}".split())))
    for folder, files in run.libraries.items():
        for origin, names in files.items():
            print(one_line(f"library {folder}: {origin}: {', '.join(names) or 'nothing'}"))
    for line in (*run.origins, run.sentence):
        print(printable(line))


def _numbers(result: Result) -> str:
    """The error and the bound of a check that passed; else why it did not."""
    if result.verdict == "passed":
        error, bound = result.error or 0.0, result.tolerance or 0.0
        return f"{error:.3g} <= {bound:.3g} {result.unit}".rstrip()
    return result.reason or result.explanation
