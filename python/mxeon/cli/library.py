# SPDX-License-Identifier: Apache-2.0
"""`mxeon library`: print the folder of eonlib and how to load the folder, or copy eonlib."""

import argparse
from pathlib import Path

from mxeon.cli import arguments
from mxeon.cli.output import on_one_line, show
from mxeon.errors import PASSED


def add_parser(commands: arguments.Commands) -> None:
    command = arguments.add_command(
        commands,
        "library",
        "print where eonlib is and how to load it, or export a copy",
        run,
        "library  # the folder, and a line for each renderer",
        "library --export eonlib.zip  # a copy for machines without Python",
    )
    command.add_argument("--folder", action="store_true", help="print the folder only")
    command.add_argument(
        "--export", metavar="DIR", help="write a copy to the new folder DIR, or to DIR.zip"
    )


def run(options: argparse.Namespace) -> int:
    from mxeon.shaders.library import documents_folder, eonlib_folder

    if options.export is not None:
        from mxeon.shaders.library_export import export_library

        copy = export_library(options.export)
        if copy.is_dir():
            _explain(copy, copy / "documents")
        else:
            show(copy)
    elif options.folder:
        show(eonlib_folder())
    else:
        _explain(eonlib_folder(), documents_folder())
    return PASSED


def _explain(folder: Path, documents: Path) -> None:
    """Print the folder of eonlib, and instructions for each renderer that loads the folder."""
    from mxeon.shaders.library_export import recipes

    show(f"folder                {folder}")
    show(f"diffuse nodes only    {documents / 'diffuse'}")
    print(recipes(on_one_line(folder)))
