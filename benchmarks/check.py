# SPDX-License-Identifier: Apache-2.0
"""`mxeon check` as a user starts it: time and memory, with Mesa's cache of compiled shaders filled."""

import json
import os
import sys
import tempfile
import time
from dataclasses import dataclass
from functools import partial
from subprocess import Popen

import numpy as np

from benchmarks.rounds import Check, Group, figure, ratio
from mxeon.errors import NotRun
from mxeon.hosts import open_engine

OTHERS = ("webgl", "vulkan", "wgsl", "slang", "cycles")
FIELD = ("--host", "all", "--library", "eonlib", "--library", "stock")
CACHE = "MESA_SHADER_CACHE_DISABLE"
NONE, TWO = "gl, no workers", "gl, 2 workers"


@dataclass(frozen=True)
class Job:
    """One run: seconds, the MiB of its largest process, and what did not pass."""

    seconds: float
    memory: float
    wrong: float


def job(*options):
    """The command with options, in a process of its own."""
    environment = {name: value for name, value in os.environ.items() if name != CACHE}
    arguments = [sys.executable, "-P", "-m", "mxeon", "check", "--json", *options]
    with tempfile.TemporaryFile() as output, open(os.devnull, "w", encoding="ascii") as nothing:
        start = time.perf_counter()
        process = Popen(arguments, stdout=output, stderr=nothing, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        counts = json.load(output)["counts"]
    wrong = np.inf if not counts["passed"] else float(counts["failed"])
    return Job(seconds, usage.ru_maxrss / 1024.0, wrong)


def main_job(rounds, files):
    """Figures and checks of the examples on gl, without and with workers in turn."""
    options = {NONE: (*files, "--workers", "0"), TWO: (*files, "--workers", "2")}
    job(*options[TWO])  # fills the cache for both
    found = {name: [] for name in options}
    for _ in range(rounds):
        for name, each in options.items():
            found[name].append(job(*each))
    seconds = {name: [each.seconds for each in jobs] for name, jobs in found.items()}
    memory = [each.memory for jobs in found.values() for each in jobs]
    figures = [
        figure(NONE, "s", seconds[NONE]),
        figure(TWO, "s", seconds[TWO], goal=10.0),
        ratio(f"{TWO} / no workers", seconds[TWO], seconds[NONE], goal=1.0),
        figure("gl, memory of the largest process", "MiB", [max(memory)], goal=600.0),
    ]
    wrong = [Check(name, max(each.wrong for each in jobs), 0.0) for name, jobs in found.items()]
    return figures, wrong


def runs(host):
    """Whether a host can run here."""
    try:
        open_engine(host).close()
    except NotRun:
        return False
    return True


def measure(rounds=3, files=(), field=True):
    """The `Group` of all that; stock MaterialX is expected to fail, so its run has no check."""
    figures, checks = main_job(rounds, files)
    if field:
        jobs = {host: partial(job, "--host", host) for host in OTHERS if runs(host)}
        for host, run in jobs.items():
            found = run()
            figures.append(figure(f"{host}, 2 workers", "s", [found.seconds]))
            checks.append(Check(f"{host}, 2 workers", found.wrong, 0.0))
        name = "all hosts, eonlib and stock, 2 workers"
        figures.append(figure(name, "s", [job(*FIELD).seconds], goal=120.0))
    return Group("check", "`mxeon check`, bundled examples", tuple(figures), tuple(checks), {})
