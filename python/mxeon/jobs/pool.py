# SPDX-License-Identifier: Apache-2.0
"""Work on many items in processes of their own, of which any may crash, hang or be killed.

Nothing here knows what the work is.
"""

import multiprocessing
import os
import signal
import sys
import tempfile
import threading
from collections import deque
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass
from multiprocessing import resource_tracker
from pathlib import Path

from pebble import CONSTS, ProcessExpired, ProcessPool

from mxeon.errors import InputError, NotRun
from mxeon.jobs.processes import Context, safe_path
from mxeon.jobs.signals import blocked

ATTEMPTS = 2
BREAKS = 3  # pools that break one after the other before any item ends
START = 60.0  # seconds that a process may take before it begins to work
LONGEST = 1e6  # seconds of a limit; what waits cannot count much further
LOCK = 10.0  # seconds until workers take the lock of one that was killed with it from it
LAST_LINES = 4  # of a worker's output, in the reason


@dataclass(frozen=True)
class Outcome:
    """How the work on one item ended.

    Attributes
    ----------
    value : object
        What the work returned, or None.
    failure : str
        Why it returned nothing, in one line, or "".
    attempts : int
    """

    value: object
    failure: str = ""
    attempts: int = 1


def run(work, items, workers, limit):
    """Outcomes of `work` on every item, as they come.

    Parameters
    ----------
    work : callable (item) -> object
        Can be imported by name; runs in another process, which serves many items.
    items : sequence
    workers : int
        Number of processes, at least 1.
    limit : float
        Seconds for one item, after which its process is killed.

    Yields
    ------
    int, Outcome
        Place of the item in `items`. A crash or time-out costs the item alone: it is tried once
        more and then given up.

    Raises
    ------
    ValueError
        If `workers` is below 1 or `limit` is out of range.
    NotRun
        If no process can start; says why.

    Notes
    -----
    No process imports anything from the working folder. No more than two items a worker are under way, so results do not pile up in memory. Whatever a
    worker prints goes to a file; its last lines are quoted when it fails.
    """
    if workers < 1:
        raise InputError(f"workers must be at least 1; got {workers}")
    check_limit(limit)
    _check_working_folder()
    workers = min(workers, len(items))
    waiting = deque((place, item, 1) for place, item in enumerate(items))
    with tempfile.TemporaryDirectory(prefix="mxeon-pool-") as logs:
        breaks = 0
        while waiting and breaks < BREAKS:
            breaks += 1
            for ended in _serve(work, waiting, workers, limit, logs):
                breaks = 0
                yield ended
    for place, _, attempt in waiting:
        yield place, Outcome(None, "the processes end before they begin to work", attempt)


def check_limit(limit, name="limit"):
    """Nothing, if an item may have that many seconds.

    Raises
    ------
    ValueError
        If `limit` is not positive or above LONGEST.
    """
    if not 0.0 < limit <= LONGEST:
        raise InputError(f"{name} must be positive and at most {LONGEST:g} s; got {limit:g}")


def _check_working_folder():
    """Raise NotRun unless the folder exists in which processes start."""
    try:
        os.getcwd()
    except FileNotFoundError:
        rule = "working folder must exist, as worker processes start in it"
        raise NotRun(f"{rule}; it was deleted") from None


def in_order(outcomes):
    """Outcomes by the places of their items, which those that end early wait for."""
    early, due = {}, 0
    for place, outcome in outcomes:
        early[place] = outcome
        while due in early:
            yield early.pop(due)
            due += 1


def _serve(work, waiting, workers, limit, logs):
    """Outcomes until nothing waits or the pool breaks, which leaves its items waiting."""
    pool = ProcessPool(workers, initializer=_prepare, context=Context())
    running = {}
    try:
        begun = _started(pool)
        while begun and (waiting or running) and pool.active:
            while waiting and len(running) < 2 * workers:
                place, item, attempt = waiting.popleft()
                log = os.path.join(logs, f"{place}-{attempt}.txt")
                future = pool.schedule(_logged, args=(work, item, log), timeout=limit)
                running[future] = place, item, attempt, log
            ended = wait(running, timeout=START + limit, return_when=FIRST_COMPLETED).done
            for future in ended or tuple(running):  # none: the processes hang before they begin
                place, item, attempt, log = running.pop(future)
                outcome = _outcome(future, attempt, limit, log)
                if outcome.failure and attempt < ATTEMPTS:
                    waiting.append((place, item, attempt + 1))
                else:
                    yield place, outcome
                Path(log).unlink(missing_ok=True)
            if not ended:
                return
    finally:
        waiting.extend((place, item, attempt) for place, item, attempt, _ in running.values())
        with blocked():
            pool.stop()
            pool.join()


def _started(pool):
    """Start the threads and processes of a pool; whether it is at work then."""
    try:
        with blocked(), safe_path():
            resource_tracker.ensure_running()  # else the first process does, and unblocks signals
        with blocked():
            return pool.active
    except (OSError, RuntimeError) as error:
        cause = error.__cause__ or error  # pebble's own error has no words
        reason = getattr(cause, "strerror", None) or cause
        raise NotRun(f"worker processes must start; {reason}") from error


def _outcome(future, attempt, limit, log):
    error = future.exception() if future.done() else TimeoutError()
    if error is None:
        return Outcome(future.result(), attempts=attempt)
    if isinstance(error, TimeoutError) and error.__cause__ is None:  # else the work raised it
        end = f"no end within {limit:g} s"
    elif isinstance(error, ProcessExpired):
        code = error.exitcode
        end = f"ended by {_signal(-code)}" if code < 0 else f"exit status {code}"
    else:
        end = f"{type(error).__name__}: {error}"
    path = Path(log)
    printed = path.read_text(errors="replace").split("\n") if path.exists() else []
    last = " | ".join([line.strip() for line in printed if line.strip()][-LAST_LINES:]) or "none"
    return Outcome(None, f"{' '.join(end.split())}; last output: {last}", attempt)


def _signal(number):
    try:
        return signal.Signals(number).name
    except ValueError:  # a real-time signal has no name
        return f"signal {number}"


def _prepare():
    """Make this process a worker that ends with its parent, however that ends."""
    CONSTS.channel_lock_timeout = LOCK

    def wait_for_end():
        multiprocessing.parent_process().join()
        os._exit(1)

    threading.Thread(target=wait_for_end, daemon=True).start()


def _logged(work, item, log):
    """The work on an item; all that this process prints meanwhile, C++ included, goes to `log`.

    Temporary files stay beside it, and go with it whatever becomes of this process.
    """
    tempfile.tempdir = os.path.dirname(log)
    if sys.stdout:  # a daemon may have none
        sys.stdout.flush()
    file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(file, 1)
    os.dup2(file, 2)
    os.close(file)
    return work(item)
