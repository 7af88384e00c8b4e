# SPDX-License-Identifier: Apache-2.0
"""`mxeon library`: print the folder of eonlib and how to use it."""

import argparse

from mxeon.cli import arguments
from mxeon.errors import PASSED


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its options."""
    summary = "print the folder of eonlib and how to use it"
    command = arguments.add_command(commands, "library", summary, run)
    command.add_argument("--folder", action="store_true", help="print the folder only")
    command.add_argument(
        "--verify", action="store_true", help="list the implementation that each target gets"
    )


def run(options: argparse.Namespace) -> int:
    """Print the folder; return the exit status."""
    from mxeon.shaders.library import eonlib_folder

    if options.folder:
        print(eonlib_folder())
    elif options.verify:
        _verify()
    else:
        _explain()
    return PASSED


def _verify() -> None:
    """Print every implementation; raise LibraryError unless all are eonlib's."""
    from mxeon.shaders.library import assert_ours, implementations, load_library

    document = load_library()
    for one in implementations(document):
        print(f"{one.node:30} {one.target:10} {one.name:40} {one.document}")
    assert_ours(document)


def _explain() -> None:
    from mxeon.shaders.library import eonlib_folder, profile_folder

    folder, cycles = eonlib_folder(), profile_folder("cycles")
    print(f"folder                      {folder}")
    print(f"generateshader              --library {folder}")
    print(f"generateshader, for Cycles  --library {cycles} {folder}")
    print(f"USD                         PXR_MTLX_PLUGIN_SEARCH_PATHS={folder}")
    print(f'C++                         loadLibraries({{"{folder}", "libraries"}}, path, document)')
