# SPDX-License-Identifier: Apache-2.0
"""Workers and parents of runs killed at random moments; each run has to come to its right end."""

import os
import random
import signal
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

from tests.reliability.runs import done_twice, start, verdicts, wait_for_end, workers

SEED = 1
LIMIT = 600  # seconds for a run, whatever happens to it
ENDED = (0, 1, 3)  # exit statuses of a run that came to its end
INTERRUPTED = 130
VICTIMS = ("worker", "worker", "parent", "parent", "interrupt")


def measure(count=200, progress=iter):
    """Figures of `count` runs, each struck once or more at random moments."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in the background ignore it
    rng = random.Random(SEED)
    tally = Counter()
    with TemporaryDirectory(prefix="mxeon-kills-") as base:
        began = time.monotonic()
        wait_for_end(start(Path(base, "calm")), LIMIT)
        usual = time.monotonic() - began
        calm = verdicts(Path(base, "calm"))
        for number in progress(range(count)):
            folder = Path(base, str(number))
            _strike(folder, rng, usual, tally)
            found = verdicts(folder)
            tally["survived"] += found == calm
            tally["lost"] += len(calm - found)
            tally["twice"] += done_twice(folder)
    return {"runs": count, "seed": SEED, "items_each": len(calm)} | dict(tally)


def _strike(folder, rng, usual, tally):
    """A run, struck until it ends undisturbed."""
    status, strikes = None, 0
    while status not in ENDED:
        process = start(folder)
        time.sleep(rng.uniform(0.0, usual))
        victim = rng.choice(VICTIMS)
        if strikes < 3 and _hit(process, victim, rng):
            strikes += 1
            tally[f"struck_{victim}"] += 1
        status, errors = wait_for_end(process, LIMIT)
        tally["tracebacks"] += "Traceback" in errors
        tally["resumed"] += status not in ENDED
        tally["interrupted"] += status == INTERRUPTED


def _hit(process, victim, rng):
    """Strike; whether there was something to hit."""
    if process.poll() is not None:
        return False
    with suppress(psutil.Error, ProcessLookupError):
        if victim == "interrupt":
            os.killpg(process.pid, signal.SIGINT)  # to all in the terminal, as Ctrl-C
            return True
        target = process
        if victim == "worker":
            found = workers(process)
            if not found:
                return False
            target = rng.choice(found)
        target.kill()
        return True
    return False
