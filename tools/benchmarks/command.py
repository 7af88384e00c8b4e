# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the command line: imports, `--help`, and `mxeon check` with a cold or warm cache.

Each row of JOBS has its own folder for the driver's shader cache, so rows do not affect each other.
"""

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import partial
from tempfile import TemporaryDirectory

import numpy as np

from tools.benchmarks.rounds import Check, Group, figure, interleave

CACHE, FOLDER = "MESA_SHADER_CACHE_DISABLE", "MESA_SHADER_CACHE_DIR"
MEMORY = 600.0  # goal for peak memory in MiB
ONE, REPORT, BOTH = "gl, 2 workers", "gl, --report", "gl, two libraries"
# Options of `mxeon check`, goal in seconds with a warm cache, goal in seconds with a cold cache.
JOBS = {
    ONE: ((), 9.0, 30.0),
    REPORT: (("--report", "{folder}/report-{turn}"), None, None),
    BOTH: (("--library", "eonlib", "--library", "stock"), None, None),
    "gl, --node all": (("--node", "all"), 25.0, 40.0),
}
# Starts the command, and prints the peak memory of its largest process in KiB. This launcher must
# be small: Linux counts the memory of the starting process as the program's.
LAUNCHER = """
import resource, subprocess, sys
status = subprocess.call(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
sys.exit(status)
"""


@dataclass(frozen=True)
class Job:
    """Duration of a run in seconds, its peak memory in MiB, and its number of failed checks."""

    seconds: float
    memory: float
    wrong: float


def job(options, cache):
    """Run `mxeon check` with the given options and folder for the driver's shader cache."""
    environment = {name: value for name, value in os.environ.items() if name != CACHE}
    command = [sys.executable, "-P", "-m", "mxeon", "check", "--json", "--workers", "2", *options]
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-ISc", LAUNCHER, *command],
        env=environment | {FOLDER: cache},
        capture_output=True,
        text=True,
    )
    seconds = time.perf_counter() - start
    if not done.stdout:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    counts = json.loads(done.stdout)["counts"]
    memory = float(done.stderr.splitlines()[-1]) / 1024.0
    return Job(seconds, memory, float(counts["failed"]) if counts["passed"] else np.inf)


def starting(rounds):
    """Times of imports and of `mxeon --help`, each in a new process."""
    codes = {
        "numpy": "import numpy",
        "mxeon": "import numpy, mxeon, mxeon.models.table",
        "help": "from mxeon.cli import main; main(['--help'])",
    }
    start = partial(subprocess.run, check=True, capture_output=True)
    rivals = {name: partial(start, [sys.executable, "-c", code]) for name, code in codes.items()}
    seconds = interleave(rivals, rounds)
    over = 1e3 * (seconds["mxeon"] - seconds["numpy"])
    return [
        figure("import mxeon and its models, beyond import numpy", "ms", over, goal=30.0),
        figure("mxeon --help", "ms", 1e3 * seconds["help"], goal=300.0),
    ]


def measure(rounds=3, jobs=tuple(JOBS)):
    figures, checks, usual = starting(4 * rounds), [], {}
    for name in jobs:
        options, goal, empty = JOBS[name]
        with TemporaryDirectory() as folder:
            first, *runs = (
                job([each.format(folder=folder, turn=turn) for each in options], folder)
                for turn in range(rounds + 1)
            )
        usual[name] = np.array([each.seconds for each in runs])
        figures += [
            figure(f"{name}, the driver's cache empty", "s", [first.seconds], empty),
            figure(name, "s", usual[name], goal),
            figure(f"{name}, largest process", "MiB", [max(each.memory for each in runs)], MEMORY),
        ]
        if name != BOTH:  # failures are expected with stock MaterialX
            checks.append(Check(name, max(each.wrong for each in (first, *runs)), 0.0))
    one = np.median(usual[ONE])
    if REPORT in usual:
        figures.append(figure(f"{REPORT}, beyond one without", "s", usual[REPORT] - one, 2.0))
    if BOTH in usual:
        figures.append(figure(f"{BOTH} / one", "x", usual[BOTH] / one, 1.6))
    return Group("The command, bundled examples", tuple(figures), tuple(checks))
