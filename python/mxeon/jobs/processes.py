# SPDX-License-Identifier: Apache-2.0
"""Python processes that import nothing from the working folder.

Python puts the working folder first on the path of `python -c` and `python -m`, and
`multiprocessing` starts its workers with the former: a file `pickle.py` there would run.
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

HOME = str(Path(__file__).resolve().parents[2])  # the folder that mxeon is imported from
PYTHON = (sys.executable, "-P")  # opens a command line; -P keeps the working folder off the path

_patching = threading.Lock()
_util: Any = util  # contains the private function to replace


class _Process(SpawnProcess):
    def start(self) -> None:
        with safe_path():
            super().start()


class Context(SpawnContext):
    """The start method "spawn" of `multiprocessing`, whose workers have a safe path."""

    Process = _Process


@contextmanager
def safe_path() -> Iterator[None]:
    """Give the processes that `multiprocessing` starts in this block, in any thread, a safe path.

    The flag goes on the command line because PYTHONSAFEPATH has no effect together with -E. The
    Workers get the parent's path except "", its working folder if it is `python -c` or
    interactive. They inherit the working folder, which they may not be able to enter.
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
    """Remove the working folder, which `python -m` puts first, from the path, unless mxeon is there."""
    with suppress(FileNotFoundError):  # it may have been deleted
        if not sys.flags.safe_path and sys.path[0] == os.getcwd() != HOME:
            del sys.path[0]
