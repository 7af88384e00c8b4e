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
    command = arguments.add_command(
        commands,
        "doc",
        "write tables of nodes into Markdown, or compare a specification with the library",
        run,
        "doc template.md --output nodes.md",
        "doc MaterialX.PBRSpec.md --compare",
    )
    command.add_argument(
        "file", metavar="FILE", help="Markdown, in which @MX_TABLE_node@ becomes that node's table"
    )
    command.add_argument(
        "--compare",
        action="store_true",
        help="compare the tables of FILE with the node definitions",
    )
    command.add_argument(
        "--output", metavar="FILE", help="file to write to (default: standard output)"
    )
    command.add_argument(
        "--library",
        default="stock",
        metavar="NAME",
        help="stock (default), eonlib, or a folder of MaterialX documents to load first",
    )
    command.add_argument("--json", action="store_true", help="print the differences as JSON")


def run(options: argparse.Namespace) -> int:
    """Fill or compare; return FAILED if a specification differs."""
    from mxeon.doc import MARKER, compare, fill, library_tables, read_tables
    from mxeon.io.files import check_output, regular

    if options.json and not options.compare:
        raise InputError("--json must come with --compare: a template has no differences")
    if options.output is not None:
        check_output(options.output, arguments.inputs(options, [], options.file))
    with open(options.file, encoding="utf-8", opener=regular) as file:
        try:
            text = file.read()
        except UnicodeDecodeError:
            raise DocumentError(f"{options.file}: must be text in UTF-8") from None
    tables = library_tables(options.library)
    try:
        if not options.compare:
            if not MARKER.search(text):
                warn(f"{options.file}: there is no @MX_TABLE_node@ to fill")
            _write(fill(text, tables), options.output)
            return PASSED
        differences = compare(read_tables(text), tables)
    except DocumentError as error:
        raise DocumentError(f"{options.file}: {error}") from None
    if options.json:
        _write(json.dumps([vars(each) for each in differences], indent=1) + "\n", options.output)
    else:
        lines = "\n".join(map(one_line, differences)) or "no difference"
        _write(lines + "\n", options.output)
    return FAILED if differences else PASSED


def _write(text: str, path: str | None) -> None:
    from mxeon.io.files import write_text

    if path is None:
        if sys.stdout is None:
            raise OSError(errno.EBADF, "it is closed", "standard output")
        print(text, end="")
    else:
        write_text(path, text)
