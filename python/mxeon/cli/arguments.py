# SPDX-License-Identifier: Apache-2.0
"""The argument parser, and options that several commands share."""

import argparse
import itertools
import os
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from importlib import import_module
from typing import Any, NoReturn

from mxeon.errors import MISUSE, InputError, assert_known, one_line
from mxeon.io.files import AnyPath
from mxeon.jobs import TIMEOUT
from mxeon.names import meant
from mxeon.shaders.document.policy import LIMITS, SEARCH_PATH, Policy, environment_path
from mxeon.shaders.methods import CHOICES, OPTIONS, Methods

STATUS = """exit status: 0 success, 1 a check, a comparison or a shader failed, 2 misuse or bad
input, 3 something did not run; if several apply, the first of 2, 1 and 3"""
UNTRUSTED = "documents you do not trust"  # heading of the options that --help-limits lists
LIBRARY = (
    "eonlib (default), stock, or a folder. A copy of MaterialX's libraries, whole or in part, "
    "replaces the installed files; any other folder is loaded before them"
)

# Environment variable that passes the folder of --materialx to host processes.
MATERIALX = "MXEON_MATERIALX"

Commands = Any  # result of `add_subparsers`, whose type is private
Run = Callable[[argparse.Namespace], int]


class _Format(argparse.RawDescriptionHelpFormatter):
    """Help formatter that does not break names such as cycles-native at hyphens."""

    def _split_lines(self, text: str, width: int) -> list[str]:
        return textwrap.wrap(text, width, break_on_hyphens=False)


class Parser(argparse.ArgumentParser):
    """An argument parser with short help and one-line errors."""

    def __init__(self, *, examples: Sequence[str] = (), **options: Any) -> None:
        rows = [each.partition("  # ") for each in examples]
        width = max((len(command) for command, _, why in rows if why), default=0)
        lines = [
            f"  mxeon {command:{width if why else 0}}{mark}{why}" for command, mark, why in rows
        ]
        epilog = "\n".join(["examples:", *lines, "", STATUS])
        super().__init__(epilog=epilog, formatter_class=_Format, **options)

    def format_help(self, limits: bool = False) -> str:
        """Help on the options for untrusted documents (with `limits`) or on all other options."""
        help = self._get_formatter()
        if not limits:
            help.add_text(textwrap.fill(self.description or "", 79))
            needed = [each for each in self._actions if each.required or not each.option_strings]
            optional = argparse.Action([], "options", nargs="?", metavar="options")
            help.add_usage(None, [optional, *needed], [])
        for group in self._action_groups:
            if (group.title == UNTRUSTED) == limits:
                help.start_section(group.title)
                help.add_arguments(group._group_actions)
                help.end_section()
        if not limits:
            help.add_text(self.epilog)
        return help.format_help()

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Report unknown options before other errors, and print help if the command is missing."""
        words = list(sys.argv[1:] if args is None else args)
        # A command with actions, such as `report`, has no function to run.
        is_command = self.get_default("run") is not None
        if not (words or is_command):
            self.print_help()
            self.error("choose a command")
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


class _HelpLimits(argparse.Action):
    """Print the options for untrusted documents, and exit."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        assert isinstance(parser, Parser)
        print(parser.format_help(limits=True), end="")
        parser.exit()


def add_command(
    commands: Commands, name: str, summary: str, run: Run | None, *examples: str
) -> argparse.ArgumentParser:
    """Add a command, or an action of a command. `run` is None for a command that has actions."""
    sentence = f"{summary[0].upper()}{summary[1:]}."
    command: argparse.ArgumentParser = commands.add_parser(
        name, help=summary, description=sentence, examples=examples
    )
    command.set_defaults(run=run)
    return command


def _folder(name: str) -> str:
    if not os.path.isdir(name):
        raise argparse.ArgumentTypeError(f"must name a folder that exists; got {name!r}")
    return name


# Options shared by several commands.
SHARED: Mapping[str, Mapping[str, Any]] = {
    "--json": {"action": "store_true", "help": "print JSON"},
    "--report": {
        "metavar": "DIR",
        "help": "write an HTML page, JSON, JUnit XML and pictures to DIR",
    },
    "--full": {"action": "store_true", "help": "print every check, not a summary"},
    "--library": {"default": "eonlib", "metavar": "NAME", "help": LIBRARY},
    "--materialx": {
        "type": _folder,
        "metavar": "FOLDER",
        "help": "use your own build of MaterialX; FOLDER holds its Python package, MaterialX/",
    },
    "--workers": {
        "type": int,
        "default": os.cpu_count(),
        "metavar": "N",
        "help": "number of worker processes (default: one per core; 0: none, run in this process)",
    },
    "--timeout": {
        "type": float,
        "default": TIMEOUT,
        "metavar": "SECONDS",
        "help": "stop a worker that takes longer than SECONDS for one item (default: %(default)g)",
    },
    "--definitions": {
        "action": "append",
        "type": _folder,
        "default": [],
        "metavar": "FOLDER",
        "help": "load the MaterialX definitions in FOLDER in addition to the library; they are "
        "trusted like the library; repeatable",
    },
}


def add_shared(command: argparse.ArgumentParser, *names: str) -> None:
    for name in names:
        command.add_argument(name, **SHARED[name])


def use_materialx(folder: str | None) -> None:
    """Import MaterialX from a folder, in this process and in worker processes; None has no effect.

    Raises InputError if the folder has no MaterialX that can be imported, or if another MaterialX
    was imported before.
    """
    if folder is None:
        return
    folder = os.path.abspath(folder)
    rule = f"--materialx {folder}: must hold the package MaterialX/ of a build for this Python"
    if not os.path.isfile(os.path.join(folder, "MaterialX", "__init__.py")):
        raise InputError(f"{rule}; there is no MaterialX/__init__.py")
    if known := sys.modules.get("MaterialX"):
        raise InputError(f"{rule}; this process has already imported {known.__file__}")
    sys.path.insert(0, folder)
    os.environ[MATERIALX] = folder
    try:
        import_module("MaterialX")
    except ImportError as error:
        raise InputError(f"{rule}; {error}") from None


def inputs(
    options: argparse.Namespace, documents: Sequence[str] = (), *others: AnyPath | None
) -> Iterator[AnyPath]:
    """Files that a command may read and therefore must not replace."""
    from mxeon.shaders.document.references import files_read

    yield from filter(None, others)
    known = policy(options) if "path" in options else Policy()
    yield from files_read(documents, known, [options.library]).values()


def add_policy(command: argparse.ArgumentParser, runs_code: bool = False, **defaults: int) -> None:
    """Add the options of `mxeon.shaders.document.policy`, but --allowCode only if `runs_code`."""
    command.add_argument(
        "--path",
        action="append",
        type=_folder,
        default=[],
        metavar="FOLDER",
        help="also look here for images and includes, after the document's own folder and "
        f"before the folders in ${SEARCH_PATH}; repeatable",
    )
    add_shared(command, "--definitions")
    command.add_argument(
        "--help-limits",
        action=_HelpLimits,
        nargs=0,
        help="list the options for documents you do not trust: permissions and size limits",
    )
    group = command.add_argument_group(UNTRUSTED)
    group.add_argument(
        "--allowOutside",
        action="store_true",
        help="let documents read files outside their folder, the search path and the libraries",
    )
    if runs_code:
        group.add_argument(
            "--allowCode", action="store_true", help="run shader code that documents contain"
        )
    for name, meaning in LIMITS.items():
        group.add_argument(
            f"--max{name.capitalize()}",
            type=int,
            default=defaults.get(name, getattr(Policy, name)),
            metavar="N",
            help=f"at most N {meaning} (default: %(default)s)",
        )


METHODS = "methods of generated shaders"  # heading of the options of `add_methods`
HELP = {
    "environment": "how reflections of an environment are computed",
    "transmission": "what is seen through a surface, the refracted environment or the background",
    "albedo": "how MaterialX's own functions find albedos",
}


def add_methods(command: argparse.ArgumentParser) -> None:
    """Add the options that set `mxeon.shaders.methods.Methods`."""
    group = command.add_argument_group(METHODS)
    for name, choices in CHOICES.items():
        words = f"{HELP[name]}: {', '.join(choices)}"
        group.add_argument(OPTIONS[name], default="", metavar="NAME", help=words, dest=name)
    words = "iterations in MaterialX's own thin-film code"
    group.add_argument(OPTIONS["airy"], type=int, default=0, metavar="N", help=words, dest="airy")
    for name, words in (
        ("premultiplied", "whether mix multiplies its lobes' weights by its own weight"),
        ("distributed", "whether to distribute layer over mix"),
        ("searched", "whether to search the library's genglsl/environment first"),
    ):
        action = argparse.BooleanOptionalAction
        group.add_argument(OPTIONS[name], action=action, help=words, dest=name)


def methods(options: argparse.Namespace) -> Methods:
    return Methods(**{each.name: getattr(options, each.name) for each in fields(Methods)})


def policy(options: argparse.Namespace) -> Policy:
    limits = {name: getattr(options, f"max{name.capitalize()}") for name in LIMITS}
    path = (*map(os.path.abspath, options.path), *environment_path())
    code = getattr(options, "allowCode", True)
    return Policy(options.allowOutside, code, path, definitions(options), **limits)


def definitions(options: argparse.Namespace) -> tuple[str, ...]:
    return tuple(map(os.path.abspath, options.definitions))
