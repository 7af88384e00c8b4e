# SPDX-License-Identifier: Apache-2.0
"""`mxeon explore`: write a page that draws, compares and probes materials in a browser."""

import argparse
from functools import partial

from mxeon.cli import arguments
from mxeon.cli.batch import run_batch
from mxeon.cli.output import fail, show, status_of, warn
from mxeon.errors import PASSED

MATERIALS = 300  # limit per document: a page of 3 MB, in 10 s


def add_parser(commands: arguments.Commands) -> None:
    command = arguments.add_command(
        commands,
        "explore",
        "write a web page to draw, compare and probe materials",
        run,
        "explore --output page.html  # every lobe, eonlib beside stock MaterialX",
        "explore my.mtlx --output page.html  # your materials too",
        "explore --report out --output page.html  # adds what `mxeon check --report out` found",
    )
    command.add_argument("files", nargs="*", metavar="FILE", help="MaterialX documents to add")
    command.add_argument(
        "--output", metavar="OUT", required=True, help="the page, one self-contained .html file"
    )
    command.add_argument(
        "--report", metavar="RUN", help="add the diagnoses of a run: its report folder"
    )
    command.add_argument(
        "--library",
        default="stock",
        metavar="NAME",
        help="what to compare eonlib with: stock (default), or a folder",
    )
    arguments.add_shared(command, "--materialx", "--workers", "--timeout")
    arguments.add_policy(command, runs_code=True, shaders=MATERIALS)


def run(options: argparse.Namespace) -> int:
    """Write the page and print its path; return the exit status."""
    from mxeon.conformance.results import report_files
    from mxeon.conformance.run import read_run
    from mxeon.explorer import document_sources, page, page_data
    from mxeon.io.files import check_output, write_text

    read = report_files(options.report) if options.report else ()
    check_output(options.output, arguments.inputs(options, options.files, *read), [".html"])
    results = read_run(options.report).results if options.report else ()
    work = partial(document_sources, policy=arguments.policy(options), library=options.library)
    documents = list(run_batch(work, options.files, options.workers, options.timeout))
    texts = (str(text) for each in documents for text in each.warnings)
    for text in dict.fromkeys(texts):  # both libraries may warn of one input
        warn(text)
    errors = [each.error for each in documents if each.error]
    if not errors:
        data = page_data((each.value for each in documents), results)
        if not data.judged:
            warn("the host gl does not run here: the page leaves open which models the nodes are")
        write_text(options.output, page(data))
        show(options.output)
    return min((fail(*status_of(error)) for error in errors), default=PASSED)
