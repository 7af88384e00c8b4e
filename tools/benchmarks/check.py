# SPDX-License-Identifier: Apache-2.0
"""`mxeon check` as a user starts it: time and memory, with and without Mesa's cache of compiled shaders.

This benchmark has its own cache folders, so that rows do not depend on earlier runs.
"""

import json
import os
import statistics
import sys
import time
from dataclasses import dataclass
from subprocess import PIPE, Popen, TimeoutExpired
from tempfile import NamedTemporaryFile, TemporaryDirectory

import numpy as np

from mxeon.hosts import HOSTS
from mxeon.survey import ROWS
from tools.benchmarks.rounds import Check, Group, figure
from tools.site.field import DIFFUSE, EXAMPLE

BOTH = ("--library", "eonlib", "--library", "stock")
# The checks of tools/site/field.py: the diffuse nodes on hosts, and the common nodes of renderers.
FIELD = {
    "hosts": ([row.name for row in HOSTS if not row.needs], DIFFUSE),
    "renderers": ([row.name for row in ROWS], ("common",)),
}
LONGEST = 240.0  # time limit in seconds for each half of the field
CACHE, FOLDER = "MESA_SHADER_CACHE_DISABLE", "MESA_SHADER_CACHE_DIR"
MEMORY = 600.0  # MiB
# Starts the command, and writes the KiB of its largest process to a file. It must be small: Linux counts the memory of the
# starting process as the program's.
LAUNCHER = """
import os, resource, signal, sys
child = os.spawnv(os.P_NOWAIT, sys.argv[2], sys.argv[2:])
signal.signal(signal.SIGTERM, lambda *_: os.kill(child, signal.SIGTERM))
_, status = os.waitpid(child, 0)
with open(sys.argv[1], "w") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(os.waitstatus_to_exitcode(status))
"""


@dataclass(frozen=True)
class Job:
    """Seconds and MiB of one run, the number of failures, and whether it was stopped."""

    seconds: float
    memory: float
    wrong: float
    stopped: bool = False


def job(*options, cache=None, longest=None):
    """Run the command with options; `cache` is the driver's folder, and `longest` the maximum number of seconds."""
    environment = {name: value for name, value in os.environ.items() if name != CACHE}
    environment |= {} if cache is None else {FOLDER: str(cache)}
    command = [sys.executable, "-P", "-m", "mxeon", "check", "--json", *options]
    with NamedTemporaryFile() as size:
        start = time.perf_counter()
        launch = [sys.executable, "-ISc", LAUNCHER, size.name, *command]
        process = Popen(launch, stdout=PIPE, stderr=PIPE, text=True, env=environment)
        stopped = False
        try:
            text, errors = process.communicate(timeout=longest)
        except TimeoutExpired:
            stopped = True
            process.terminate()
            process.communicate()
        seconds = time.perf_counter() - start
        memory = float(size.read() or 0.0) / 1024.0
    if stopped:
        return Job(seconds, memory, np.inf, True)
    if not text:
        raise RuntimeError(f"{' '.join(command)}: {errors.strip()}")
    counts = json.loads(text)["counts"]
    wrong = np.inf if not counts["passed"] else float(counts["failed"])
    return Job(seconds, memory, wrong)


def memory(name, jobs, goal=None):
    return figure(f"{name}, largest process", "MiB", [max(each.memory for each in jobs)], goal)


def parts(rounds, files, whole, cache):
    """Figures and checks of the main job, and of further jobs if `whole`."""
    words = (*files, "--workers", "2")
    # Check the examples on gl, with an empty cache and again.
    jobs = [job(*words, cache=cache) for _ in range(rounds + 1)]
    seconds = [each.seconds for each in jobs]
    usual = statistics.median(seconds[1:])
    yield (
        [
            figure("gl, 2 workers", "s", seconds[1:], goal=9.0),
            figure("gl, the driver's cache empty", "s", seconds[:1], goal=30.0),
            memory("gl", jobs, MEMORY),
        ],
        [Check("gl", max(each.wrong for each in jobs), 0.0)],
    )
    if not whole:
        return
    # Write a report, then run the same check with --resume.
    first, again = [], []
    for _ in range(rounds):
        with TemporaryDirectory() as folder:
            first.append(job(*words, "--report", folder, cache=cache))
            again.append(job(*words, "--report", folder, "--resume", cache=cache))
    beyond = [each.seconds - usual for each in first]
    yield (
        [
            figure("gl, beyond that with --report", "s", beyond, goal=2.0),
            figure("gl, again with --resume", "s", [each.seconds for each in again], goal=5.0),
            memory("gl, --report", first, MEMORY),
        ],
        [],
    )
    # Check two libraries, after a run that fills the cache.
    jobs = [job(*words, *BOTH, cache=cache) for _ in range(rounds + 1)][1:]
    share = [each.seconds / usual for each in jobs]
    yield (
        [
            figure("gl, two libraries / one", "x", share, 1.6),
            memory("gl, two libraries", jobs, MEMORY),
        ],
        [],
    )
    # Check all nodes, with an empty cache and again.
    with TemporaryDirectory() as empty:
        jobs = [job(*words, "--node", "all", cache=empty) for _ in range(2)]
    yield (
        [
            figure("gl, --node all, the driver's cache empty", "s", [jobs[0].seconds], goal=40.0),
            figure("gl, --node all", "s", [jobs[1].seconds], goal=20.0),
            memory("gl, --node all", jobs, MEMORY),
        ],
        [Check("gl, --node all", max(each.wrong for each in jobs), 0.0)],
    )
    # Check both libraries on all hosts that run here; stock MaterialX fails.
    jobs = []
    for hosts, nodes in FIELD.values():
        chosen = [*(f"--host={host}" for host in hosts), *(f"--node={node}" for node in nodes)]
        last = (*chosen, *BOTH, "--workers", "2", str(EXAMPLE))
        jobs.append(job(*last, cache=cache, longest=LONGEST))
    figures = [
        figure(f"field, {name}{', stopped' if each.stopped else ''}", "s", [each.seconds])
        for name, each in zip(FIELD, jobs, strict=True)
    ]
    seconds = sum(each.seconds for each in jobs)
    figures.append(figure("field, eonlib and stock, 2 workers", "s", [seconds], goal=90.0))
    yield [*figures, memory("field", jobs)], []


def measure(rounds=3, files=(), whole=True):
    """The `Group` of all jobs, or only of the main one."""
    with TemporaryDirectory() as cache:
        figures, checks = map(chain, zip(*parts(rounds, files, whole, cache), strict=True))
    return Group("check", "`mxeon check`, bundled examples", figures, checks)


def chain(parts):
    return tuple(each for part in parts for each in part)
