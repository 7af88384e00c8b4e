# SPDX-License-Identifier: Apache-2.0
"""Runs whose disk is full: a small tmpfs, made larger step by step. Needs root."""

import os
import subprocess
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.reliability.runs import done_twice, finished, start, verdicts, wait_for_end

SIZES = tuple(range(8, 161, 8))  # KiB: the journal alone takes some hundred
LARGE = 1 << 16  # KiB
LIMIT = 600


def measure(sizes=SIZES, progress=iter):
    """Figures of runs that met a full disk and were resumed once there was room."""
    if os.geteuid() != 0:
        return {"not_run": "a tmpfs can be made by root only"}
    tally = dict.fromkeys(("runs", "full", "one_line", "survived", "lost", "twice"), 0)
    with TemporaryDirectory(prefix="mxeon-disk-") as base:
        calm = Path(base, "calm")
        wait_for_end(start(calm), LIMIT)
        for size in progress(sizes):
            with _tmpfs(Path(base, "small"), size) as folder:
                _fill(folder, verdicts(calm), tally)
    return tally


def _fill(folder, right, tally):
    status, errors = wait_for_end(start(folder / "run"), LIMIT)
    before = finished(folder / "run")
    tally["runs"] += 1
    tally["full"] += status != 0
    tally["one_line"] += status == 2 and "No space left" in errors and "\n" not in errors
    subprocess.run(["mount", "-o", f"remount,size={LARGE}k", folder], check=True)
    wait_for_end(start(folder / "run"), LIMIT)
    found = verdicts(folder / "run")
    tally["survived"] += found == right
    tally["lost"] += len(right - found) + max(0, before - finished(folder / "run"))
    tally["twice"] += done_twice(folder / "run")


@contextmanager
def _tmpfs(folder, size):
    """A file system of `size` KiB, mounted on `folder`."""
    folder.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "mxeon", folder], check=True)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=True)
