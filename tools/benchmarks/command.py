# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of imports, of `mxeon --help`, and of `mxeon check` with a cold or warm cache.

Each benchmark of `mxeon check` has a separate folder for the driver's shader cache.
"""

import json
import os
import subprocess
import sys
import time
from functools import partial
from tempfile import TemporaryDirectory

import numpy as np

from tools.benchmarks.rounds import Check, Figure, Group, interleave

CACHE, FOLDER = "MESA_SHADER_CACHE_DISABLE", "MESA_SHADER_CACHE_DIR"
MEMORY = 600.0  # goal for peak memory in MiB
ONE, REPORT, BOTH = "gl, 2 workers", "gl, --report", "gl, two libraries"
# Options of `mxeon check`, and goals in seconds with a warm cache and with a cold cache.
JOBS = {
    ONE: ((), 9.0, 30.0),
    REPORT: (("--report", "{folder}/report-{turn}"), None, None),
    BOTH: (("--library", "eonlib", "--library", "stock"), None, None),
    "gl, --node all": (("--node", "all"), 25.0, 40.0),
}
# Runs a command, and prints the peak memory in KiB of the command's largest process. The launcher
# must be small, because Linux counts the launcher's memory as memory of the command.
LAUNCHER = """
import resource, subprocess, sys
status = subprocess.call(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
sys.exit(status)
"""


def timed(options, cache):
    """Run `mxeon check` with `options` and the folder `cache` for the driver's shader cache.

    Returns seconds, peak memory in MiB, and the number of failed checks. The number is infinity if
    no check passes.
    """
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
    return seconds, memory, float(counts["failed"]) if counts["passed"] else np.inf


def starting(rounds):
    """Times of imports and of `mxeon --help`, each measured in a new process."""
    codes = {
        "numpy": "import numpy",
        "mxeon": "import numpy, mxeon, mxeon.models.table",
        "help": "from mxeon.cli import main; main(['--help'])",
    }
    start = partial(subprocess.run, check=True, capture_output=True)
    runs = {name: partial(start, [sys.executable, "-c", code]) for name, code in codes.items()}
    seconds = interleave(runs, rounds)
    models = 1e3 * (seconds["mxeon"] - seconds["numpy"])
    return [
        Figure("import mxeon and its models, beyond import numpy", "ms", models, goal=30.0),
        Figure("mxeon --help", "ms", 1e3 * seconds["help"], goal=300.0),
    ]


def measure(rounds=3, jobs=tuple(JOBS)):
    figures, checks, warm = starting(4 * rounds), [], {}
    for name in jobs:
        options, goal, cold_goal = JOBS[name]
        with TemporaryDirectory() as folder:
            runs = [
                timed([each.format(folder=folder, turn=turn) for each in options], folder)
                for turn in range(rounds + 1)
            ]
        seconds, memory, failed = zip(*runs, strict=True)
        warm[name] = np.array(seconds[1:])
        figures += [
            Figure(f"{name}, the driver's cache empty", "s", [seconds[0]], cold_goal),
            Figure(name, "s", warm[name], goal),
            Figure(f"{name}, largest process", "MiB", [max(memory[1:])], MEMORY),
        ]
        if name != BOTH:  # stock MaterialX fails checks
            checks.append(Check(name, max(failed), 0.0))
    one = np.median(warm[ONE])
    if REPORT in warm:
        figures.append(Figure(f"{REPORT}, beyond one without", "s", warm[REPORT] - one, 2.0))
    if BOTH in warm:
        figures.append(Figure(f"{BOTH} / one", "x", warm[BOTH] / one, 1.6))
    return Group("The command, bundled examples", figures, checks)
