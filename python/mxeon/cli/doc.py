# SPDX-License-Identifier: Apache-2.0
"""`mxeon doc`: tables of node definitions, filled into Markdown or compared with a specification."""

import argparse
import errno
import json
import sys

from mxeon.cli import arguments
from mxeon.cli.output import warn
from mxeon.errors import FAILED, PASSED, DocumentError, InputError, one_line


def add_parser(commands: arguments.Commands) -> None:
    """Add the command and its options."""
    summary = "fill a Markdown template with the tables of nodes, or compare a specification's"
    command = arguments.add_command(commands, "doc", summary, run)
    command.add_argument(
        "file", metavar="FILE", help="Markdown; @MX_TABLE_node@ stands for the table of a node"
    )
    command.add_argument(
        "--compare",
        action="store_true",
        help="compare every table of FILE with the node definitions of the library",
    )
    command.add_argument("--output", metavar="FILE", help="write there, not to standard output")
    command.add_argument(
        "--library",
        default="stock",
        metavar="NAME",
        help="stock (the default), eonlib, or a folder of MaterialX documents to load first",
    )
    command.add_argument("--json", action="store_true", help="print the differences as JSON")


def run(options: argparse.Namespace) -> int:
    """Fill or compare; return FAILED if a specification differs."""
    from mxeon.doc import MARKER, compare, fill, library_tables, read_tables

    # Check the options, and read the text and the library.
    if options.json and not options.compare:
        raise InputError("--json must come with --compare: a template has no differences")
    arguments.assert_other(options.output, [options.file])
    text = _text(options.file)
    tables = library_tables(options.library)
    try:
        # Fill the template, unless it is to be compared.
        if not options.compare:
            if not MARKER.search(text):
                warn(f"{options.file}: there is no @MX_TABLE_node@ to fill")
            _write(fill(text, tables), options.output)
            return PASSED
        differences = compare(read_tables(text), tables)
    except DocumentError as error:
        raise DocumentError(f"{options.file}: {error}") from None
    # Write the differences.
    if options.json:
        _write(json.dumps([vars(each) for each in differences], indent=1) + "\n", options.output)
    else:
        lines = "\n".join(map(one_line, differences)) or "no difference"
        _write(lines + "\n", options.output)
    return FAILED if differences else PASSED


def _text(path: str) -> str:
    from mxeon.io.files import regular

    with open(path, encoding="utf-8", opener=regular) as file:
        try:
            return file.read()
        except UnicodeDecodeError:
            raise DocumentError(f"{path}: must be text in UTF-8") from None


def _write(text: str, path: str | None) -> None:
    from mxeon.io.files import write_text

    if path is None:
        if sys.stdout is None:
            raise OSError(errno.EBADF, "it is closed", "standard output")
        print(text, end="")
    else:
        write_text(path, text)
