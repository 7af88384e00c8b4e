# SPDX-License-Identifier: Apache-2.0
"""`mxeon explore`: a page that draws, compares and probes materials in a browser."""

import argparse
import webbrowser
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

from mxeon.cli import arguments
from mxeon.cli.batch import run_batch
from mxeon.cli.output import fail, show, status_of, warn
from mxeon.errors import PASSED

DOCUMENT_LIMIT = 300  # maximum shaders of a document; the page has 3 MB and takes 10 s


def add_parser(commands: arguments.Commands) -> None:
    command = arguments.add_command(
        commands,
        "explore",
        "draw, compare and probe materials in a browser",
        run,
        "explore  # every lobe with eonlib and stock MaterialX; drop documents on the page",
        "explore my.mtlx --environment sky.hdr",
        "explore my.mtlx --output page.html  # a page to send to somebody",
    )
    command.add_argument("files", nargs="*", metavar="FILE", help="MaterialX documents to add")
    command.add_argument(
        "--output",
        metavar="OUT",
        help="write a self-contained .html file (default: show the page until Ctrl-C)",
    )
    command.add_argument(
        "--environment", metavar="IMAGE", help="latitude-longitude image to light materials with"
    )
    command.add_argument(
        "--library",
        default="stock",
        metavar="NAME",
        help="what to compare eonlib with: stock (default), or a folder",
    )
    arguments.add_shared(command, "--materialx", "--workers", "--timeout")
    arguments.add_policy(command, runs_code=True, shaders=DOCUMENT_LIMIT)


def run(options: argparse.Namespace) -> int:
    from mxeon.explorer import document_sources, page, page_data, sky_of
    from mxeon.explorer.serve import Server
    from mxeon.io.files import check_output, write_text
    from mxeon.jobs.signals import temporary_folder

    if options.output:
        inputs = arguments.inputs(options, options.files, options.environment)
        check_output(options.output, inputs, [".html"])
    work = partial(document_sources, policy=arguments.policy(options), library=options.library)

    def make(files: list[str], light: str | None) -> str:
        documents = list(run_batch(work, files, options.workers, options.timeout))
        texts = (str(text) for each in documents for text in each.warnings)
        warnings = tuple(dict.fromkeys(texts))  # both libraries may issue the same warning
        for text in warnings:
            warn(text)
        errors = [each.error for each in documents if each.error]
        for error in errors[:-1]:
            fail(*status_of(error))
        if errors:
            raise errors[-1]
        data = page_data(each.value for each in documents)
        if not data.judged:
            warn("the host gl does not run here, so the page cannot name the models of nodes")
        sky = sky_of(light) if light else None
        return page(replace(data, served=not options.output, warnings=warnings, sky=sky))

    if options.output:
        write_text(options.output, make(options.files, options.environment))
        show(options.output)
        return PASSED
    with (
        temporary_folder("mxeon-explore-") as folder,
        Server(make, options.files, options.environment, Path(folder)) as server,
        suppress(KeyboardInterrupt),
    ):
        print(
            f"http://{server.host}/ shows the page until Ctrl-C; drop documents on it", flush=True
        )
        webbrowser.open(f"http://{server.host}/")
        server.serve_forever()
    return PASSED
