# SPDX-License-Identifier: Apache-2.0
"""`mxeon check` as a user starts it: time and memory, with and without Mesa's cache of compiled shaders.

The caches are folders of this benchmark alone, so that no row depends on what ran before it.
"""

import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from subprocess import PIPE, Popen, TimeoutExpired
from tempfile import NamedTemporaryFile, TemporaryDirectory

import numpy as np

from mxeon.conformance.specs.diffuse import DIFFUSE as DIFFUSE_SPECS
from mxeon.conformance.specs.diffuse import SURFACE_LOBES
from mxeon.hosts import HOSTS
from mxeon.shaders.library import examples_folder
from mxeon.survey import ROWS
from tools.benchmarks.rounds import Check, Group, figure

BOTH = ("--library", "eonlib", "--library", "stock")
# The field as tools/site/field.py asks it: the diffuse nodes on hosts, and all common ones of renderers' own.
EXAMPLE = str(examples_folder() / "clay.mtlx")
DIFFUSE = tuple(dict.fromkeys(row.node for row in (*DIFFUSE_SPECS, *SURFACE_LOBES)))
FIELD = {
    "hosts": ([row.name for row in HOSTS if row.module], DIFFUSE),
    "renderers": ([row.name for row in ROWS], ("common",)),
}
LONGEST = 240.0  # seconds of each half of the field, which is stopped then
CACHE, FOLDER = "MESA_SHADER_CACHE_DISABLE", "MESA_SHADER_CACHE_DIR"
MEMORY = 600.0  # MiB
# What starts the command, and writes the KiB of its largest process to a file: Linux counts what the process
# that starts a program had in memory as the program's, and this one is small.
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
    """One run: seconds, the MiB of its largest process, what did not pass, and whether it was stopped."""

    seconds: float
    memory: float
    wrong: float
    stopped: bool = False


def job(*options, cache=None, longest=None):
    """The command with options, in a process of its own; the driver's cache is a folder.

    A run that takes longer than so many seconds is stopped.
    """
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
    """Figure of the largest process of some runs."""
    return figure(f"{name}, largest process", "MiB", [max(each.memory for each in jobs)], goal)


def main_job(rounds, files, cache):
    """Figures and checks of the examples on gl, with an empty cache and again; and the seconds."""
    jobs = [job(*files, "--workers", "2", cache=cache) for _ in range(rounds + 1)]
    seconds = [each.seconds for each in jobs]
    figures = [
        figure("gl, 2 workers", "s", seconds[1:], goal=9.0),
        figure("gl, the driver's cache empty", "s", seconds[:1], goal=30.0),
        memory("gl", jobs, MEMORY),
    ]
    wrong = Check("gl", max(each.wrong for each in jobs), 0.0)
    return figures, [wrong], statistics.median(seconds[1:])


def reporting(rounds, files, cache, usual):
    """Figures of a report, and of the same run again, which finds it finished."""
    found = {"first": [], "again": []}
    for _ in range(rounds):
        with TemporaryDirectory() as folder:
            options = (*files, "--workers", "2", "--report", folder)
            found["first"].append(job(*options, cache=cache))
            found["again"].append(job(*options, "--resume", cache=cache))
    beyond = [each.seconds - usual for each in found["first"]]
    figures = [
        figure("gl, beyond that with --report", "s", beyond, goal=2.0),
        figure("gl, again with --resume", "s", [each.seconds for each in found["again"]], goal=5.0),
        memory("gl, --report", found["first"], MEMORY),
    ]
    return figures, []


def libraries(rounds, files, cache, usual):
    """Figures of two libraries, after a run that fills the cache."""
    jobs = [job(*files, "--workers", "2", *BOTH, cache=cache) for _ in range(rounds + 1)][1:]
    share = [each.seconds / usual for each in jobs]
    figures = [
        figure("gl, two libraries / one", "x", share, 1.6),
        memory("gl, two libraries", jobs, MEMORY),
    ]
    return figures, []


def all_nodes(files):
    """Figures and checks of all nodes, with an empty cache and again."""
    with TemporaryDirectory() as cache:
        runs = [job(*files, "--workers", "2", "--node", "all", cache=cache) for _ in range(2)]
    figures = [
        figure("gl, --node all, the driver's cache empty", "s", [runs[0].seconds], goal=40.0),
        figure("gl, --node all", "s", [runs[1].seconds], goal=20.0),
        memory("gl, --node all", runs, MEMORY),
    ]
    return figures, [Check("gl, --node all", max(each.wrong for each in runs), 0.0)]


def field(cache):
    """Figures of all hosts that run here with both libraries, of which stock MaterialX fails."""
    found = {
        name: job(
            *(word for host in hosts for word in ("--host", host)),
            *(word for node in nodes for word in ("--node", node)),
            *(*BOTH, "--workers", "2", EXAMPLE),
            cache=cache,
            longest=LONGEST,
        )
        for name, (hosts, nodes) in FIELD.items()
    }
    figures = [
        figure(f"field, {name}{', stopped' if each.stopped else ''}", "s", [each.seconds])
        for name, each in found.items()
    ]
    seconds = sum(each.seconds for each in found.values())
    figures.append(figure("field, eonlib and stock, 2 workers", "s", [seconds], goal=90.0))
    return [*figures, memory("field", list(found.values()))], []


def measure(rounds=3, files=(), whole=True, keep: Callable[[Group], None] | None = None):
    """The `Group` of all that, or of the main job alone; `keep` is handed it after each part."""
    with TemporaryDirectory() as cache:
        figures, checks, usual = main_job(rounds, files, cache)
        parts = (
            partial(reporting, rounds, files, cache, usual),
            partial(libraries, rounds, files, cache, usual),
            partial(all_nodes, files),
            partial(field, cache),
        )
        for part in (lambda: ([], []), *(parts if whole else ())):
            found, more = part()
            figures, checks = [*figures, *found], [*checks, *more]
            title = "`mxeon check`, bundled examples"
            group = Group("check", title, tuple(figures), tuple(checks))
            if keep:
                keep(group)
    return group
