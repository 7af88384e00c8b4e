# SPDX-License-Identifier: Apache-2.0
"""Prints messages, the summary and progress, and handles closed streams."""

from __future__ import annotations

import os
import re
import shutil
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Iterator, Sized
from io import TextIOWrapper
from typing import IO, TYPE_CHECKING, Any

from mxeon.errors import MISUSE, DocumentError, one_line, printable

if TYPE_CHECKING:
    from mxeon.conformance.results import Verdict

COLUMNS = 100  # width of a terminal if it is unknown
# ANSI codes, keyed by verdict.
COLORS: dict[str | None, int] = {"passed": 32, "failed": 31, "not run": 33}


def open_streams() -> None:
    """Open standard streams that are missing, because worker processes print to the streams.

    Characters that a stream cannot encode are printed as backslash escapes.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def flush(status: int) -> int:
    """Flush the output. Return `status`, or the status for misuse if the output is not writable."""
    try:
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        discard(sys.stdout)
        error.filename = "standard output"
        status = 141 if isinstance(error, BrokenPipeError) else status or fail(*status_of(error))
    try:
        if sys.stderr:
            sys.stderr.flush()
    except OSError:
        discard(sys.stderr)
    return status


def discard(stream: IO[str]) -> None:
    """Redirect a failed stream to the null device, so that Python can flush the stream at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def status_of(error: Exception) -> tuple[int, *tuple[str, ...]]:
    """Exit status and message lines of an error that is meant for users."""
    if isinstance(error, DocumentError):
        return error.status, *error.args
    if isinstance(error, OSError) and not hasattr(error, "status"):
        reason = error.strerror or str(error) or type(error).__name__
        rule = "must be a folder" if isinstance(error, FileExistsError) else "must be accessible"
        return MISUSE, f"{error.filename or 'file or standard output'}: {rule}; {reason}"
    return getattr(error, "status", MISUSE), str(error) or type(error).__name__


def fail(status: int, *messages: object) -> int:
    """Print each message on a line; return the exit status."""
    for message in messages:
        _print_line(one_line(message))
    return status


def show(name: object) -> None:
    """Print the name of an output file on one line."""
    print(on_one_line(name))


def on_one_line(name: object) -> str:
    """A file name on one line; U+FFFD replaces line ends and control characters."""
    return re.sub(r"[\t\n\r]", "\ufffd", printable(str(name)))


class Line(str):
    """A line of the summary, and the verdict that the line states."""

    verdict: Verdict | None

    def __new__(cls, text: str, verdict: Verdict | None = None) -> Line:
        line = super().__new__(cls, text)
        line.verdict = verdict
        return line


def wrapped(lines: Iterable[Line]) -> str:
    """The lines as text. On a terminal, lines are wrapped, and are colored by verdict."""
    if not sys.stdout.isatty():
        return printable("\n".join(lines))
    width = shutil.get_terminal_size((COLUMNS, 1)).columns
    colored = not os.environ.get("NO_COLOR")
    shown = []
    for line in lines:
        indent = " " * (len(line) - len(line.lstrip()) + 2)
        text = "\n".join(
            textwrap.wrap(
                printable(line),
                width,
                subsequent_indent=indent,
                break_long_words=False,
                break_on_hyphens=False,
            )
        )
        color = COLORS.get(line.verdict) if colored else None
        shown.append(f"\033[{color}m{text}\033[0m" if color else text)
    return "\n".join(shown)


def warn(message: object) -> None:
    _print_line(f"warning: {one_line(message)}")


def show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a Python warning, in place of `warnings.showwarning`."""
    warn(message)


def _print_line(line: str) -> None:
    """Print a line on standard error, unless standard error is closed."""
    try:
        print(f"{Progress.take()}mxeon: {line}", file=sys.stderr, flush=True)
    except OSError:
        discard(sys.stderr)


class Progress:
    """A progress line on a terminal. The function `label` returns the name of a step."""

    visible = ""  # the progress line on the terminal

    def __init__(self, title: str, label: Callable[[Any], str] = str) -> None:
        self._title, self._label = title, label
        self._open = bool(sys.stderr) and sys.stderr.isatty()

    def show(self, text: str) -> None:
        """Replace the progress line."""
        if self._open:
            columns = shutil.get_terminal_size().columns - 1
            line = one_line(f"{self._title}: {text}")[:columns]
            print(f"{self.take()}{line}", end="", file=sys.stderr, flush=True)
            Progress.visible = line

    def clear(self) -> None:
        """Erase the progress line."""
        if self._open:
            print(self.take(), end="", file=sys.stderr, flush=True)

    @classmethod
    def take(cls) -> str:
        """Forget the progress line, and return the control codes that erase the line."""
        erase = "\r\033[K" if cls.visible else ""
        cls.visible = ""
        return erase

    def __call__(self, steps: Iterable[Any], total: int | None = None) -> Iterator[Any]:
        """Iterate over the steps, and show the progress."""
        total = len(steps) if total is None and isinstance(steps, Sized) else total
        begin = 0.0
        self.show(f"0 of {total}")
        for done, step in enumerate(steps, 1):
            begin = begin or time.monotonic()  # exclude the first step, which includes the setup
            spent = (time.monotonic() - begin) / max(done - 1, 1)
            left = f", about {spent * ((total or done) - done):.0f} s left" if done > 2 else ""
            self.show(": ".join(filter(None, (f"{done} of {total}{left}", self._label(step)))))
            yield step
        if self._open:
            print(self.take(), end="", file=sys.stderr, flush=True)
