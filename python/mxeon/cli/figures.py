# SPDX-License-Identifier: Apache-2.0
"""`mxeon figures`: make the figures of the EON paper and measure its claims, in a checkout.

They are in the folder `tools/paper` of the repository, which the wheel does not contain.
"""

import argparse
import sys

from mxeon.cli import arguments
from mxeon.cli.output import Progress, show
from mxeon.errors import PASSED, NotRun


def add_parser(commands: arguments.Commands) -> None:
    summary = "make the EON paper's figures and measure its claims (needs a checkout)"
    command = arguments.add_command(commands, "figures", summary, run, "figures out/figures")
    command.add_argument("folder", metavar="DIR", help="folder to write to")


def run(options: argparse.Namespace) -> int:
    """Write the figures and print the path of their page; return the exit status."""
    from mxeon.io.files import check_output
    from mxeon.shaders.document.policy import Policy
    from mxeon.shaders.document.references import files_read
    from mxeon.shaders.library import data_folder

    checkout = data_folder()
    if not (checkout / "tools" / "paper" / "__init__.py").is_file():
        raise NotRun(
            "figures: they are not part of the wheel; "
            "install a checkout of the repository: pip install --editable '.[report]'"
        )
    names = ["figures/*", "paper_checked.md"]
    check_output(options.folder, files_read([], Policy()).values(), replaced=names)
    sys.path.append(str(checkout))  # as the last folder, which hides no package
    from tools.paper import figures

    show(figures(options.folder, Progress("mxeon figures", lambda _: "")))
    return PASSED
