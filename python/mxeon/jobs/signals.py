# SPDX-License-Identifier: Apache-2.0
"""Handle the signals that end a command, which are sent by Ctrl-C, `kill`, terminals and timers."""

import os
import shutil
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from types import FrameType


def _existing(*names: str) -> tuple[signal.Signals, ...]:
    return tuple(signal.Signals[name] for name in names if hasattr(signal, name))


TERMINAL = _existing("SIGINT", "SIGHUP", "SIGBREAK")  # sent to all processes of a terminal
ENDING = (*TERMINAL, signal.SIGTERM)
# The signals in OTHERS also end a process by default.
OTHERS = _existing("SIGALRM", "SIGUSR1", "SIGUSR2", "SIGXCPU")

LOCK = ".lock"  # name of the lock file in a temporary folder
YOUNG = 60.0  # seconds; a folder that is younger may be in use and not locked yet

_pending: list[int] | None = None  # signals that arrived while signals were blocked


class SignalExit(KeyboardInterrupt):
    """An exception for a signal, which ends the command with the exit status 128 + number."""

    def __init__(self, number: int) -> None:
        ended = f"ended by {signal.Signals(number).name}"
        super().__init__("interrupted" if number == signal.SIGINT else ended)
        self.status = 128 + number


@contextmanager
def raise_signals() -> Iterator[None]:
    """Raise SignalExit when a signal would end the command, so that cleanup runs.

    Ignored signals stay ignored. For signals in OTHERS, handlers of the caller stay installed.
    """

    def end(number: int, _: FrameType | None) -> None:
        if _pending is None:
            raise SignalExit(number)
        _pending.append(number)

    # Only the main thread may install handlers.
    main = threading.current_thread() is threading.main_thread()
    numbers = [each for each in ENDING if main and signal.getsignal(each) != signal.SIG_IGN]
    numbers += [each for each in OTHERS if main and signal.getsignal(each) == signal.SIG_DFL]
    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


@contextmanager
def block_signals() -> Iterator[None]:
    """Block the signals of a terminal, so that child processes inherit the signal mask.

    SIGTERM is not blocked, because this process ends its children by SIGTERM. Signals that arrive
    in the `with` block are raised at the end of the block. Windows has no signal masks.
    """
    global _pending
    _pending = []
    if sys.platform != "win32":
        before = signal.pthread_sigmask(signal.SIG_BLOCK, TERMINAL)
    try:
        yield
    finally:
        pending, _pending = _pending, None
        if sys.platform != "win32":
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        if pending:
            raise SignalExit(pending[0])


class Temporary(TemporaryDirectory[str]):
    """A temporary folder that a later process removes if this process is killed.

    The folder contains a file that is locked as long as this process lives.
    """

    def __init__(self, prefix: str) -> None:
        from filelock import FileLock  # the import takes a tenth of a command's start time

        _remove_abandoned()
        super().__init__(prefix=prefix)
        self._lock = FileLock(os.path.join(self.name, LOCK))
        self._lock.acquire(timeout=0)

    def cleanup(self) -> None:
        self._lock.release()  # Windows cannot remove open files
        super().cleanup()


@cache
def _remove_abandoned() -> None:
    """Remove temporary folders that killed processes of the same user left behind."""
    from filelock import FileLock, Timeout

    for folder in Path(gettempdir()).glob("mxeon-*"):
        with suppress(OSError):
            if time.time() - folder.stat().st_mtime < YOUNG:
                continue
        with suppress(OSError, Timeout):
            own = not hasattr(os, "getuid") or folder.lstat().st_uid == os.getuid()
            if own and (folder / LOCK).is_file() and not folder.is_symlink():
                with FileLock(folder / LOCK, timeout=0):
                    shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def temporary_folder(prefix: str) -> Iterator[str]:
    """A temporary folder that is deleted even if a signal arrives just after its creation."""
    with ExitStack() as stack:
        with block_signals():
            folder = stack.enter_context(Temporary(prefix))
        yield folder
