# SPDX-License-Identifier: Apache-2.0
"""Start Python processes that import nothing from the working folder.

`python -c` and `python -m` put the working folder first on the import path, and `multiprocessing`
starts workers by `python -c`. Therefore, a file `pickle.py` in the working folder would be
imported.
"""

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import spawn, util
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from typing import Any

HOME = str(Path(__file__).resolve().parents[2])  # the folder from which mxeon is imported
PYTHON = (sys.executable, "-P")  # -P keeps the working folder off the import path

_patching = threading.Lock()
_util: Any = util  # the module has the private function that is replaced


class _Process(SpawnProcess):
    def start(self) -> None:
        with safe_path():
            super().start()


class Context(SpawnContext):
    """The start method "spawn" of `multiprocessing`, with a safe import path for workers."""

    Process = _Process


@contextmanager
def safe_path() -> Iterator[None]:
    """Give a safe import path to all processes that `multiprocessing` starts in the block.

    Processes that other threads start are included. The command line gets the option -P, because
    PYTHONSAFEPATH has no effect together with -E. Workers get the import path of the parent without
    "", which means the working folder in `python -c` and in interactive sessions.
    """
    path = [folder for folder in sys.path if folder]
    path = path if HOME in path else [*path, HOME]
    with _patching:
        flags, data = _util._args_from_interpreter_flags, spawn.get_preparation_data
        _util._args_from_interpreter_flags = lambda: [*flags(), "-P"]
        spawn.get_preparation_data = lambda name: (
            {key: value for key, value in data(name).items() if key != "dir"} | {"sys_path": path}
        )
        try:
            yield
        finally:
            _util._args_from_interpreter_flags, spawn.get_preparation_data = flags, data


def forget_working_folder() -> None:
    """Remove the working folder, which `python -m` adds, from the path, unless mxeon is there."""
    with suppress(FileNotFoundError):  # the working folder may have been deleted
        if not sys.flags.safe_path and sys.path[0] == os.getcwd() != HOME:
            del sys.path[0]
