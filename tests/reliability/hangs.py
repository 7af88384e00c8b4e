# SPDX-License-Identifier: Apache-2.0
"""Hosts that stop answering: workers, and Blender, are stopped while they work."""

import random
import time
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

from mxeon.conformance.results import NOT_RUN
from mxeon.conformance.run import read_run
from tests.reliability.runs import finished, start, until, verdicts, wait_for_end, workers

SEED = 1
LIMIT = 600
ITEM = 10.0  # seconds for an item: several times what the longest takes
START = 1.5  # seconds after which a worker is at work


def measure(count=10, progress=iter):
    """Figures of runs in which workers were stopped with SIGSTOP, once or for good."""
    rng = random.Random(SEED)
    tally = dict.fromkeys(("runs", "survived", "persistent", "reasons", "named"), 0)
    with TemporaryDirectory(prefix="mxeon-hangs-") as base:
        wait_for_end(start(Path(base, "calm")), LIMIT)
        calm = verdicts(Path(base, "calm"))
        for number in progress(range(count)):
            folder = Path(base, f"once-{number}")
            stopped = _once(folder, rng.randrange(len(calm) // 4))
            tally["runs"] += stopped
            tally["survived"] += stopped and verdicts(folder) == calm
        _persistent(Path(base, "persistent"), tally)
    return tally


def _once(folder, goal):
    """A run of which one worker is stopped after so many items: how many could be stopped."""
    process = start(folder, "--timeout", str(ITEM))
    until(lambda: finished(folder) > goal and workers(process), LIMIT, process)
    stopped = _stop(workers(process)[:1])
    wait_for_end(process, LIMIT)
    return stopped


def _persistent(folder, tally):
    """A run whose workers are all stopped until two items have been given up."""
    process = start(folder, "--timeout", "3")
    until(lambda: finished(folder) > 4, LIMIT, process)

    def given_up():
        now = time.time()
        _stop(each for each in workers(process) if now - each.create_time() > START)
        return len(_not_run(folder)) >= 2

    if not until(given_up, LIMIT, process):
        raise RuntimeError("the run came to its end before two of its items were given up")
    wait_for_end(process, LIMIT)
    reasons = _not_run(folder)
    tally["persistent"] += 1
    tally["reasons"] += len(reasons)
    tally["named"] += sum("timed out after 3 s" in reason for reason in reasons)


def _not_run(folder):
    """Why each item that did not run did not."""
    return [each.reason for each in read_run(folder).results if each.verdict == NOT_RUN]


def _stop(processes):
    """How many could be stopped."""
    count = 0
    for each in processes:
        with suppress(psutil.Error):
            each.suspend()
            count += 1
    return count
