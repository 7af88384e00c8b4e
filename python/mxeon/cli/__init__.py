# SPDX-License-Identifier: Apache-2.0
"""The command `mxeon`, with one module per sub-command.

Sub-commands import packages only when they run, so that `mxeon --help` is fast.
"""

import argparse
import re
import sys
import traceback
import warnings
from collections.abc import Sequence

import mxeon
from mxeon.cli import check, explore, generate, invert, kit, library, render, report
from mxeon.cli.arguments import Parser, use_materialx
from mxeon.cli.output import discard, fail, flush, open_streams, show_warning, status_of
from mxeon.errors import NOT_RUN, InputError, MxeonError, NotRun
from mxeon.jobs.signals import SignalExit, raise_signals

DESCRIPTION = (
    "Check renderers against MaterialX's specification of physically based shading, and get "
    "eonlib, a drop-in replacement for MaterialX's BSDF shaders."
)
EXAMPLES = (
    "check my.mtlx  # what renders wrong, and why",
    "explore my.mtlx --output my.html  # draw and compare them in a browser",
    "library  # how to load eonlib in your renderer",
)
LEAST_MEMORY = 2**28  # bytes of address space; with less, OpenBLAS aborts the process
COMMANDS = (check, generate, render, explore, library, invert, report, kit)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; `arguments` default to the command line.

    Returns 0 if all passed, 1 if a check failed, 2 for misuse, 3 if something did not run, and 128
    plus the number of a signal that ended the command.
    """
    open_streams()
    try:
        with raise_signals():
            return flush(_run(sys.argv[1:] if arguments is None else arguments))
    except SignalExit as end:
        return fail(end.status, end)


def parser() -> argparse.ArgumentParser:
    """The command's argument parser. Parsed arguments have the function to call as `run`."""
    root = Parser(prog="mxeon", description=DESCRIPTION, examples=EXAMPLES)
    root.add_argument("--version", action="version", version=f"mxeon {mxeon.__version__}")
    commands = root.add_subparsers(required=True, title="commands", metavar="COMMAND")
    for command in COMMANDS:
        command.add_parser(commands)
    return root


def _run(arguments: Sequence[str]) -> int:
    """Run the command and return the exit status; print a reason for any status except 0."""
    try:
        _check_encoding(arguments)
        options = parser().parse_args(arguments)
        _check_memory()
        use_materialx(getattr(options, "materialx", None))
        with warnings.catch_warnings():
            warnings.showwarning = show_warning
            return int(options.run(options))
    except SystemExit as end:  # the parser has printed the reason
        return int(end.code or 0)
    except BrokenPipeError:  # the reader of the output has closed the pipe
        discard(sys.stdout)
        return 141  # the status of a program that SIGPIPE ends
    except (MxeonError, OSError) as error:
        return fail(*status_of(error))
    except MemoryError:
        return fail(NOT_RUN, "memory must suffice for the work; none is left")
    except Exception:  # a bug in mxeon
        traceback.print_exc()
        return NOT_RUN


def _check_memory() -> None:
    """Raise NotRun if a process limit leaves too little memory; Windows has no such limit."""
    if sys.platform == "win32":
        return
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit != resource.RLIM_INFINITY and limit < LEAST_MEMORY:
        rule = f"address space must be at least {LEAST_MEMORY} bytes; got {limit}"
        raise NotRun(f"{rule}: raise it with ulimit -v")


def _check_encoding(arguments: Sequence[str]) -> None:
    """Raise InputError unless all arguments are text that C++ libraries accept as file names."""
    for argument in arguments:
        try:
            argument.encode()
        except UnicodeEncodeError:
            raise InputError(f"arguments and file names must be UTF-8; got {argument!r}") from None
        if "\0" in argument:  # only Python can pass such an argument; a shell cannot
            raise InputError(f"arguments must have no null character; got {argument!r}")
        if not argument or re.fullmatch("--[^=]+=", argument):
            raise InputError(f"arguments must not be empty; got {' '.join(map(repr, arguments))}")
