# SPDX-License-Identifier: Apache-2.0
"""Processor time of `mxeon check` by part, in one process, with Mesa's cache of shaders filled.

python -m tools.benchmarks.parts          one run: seconds by part, as JSON
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from functools import wraps
from pathlib import Path

from tools.benchmarks.check import CACHE
from tools.benchmarks.rounds import Group, figure

ROOT = Path(__file__).resolve().parents[2]
GOAL = 12.0  # seconds of one process
START, REPORT, REST = "imports and plan", "report", "samples, comparisons and controls"


class Clock:
    """Processor time of functions by part; what one calls of another part is the other's."""

    def __init__(self):
        self.seconds = {}
        self._inner = [0.0]

    def charge(self, part, work, *arguments, **options):
        """Result of a call whose time is a part's."""
        start = time.process_time()
        self._inner.append(0.0)
        try:
            return work(*arguments, **options)
        finally:
            taken, inner = time.process_time() - start, self._inner.pop()
            self.seconds[part] = self.seconds.get(part, 0.0) + taken - inner
            self._inner[-1] += taken

    def watch(self, owner, name, part):
        """Charge every call of a function to a part."""
        work = getattr(owner, name)
        setattr(
            owner, name, wraps(work)(lambda *args, **opts: self.charge(part, work, *args, **opts))
        )


def watch_all(clock):
    """Charge what a run calls to its parts."""
    from mxeon.conformance import reference
    from mxeon.conformance.probes import probe
    from mxeon.conformance.run import judge
    from mxeon.hosts import fragment, gl
    from mxeon.shaders import generation

    for owner, name, part in (
        (generation, "generate", "generation of shaders"),
        (fragment, "bsdf_evaluation", "text of evaluations"),
        (fragment, "function_evaluation", "text of evaluations"),
        (gl, "_program", "programs, from the driver's cache"),
        (gl.Host, "_argument", "textures of arguments"),
        (gl.Host, "_textures", "textures of arguments"),
        (gl.Host, "_draw", "frames, drawn and read"),
        (reference.Host, "picture", "references of pictures"),
        (probe.ValueProbe, "expected", "references of checks"),
        (probe.LobeProbe, "expected_albedo", "references of checks"),
        (judge, "check_texts", "checks of text"),
    ):
        clock.watch(owner, name, part)


def parts():
    """Seconds of the default run and of its report, by part."""
    from mxeon import report
    from mxeon.conformance.run import to_run
    from mxeon.conformance.run.judge import Judge
    from mxeon.conformance.run.plan import make_plan
    from mxeon.shaders.document.policy import DEFAULT

    clock = Clock()
    plan = make_plan((), ("gl",), ("eonlib",))
    clock.seconds[START] = time.process_time()
    watch_all(clock)
    with closing(Judge(DEFAULT)) as judge:
        findings = {n: clock.charge(REST, judge.work, task) for n, task in enumerate(plan.tasks)}
    with tempfile.TemporaryDirectory() as folder:
        clock.charge(REPORT, report.write, to_run(plan, findings), folder)
    return clock.seconds


def measure(rounds=1):
    """The `Group` of the parts, each of them the median over rounds."""
    environment = {name: value for name, value in os.environ.items() if name != CACHE}
    command = [sys.executable, "-m", "tools.benchmarks.parts"]
    runs = []
    for _ in range(rounds + 1):  # the first fills the driver's cache
        output = subprocess.run(command, capture_output=True, check=True, env=environment, cwd=ROOT)
        runs.append(json.loads(output.stdout.splitlines()[-1]))
    found = {part: [run[part] for run in runs[1:]] for part in runs[0]}
    found = dict(sorted(found.items(), key=lambda item: -max(item[1])))
    total = [sum(seconds for part, seconds in run.items() if part != REPORT) for run in runs[1:]]
    figures = [figure(part, "s", seconds) for part, seconds in found.items()]
    figures.append(figure("all but the report", "s", total, goal=GOAL))
    title = "`mxeon check` by part: processor time in one process"
    return Group("parts", title, tuple(figures))


if __name__ == "__main__":
    print(json.dumps(parts()))
