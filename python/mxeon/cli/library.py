# SPDX-License-Identifier: Apache-2.0
"""`mxeon library`: print the folder of eonlib and how to load it, or copy it."""

import argparse

from mxeon.cli import arguments
from mxeon.errors import PASSED


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its options."""
    summary = "print the folder of eonlib and how to load it, or copy it"
    command = arguments.add_command(commands, "library", summary, run)
    command.add_argument("--folder", action="store_true", help="print the folder only")
    command.add_argument(
        "--verify", action="store_true", help="list the implementation that each target gets"
    )
    help_text = (
        "write eonlib, its sources and license to the new folder DIR, or to an archive DIR.zip"
    )
    command.add_argument("--export", metavar="DIR", help=help_text)


def run(options: argparse.Namespace) -> int:
    """Print the folder, or write a copy; return the exit status."""
    from mxeon.shaders.library import eonlib_folder

    if options.export is not None:
        from mxeon.shaders.library_export import export_library

        print(export_library(options.export))
    elif options.folder:
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

    # Say where it lies.
    folder, cycles = eonlib_folder(), profile_folder("cycles")
    search = "mx.getDefaultDataSearchPath()"
    print(f"folder                {folder}")
    print(f"diffuse nodes alone   {folder / 'diffuse'}")
    # Say how each client loads it.
    print(f'Python                mx.loadLibraries(["{folder}", "libraries"], {search}, library)')
    search = search.replace(".", "::")
    print(
        f'C++                   mx::loadLibraries({{"{folder}", "libraries"}}, {search}, library);'
    )
    print(f"generateshader        generateshader.py --library {folder} --target glsl FILE")
    print(f"MaterialX's viewer    MaterialXView --library {folder}")
    print(f"USD                   export PXR_MTLX_PLUGIN_SEARCH_PATHS={folder}")
    print(f"Blender's Cycles      generateshader.py --library {cycles} {folder} --target osl FILE")
