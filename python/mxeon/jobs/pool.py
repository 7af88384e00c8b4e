# SPDX-License-Identifier: Apache-2.0
"""A pool of worker processes that may crash, hang or be killed."""

import logging
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

from pebble import CONSTS, ProcessExpired, ProcessPool

from mxeon.errors import LAST_OUTPUT, InputError, MxeonError, NotRun
from mxeon.jobs import check_timeout, processes, signals


@dataclass(frozen=True)
class Attempt:
    """An attempt to process an item. The worker prints to the file `log`."""

    index: int
    item: object
    group: Hashable = None
    number: int = 1
    log: str = ""

    def logged(self, folder: str) -> "Attempt":
        return replace(self, log=os.path.join(folder, f"{self.index}-{self.number}.txt"))


def by_group(groups: Sequence[Hashable]) -> list[int]:
    """Positions of items sorted by group. Groups are in the order of their first items.

    >>> by_group(["a", "b", "a"])
    [0, 2, 1]
    """
    first: dict[Hashable, int] = {}
    for position, group in enumerate(groups):
        first.setdefault(group, position)
    return sorted(range(len(groups)), key=lambda position: first[groups[position]])


class Queue:
    """Waiting attempts, sorted by group.

    Items of a group share work that each worker does only once. A worker without a group begins the
    first group that has no worker. If there is no such group, the worker joins the
    longest group.
    """

    def __init__(self, attempts: Sequence[Attempt]) -> None:
        self._groups: dict[Hashable, deque[Attempt]] = {}
        self._current: dict[int, Hashable] = {}  # group of each worker
        for attempt in attempts:
            self.put(attempt)

    def put(self, attempt: Attempt) -> None:
        self._groups.setdefault(attempt.group, deque()).append(attempt)

    def take(self, worker: int) -> Attempt:
        """Take the next attempt for a worker. The queue must not be empty."""
        if self._current.get(worker) not in self._groups or worker not in self._current:
            others = {group for each, group in self._current.items() if each != worker}
            free = (group for group in self._groups if group not in others)
            longest = max(self._groups, key=lambda group: len(self._groups[group]))
            self._current[worker] = next(free, longest)
        group = self._current[worker]
        attempt = self._groups[group].popleft()
        if not self._groups[group]:
            del self._groups[group]
        return attempt

    def __len__(self) -> int:
        return sum(map(len, self._groups.values()))

    def __iter__(self) -> Iterator[Attempt]:
        for group in self._groups.values():
            yield from group


logger = logging.getLogger(__name__)

# If a process is killed, the resource tracker would print a warning about the process's semaphores.
QUIET = "ignore::UserWarning:multiprocessing.resource_tracker"
ATTEMPTS = 2
BREAKS = 3  # maximum number of pools that break in succession without finishing an item
START = 60.0  # maximum seconds until a process begins to work
LOCK = 10.0  # seconds until workers take over the lock of a killed worker
LAST = 4  # waiting tasks per worker above which each worker gets a second task
LAST_LINES = 4  # maximum number of lines quoted from a worker's output


@dataclass(frozen=True)
class Outcome:
    value: Any  # result of the work
    failure: str = ""  # reason why the value is missing, in one line
    attempts: int = 1


def run(
    work: Callable[[Any], Any],
    items: Sequence[object],
    workers: int,
    timeout: float,
    group: Callable[[Any], Hashable] = lambda item: None,
) -> Iterator[tuple[int, Outcome]]:
    """Run `work` on every item, and iterate over indices and outcomes in the order of completion.

    `work` must be importable by name, and runs in `workers` processes. If an item takes `timeout`
    seconds, the process is killed. A crash or a timeout affects only one item, which is retried
    once. If there are enough groups, the items of a `group` run in the same process. An exception
    without a message for users is a bug, whose traceback is logged. Raises NotRun if no process
    starts.

    Processes import nothing from the working folder. At most two items per worker are in flight, so
    that results do not fill the memory. A worker prints to a file. A failure quotes the last lines
    of the file.

    The processes end with the iterator. A caller must close the iterator after an error, because
    garbage collection might run in a thread that must be joined, which would be a deadlock.
    """
    if workers < 1:
        raise InputError(f"workers must be at least 1; got {workers}")
    check_timeout(timeout)
    try:
        os.getcwd()
    except FileNotFoundError:
        rule = "working folder must exist, because workers start in it"
        raise NotRun(f"{rule}; it was deleted") from None
    workers = min(workers, len(items))
    waiting = Queue([Attempt(index, item, group(item)) for index, item in enumerate(items)])
    with signals.temporary_folder("mxeon-pool-") as logs:
        breaks = 0
        while waiting and breaks < BREAKS:
            breaks += 1
            for outcome in _serve(work, waiting, workers, timeout, logs):
                breaks = 0
                yield outcome
    for attempt in waiting:
        failure = "worker processes end before they begin to work"
        yield attempt.index, Outcome(None, failure, attempt.number)


def in_order(outcomes: Iterable[tuple[int, Outcome]]) -> Iterator[Outcome]:
    early: dict[int, Outcome] = {}
    due = 0
    for index, outcome in outcomes:
        early[index] = outcome
        while due in early:
            yield early.pop(due)
            due += 1


def _serve(
    work: Callable[[Any], Any], waiting: Queue, workers: int, timeout: float, logs: str
) -> Iterator[tuple[int, Outcome]]:
    """Yield outcomes until no item waits or a pool breaks. Unfinished items go back to `waiting`.

    Each worker is a pool with one process, so that items can be assigned to a worker.
    """
    context: Any = processes.Context()
    pools = [ProcessPool(1, initializer=_prepare, context=context) for _ in range(workers)]
    running: list[dict[Future[Any], Attempt]] = [{} for _ in pools]
    try:
        active = all([_start(pool) for pool in pools])
        while active and (waiting or any(running)) and all(pool.active for pool in pools):
            # Schedule two tasks per worker, or one task per worker if few tasks are left.
            for worker, (pool, own) in enumerate(zip(pools, running, strict=True)):
                while waiting and len(own) < (2 if len(waiting) > LAST * workers else 1):
                    attempt = waiting.take(worker).logged(logs)
                    arguments = (work, attempt.item, attempt.log)
                    future = pool.schedule(_work_logged, args=arguments, timeout=timeout)
                    own[future] = attempt
            begun = dict(pair for own in running for pair in own.items())
            done = wait(begun, timeout=START + timeout, return_when=FIRST_COMPLETED).done
            for ended in done or begun:  # if no task ends, processes hang at the start
                attempt = begun[ended]
                for own in running:
                    own.pop(ended, None)
                if again := _again(ended, attempt, outcome := _outcome(ended, attempt, timeout)):
                    waiting.put(again)
                else:
                    yield attempt.index, outcome
                # A worker on Windows keeps the file open until the next item.
                with suppress(PermissionError):
                    Path(attempt.log).unlink(missing_ok=True)
            if not done:
                return
    finally:
        for own in running:
            for attempt in own.values():
                waiting.put(attempt)
        with signals.block_signals():
            for pool in pools:
                pool.stop()
            for pool in pools:
                pool.join()


def _start(pool: ProcessPool) -> bool:
    """Start the threads and processes of a pool, and return whether the pool is active."""
    try:
        with signals.block_signals(), processes.safe_path():
            if QUIET not in sys.warnoptions:
                sys.warnoptions.append(QUIET)  # the process of the tracker inherits this option
            if sys.platform != "win32":
                resource_tracker.ensure_running()  # a later start would unblock signals
        with signals.block_signals():
            return bool(pool.active)
    except (OSError, RuntimeError) as error:
        cause = error.__cause__ or error  # the error of pebble has no message
        reason = getattr(cause, "strerror", None) or cause
        raise NotRun(f"worker processes must start; {reason}") from error


def _again(future: Future[Any], attempt: Attempt, outcome: Outcome) -> Attempt | None:
    """The next attempt at an item, or None if there is no further attempt.

    If a pool breaks, it is unknown which task was running, so the attempt is not counted.
    """
    if future.done() and isinstance(future.exception(), BrokenProcessPool):
        return attempt
    if outcome.failure and attempt.number < ATTEMPTS:
        return replace(attempt, number=attempt.number + 1)
    return None


def _outcome(future: Future[Any], attempt: Attempt, timeout: float) -> Outcome:
    error = future.exception() if future.done() else TimeoutError()
    if error is None:
        return Outcome(future.result(), attempts=attempt.number)
    raised = error.__cause__ is not None  # pebble gives exceptions of the work a cause
    if raised and attempt.number == ATTEMPTS:
        log_bug(error)
    end = f"{type(error).__name__}: {error}" if raised else _end(error, timeout)
    path = Path(attempt.log)
    lines = path.read_text("utf-8", "replace").split("\n") if path.exists() else []
    last = " | ".join([line.strip() for line in lines if line.strip()][-LAST_LINES:]) or "none"
    return Outcome(None, f"{' '.join(end.split())}{LAST_OUTPUT}{last}", attempt.number)


def log_bug(error: BaseException) -> None:
    """Log the traceback of a worker's exception, unless the exception has a message for users."""
    if not isinstance(error, (MxeonError, OSError, MemoryError)):
        logger.error("bug in a worker process", exc_info=error)


def _end(error: BaseException, timeout: float) -> str:
    if isinstance(error, TimeoutError):
        return f"timed out after {timeout:g} s"
    if not isinstance(error, ProcessExpired):
        return f"{type(error).__name__}: {error}"
    if (code := error.exitcode) >= 0:
        return f"worker process ended with exit status {code}"
    names = {each.value: each.name for each in signal.Signals}  # real-time signals have no name
    return f"worker process crashed ({names.get(-code, f'signal {-code}')})"


def _prepare() -> None:
    CONSTS.channel_lock_timeout = LOCK
    parent = multiprocessing.parent_process()
    assert parent is not None  # a worker has a parent

    def exit_with_parent() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=exit_with_parent, daemon=True).start()


def _work_logged(work: Callable[[Any], Any], item: Any, log: str) -> Any:
    """Process an item, and redirect the output of Python and C++ code to the file `log`.

    Temporary files are created in the folder of `log`. The folder is deleted even if this process
    dies.
    """
    tempfile.tempdir = os.path.dirname(log)
    if sys.stdout:  # None in a daemon
        sys.stdout.flush()
    file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(file, 1)
    os.dup2(file, 2)
    os.close(file)
    return work(item)
