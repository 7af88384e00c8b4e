# SPDX-License-Identifier: Apache-2.0
"""`mxeon figures`: make the figures of the EON paper and measure its claims."""

import argparse

from mxeon.cli import arguments
from mxeon.cli.output import progress_bar
from mxeon.errors import PASSED


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its options."""
    summary = "make the figures of the EON paper and measure its claims"
    command = arguments.add_command(commands, "figures", summary, run)
    command.add_argument("folder", metavar="DIR", help="where to write")


def run(options: argparse.Namespace) -> int:
    """Write the figures and print the path of their page; return the exit status."""
    from mxeon.figures import figures

    print(figures(options.folder, progress_bar("mxeon figures", "figure")))
    return PASSED
