# SPDX-License-Identifier: Apache-2.0
"""Command-line arguments that several sub-commands have."""

import argparse
import itertools
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import Any, NoReturn

from mxeon.errors import MISUSE, InputError, assert_known, one_line
from mxeon.jobs import TIMEOUT
from mxeon.names import meant
from mxeon.shaders.document.policy import LIMITS, SEARCH_PATH, Policy, environment_path

STATUS = "Exit status: 0 all passed, 1 a check failed, 2 misuse, 3 something did not run."
LIBRARY = (
    "eonlib (the default), stock, or a folder: MaterialX's libraries or a part of them, which it replaces, "
    "or others, which are loaded first"
)

MATERIALX = "MXEON_MATERIALX"  # names the folder of --materialx to processes of hosts

Commands = Any  # what `add_subparsers` returns; argparse keeps its type private
Run = Callable[[argparse.Namespace], int]


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, with the command or the option that was meant."""

    def __init__(self, **options: Any) -> None:
        super().__init__(epilog=STATUS, **options)

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """As argparse's, but an unknown option goes first, and a missing command prints help."""
        words = list(sys.argv[1:] if args is None else args)
        is_command = self.get_default("run") is not None  # no group of commands
        if not (words or is_command):
            self.print_help()
            self.error("must be followed by one of the commands above; got none")
        known = self._option_string_actions
        for word in itertools.takewhile("--".__ne__, words):
            if not (is_command or word.startswith("-")):
                break
            name = word.partition("=")[0]
            if (
                name[:2] == "--"
                and " " not in name
                and not any(each.startswith(name) for each in known)
            ):
                rule = f"option must be one that {self.prog} --help lists"
                self.error(f"{rule}; got {name!r}{meant(name, known)}")
        return super().parse_known_args(words, namespace)

    def _check_value(self, action: argparse.Action, value: object) -> None:
        if action.choices is not None:
            assert_known(str(action.metavar or action.dest).lower(), value, action.choices)

    def error(self, message: str) -> NoReturn:
        self.exit(MISUSE, f"{self.prog}: {one_line(message)}\n")


def add_command(commands: Commands, name: str, summary: str, run: Run) -> argparse.ArgumentParser:
    """Add a command, or an action of one, that the function `run` executes."""
    command: argparse.ArgumentParser = commands.add_parser(name, help=summary, description=summary)
    command.set_defaults(run=run)
    return command


def add_json(command: argparse.ArgumentParser) -> None:
    """Add --json."""
    command.add_argument("--json", action="store_true", help="print JSON for machines")


def add_report(command: argparse.ArgumentParser) -> None:
    """Add --report."""
    command.add_argument(
        "--report", metavar="DIR", help="write a page, JSON, JUnit and the pictures to DIR"
    )


def add_full(command: argparse.ArgumentParser) -> None:
    """Add --full."""
    command.add_argument("--full", action="store_true", help="print every check, not ten lines")


def add_library(command: argparse.ArgumentParser) -> None:
    """Add --library, of which there may be one."""
    command.add_argument("--library", default="eonlib", metavar="NAME", help=LIBRARY)


def add_materialx(command: argparse.ArgumentParser) -> None:
    """Add --materialx."""
    command.add_argument(
        "--materialx",
        type=_folder,
        metavar="FOLDER",
        help="use the build of MaterialX whose Python package, MaterialX/, is in FOLDER",
    )


def use_materialx(folder: str | None) -> None:
    """Import MaterialX from a folder, here and in worker processes, unless it is None.

    Raises
    ------
    InputError
        If it is not there or cannot be imported, or another one was imported before.
    """
    if folder is None:
        return
    folder = os.path.abspath(folder)
    rule = f"--materialx {folder}: must hold the package MaterialX/ of a build for this Python"
    if not os.path.isfile(os.path.join(folder, "MaterialX", "__init__.py")):
        raise InputError(f"{rule}; there is no MaterialX/__init__.py")
    if known := sys.modules.get("MaterialX"):
        raise InputError(
            f"{rule}, the first that a process imports; it has imported {known.__file__}"
        )
    sys.path.insert(0, folder)
    os.environ[MATERIALX] = folder
    try:
        import_module("MaterialX")
    except ImportError as error:
        raise InputError(f"{rule}; {error}") from None


def add_workers(command: argparse.ArgumentParser) -> None:
    """Add --workers and --timeout."""
    command.add_argument(
        "--workers",
        type=int,
        default=os.cpu_count(),
        metavar="N",
        help="number of worker processes; 0 runs in-process",
    )
    command.add_argument(
        "--timeout",
        type=float,
        default=TIMEOUT,
        metavar="SECONDS",
        help=f"timeout of one item of work in a worker process; {TIMEOUT:g}",
    )
    command.add_argument(  # its name in version 0.1
        "--limit",
        dest="timeout",
        type=float,
        default=argparse.SUPPRESS,
        help=argparse.SUPPRESS,
    )


def assert_other(output: str | None, files: Iterable[str | None]) -> None:
    """Raise InputError if an output would replace one of the files that are read for it."""
    there = [file for file in (output, *files) if file and os.path.exists(file)]
    if there[:1] == [output] and any(os.path.samefile(there[0], file) for file in there[1:]):
        raise InputError(f"output must be another file than the one to read; got {output}")


def assert_no_link(output: str) -> None:
    """Raise InputError if an output is a link, through which another file would be replaced."""
    if os.path.islink(output):
        raise InputError(f"output must be no link, through which a file is replaced; got {output}")


def add_policy(command: argparse.ArgumentParser, runs_code: bool = False, **defaults: int) -> None:
    """Add the options of `mxeon.shaders.document.policy`, with defaults of the command's own.

    --allowCode is added where code would run.
    """
    command.add_argument(
        "--path",
        action="append",
        type=_folder,
        default=[],
        metavar="FOLDER",
        help="search it for the files that documents name, after their own folders and before "
        f"those of {SEARCH_PATH}; may be repeated",
    )
    add_definitions(command)
    group = command.add_argument_group("documents that are not trusted")
    group.add_argument(
        "--allowOutside",
        action="store_true",
        help="permit files outside the documents' folders, the search path and the libraries",
    )
    if runs_code:
        group.add_argument(
            "--allowCode",
            action="store_true",
            help="permit running shader code that documents contain",
        )
    for name, meaning in LIMITS.items():
        limit = defaults.get(name, getattr(Policy, name))
        group.add_argument(
            f"--max{name.capitalize()}",
            type=int,
            default=limit,
            metavar="N",
            help=f"{meaning}; {limit}",
        )


def add_definitions(command: argparse.ArgumentParser) -> None:
    """Add --definitions."""
    command.add_argument(
        "--definitions",
        action="append",
        type=_folder,
        default=[],
        metavar="FOLDER",
        help="load the MaterialX definitions in it beside the library, which are trusted as that is; "
        "may be repeated",
    )


def _folder(name: str) -> str:
    """The name of a folder that exists."""
    if not os.path.isdir(name):
        raise argparse.ArgumentTypeError(f"must name a folder that exists; got {name!r}")
    return name


def policy(options: argparse.Namespace) -> Policy:
    """The policy for documents that the options describe."""
    limits = {name: getattr(options, f"max{name.capitalize()}") for name in LIMITS}
    path = (*map(os.path.abspath, options.path), *environment_path())
    code = getattr(options, "allowCode", True)
    return Policy(options.allowOutside, code, path, definitions(options), **limits)


def definitions(options: argparse.Namespace) -> tuple[str, ...]:
    """The folders of --definitions, as absolute paths."""
    return tuple(map(os.path.abspath, options.definitions))
