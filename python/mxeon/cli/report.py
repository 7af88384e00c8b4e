# SPDX-License-Identifier: Apache-2.0
"""`mxeon report`: write the report of a run, compare two runs, or compare many renderers."""

import argparse
import json
import os

from mxeon.cli import arguments
from mxeon.cli.output import show
from mxeon.errors import PASSED, InputError, as_output


def add_parser(commands: arguments.Commands) -> None:
    examples = (
        "report make out  # even if the run was interrupted",
        "report diff before after  # what became better or worse",
        "report field out/*  # all renderers on one page",
        "report schema  # the JSON Schema of results.json",
    )
    summary = "write the report of a run, compare two runs, or show many renderers on one page"
    group = arguments.add_command(commands, "report", summary, None, *examples)
    actions = group.add_subparsers(required=True, title="commands", metavar="ACTION")
    summary = "write the report of a run, finished or not"
    make = arguments.add_command(actions, "make", summary, run_make, examples[0])
    make.add_argument("report", metavar="DIR", help="the folder of the run")
    arguments.add_shared(make, "--full", "--json")
    summary = "list what changed between two runs; the exit status is 1 if something got worse, 3 if a check no longer runs"
    diff = arguments.add_command(actions, "diff", summary, run_diff, examples[1])
    diff.add_argument("before", metavar="BEFORE", help="folder of a report, or its results.json")
    diff.add_argument("after", metavar="AFTER", help="the same for a later run")
    arguments.add_shared(diff, "--json")
    summary = "show the renderers of many reports on one page"
    field = arguments.add_command(actions, "field", summary, run_field, examples[2])
    field.add_argument(
        "reports", metavar="DIR", nargs="+", help="folder of a report, or of several reports"
    )
    field.add_argument(
        "--output", metavar="FILE", default="field.html", help="the page (default: %(default)s)"
    )
    summary = "print the JSON Schema of the results of a report"
    arguments.add_command(actions, "schema", summary, run_schema, examples[3])


def run_make(options: argparse.Namespace) -> int:
    from mxeon.cli.answer import show_run
    from mxeon.conformance.run import read_run
    from mxeon.report import require_extra

    require_extra("report.html")
    return show_run(read_run(options.report), options)


def run_field(options: argparse.Namespace) -> int:
    """Write the page that compares renderers; return PASSED, even if a check failed."""
    from mxeon.conformance.results import report_files
    from mxeon.io.files import check_output
    from mxeon.report import require_extra
    from mxeon.survey.field import read_field, reports_in

    require_extra("the page that compares renderers")
    from mxeon.survey.field_page import write_field

    reports = (each for folder in options.reports for each in reports_in(folder))
    read = (file for each in reports for file in report_files(each))
    check_output(options.output, read, [".html"])
    if os.path.islink(options.output):  # writing through a link would replace another file
        raise InputError(f"output must not be a link; got {options.output}")
    entries = read_field(options.reports)
    page = write_field(entries, options.output)
    show(f"field: {page}, nodes: {len(entries)}")
    return PASSED


def run_schema(options: argparse.Namespace) -> int:
    from mxeon.report.schema import schema

    print(as_output(json.dumps(schema(), indent=1)))
    return PASSED


def run_diff(options: argparse.Namespace) -> int:
    """Print two reports' differences; return FAILED for a worse check, NOT_RUN for a lost check."""
    from mxeon.report.diff import compare, lines, read_results, status, to_json

    changes = compare(read_results(options.before), read_results(options.after))
    if options.json:
        print(as_output(json.dumps(to_json(changes), indent=1)))
    else:
        print("\n".join(lines(changes)))
    return status(changes)
