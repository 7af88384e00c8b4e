# SPDX-License-Identifier: Apache-2.0
"""Messages on standard error, progress, and streams that take no more."""

import os
import sys
from collections.abc import Callable, Iterable
from typing import IO, Any

from mxeon.errors import MISUSE, one_line


def open_streams() -> None:
    """Open the standard streams that the process was started without: workers print to them."""
    for stream in range(3):
        try:
            os.fstat(stream)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)


def flush(status: int) -> int:
    """The exit status once all output is written; misuse if that fails."""
    # Write what standard output still holds; its failure is the status.
    try:
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        discard(sys.stdout)
        error.filename = "standard output"
        status = 141 if isinstance(error, BrokenPipeError) else status or fail(*status_of(error))
    # Write what standard error still holds; nobody can be told of a failure.
    try:
        if sys.stderr:
            sys.stderr.flush()
    except OSError:
        discard(sys.stderr)
    return status


def discard(stream: IO[str]) -> None:
    """Redirect a stream that failed to nothing, else it fails again when Python ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def status_of(error: Exception) -> tuple[int, str]:
    """Exit status and message of an error that has words for the user."""
    if isinstance(error, OSError) and not hasattr(error, "status"):
        reason = error.strerror or str(error) or type(error).__name__
        return MISUSE, f"{error.filename or 'file'}: must be accessible; {reason}"
    return getattr(error, "status", MISUSE), str(error) or type(error).__name__


def fail(status: int, message: object) -> int:
    """Print a message; return the exit status."""
    _print_line(one_line(message))
    return status


def warn(message: object) -> None:
    """Print a warning."""
    _print_line(f"warning: {one_line(message)}")


def show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning of Python's; see `warnings.showwarning`."""
    warn(message)


def _print_line(line: str) -> None:
    """Print a line on standard error, unless that takes none."""
    try:
        print(f"mxeon: {line}", file=sys.stderr, flush=True)
    except OSError:
        discard(sys.stderr)


def progress_bar(title: str, unit: str = "step") -> Callable[..., Iterable[Any]]:
    """A function that shows a bar while an iterable is consumed, if stderr is a terminal."""
    from tqdm import tqdm

    def progress(steps: Iterable[Any], total: int | None = None) -> Iterable[Any]:
        bar: Iterable[Any] = tqdm(
            steps, desc=title, total=total, unit=unit, disable=None, leave=False
        )
        return bar

    return progress
