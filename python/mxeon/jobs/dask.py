# SPDX-License-Identifier: Apache-2.0
"""Process items on a Dask cluster. The module needs the `dask` extra of mxeon.

Dask schedules items, restarts workers and retries items. This module adds timeouts, and items that
only some machines can process.
"""

from __future__ import annotations

import faulthandler
import logging
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from threading import Thread
from typing import Any

import mxeon
from mxeon.errors import InputError, NotRun, PackageError, install
from mxeon.jobs import WAIT, check_timeout
from mxeon.jobs.pool import Outcome, log_bug

ANSWER = 10.0  # maximum seconds for a scheduler's answer
GONE = "scheduler must run until the end; it no longer answers"
LOGGERS = ("distributed", "tornado", "asyncio")
WINDOW = 2  # items in flight per worker; more items would fill memory and starve new workers
POLL = 1.0  # seconds between polls for new and lost workers
FETCH = 10.0  # maximum seconds to transfer a result, usually a few kilobytes


@contextmanager
def connect(address: str, wait: float = WAIT) -> Iterator[Workers]:
    """Connect to the workers of a cluster.

    The address of the scheduler has the form "tcp://host:8786". Raises NotRun if there is no
    compatible worker for `wait` seconds, at the start or later. Raises InputError if no scheduler
    answers, or if no worker is compatible.
    """
    check_timeout(wait, "waitForWorkers")
    client = _client(address, wait)
    try:
        yield Workers(client, wait)
    finally:
        _in_time(partial(client.close, timeout=ANSWER), 2.0 * ANSWER)


def _client(address: str, wait: float) -> Any:
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise PackageError(f"--scheduler needs distributed: {install('dask')}") from None
    for name in (*LOGGERS, *logging.root.manager.loggerDict):
        if name.partition(".")[0] in LOGGERS:  # this module reports errors of Dask in one line
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    rule = f"scheduler must be the address of a running Dask scheduler; got {address!r}"
    if not address.strip():
        raise InputError(rule)
    try:
        client = _in_time(partial(Client, address, timeout=min(ANSWER, wait)), wait)
    except (OSError, ValueError) as error:
        raise InputError(f"{rule}: {str(error).partition(chr(10))[0]}") from None
    if client is None:
        raise InputError(f"{rule}: no answer within {wait:g} s; raise it with --waitForWorkers")
    return client


def _in_time(work: Callable[[], Any], seconds: float) -> Any:
    """The result of `work`, or None if `work` takes longer than the given time.

    After that time, `work` continues in a thread. Exceptions of `work` are raised. Dask itself
    would wait for minutes for a scheduler that accepts a connection and does not reply.
    """
    future: futures.Future[Any] = futures.Future()

    def fulfill() -> None:
        try:
            future.set_result(work())
        except Exception as error:
            future.set_exception(error)

    Thread(target=fulfill, daemon=True).start()
    futures.wait([future], seconds)
    return future.result() if future.done() else None


class Workers:
    """Workers of a cluster. Workers with this version of mxeon and one thread are compatible."""

    def __init__(self, client: Any, wait: float) -> None:
        self.client = client
        self._wait = wait
        self._compatible: dict[str, bool] = {}
        if not self.compatible() and self._compatible:  # these workers will stay incompatible
            raise InputError(
                f"cluster must have a worker with mxeon {mxeon.__version__} and --nthreads 1; "
                f"got {len(self._compatible)} incompatible"
            )
        self.await_compatible()

    def await_compatible(self) -> None:
        """Wait for a compatible worker. Raise NotRun if no worker comes in time."""
        end = time.monotonic() + self._wait
        while not self.compatible():
            if time.monotonic() > end:
                raise NotRun(
                    f"no compatible Dask worker was available within {self._wait:g} s; "
                    "raise it with --waitForWorkers"
                )
            time.sleep(min(POLL, self._wait))

    def compatible(self) -> frozenset[str]:
        """Addresses of the compatible workers. Each incompatible worker causes a single warning."""
        info = self.client.scheduler_info(n_workers=-1)
        if "workers" not in info:  # the client is closed
            raise NotRun(GONE)
        threads = {address: worker["nthreads"] for address, worker in info["workers"].items()}
        new = sorted(threads.keys() - self._compatible.keys())
        ask = partial(self.client.run, attrgetter("__version__"), mxeon, on_error="return")
        versions = ask(workers=new) if new else {}
        for address, version in versions.items():
            reason = ""
            if version != mxeon.__version__:
                reason = f"it must have mxeon {mxeon.__version__}; got {version}"
            elif threads[address] != 1:
                needs = "it must have one thread, --nthreads 1, because of OpenGL"
                reason = f"{needs}; got {threads[address]}"
            self._compatible[address] = not reason
            if reason:
                warnings.warn(f"worker {address} gets no work: {reason}", stacklevel=2)
        return frozenset(address for address in threads if self._compatible.get(address))

    def submit(self, *task: Any, on: frozenset[str]) -> Any:
        """Submit a task to the workers `on`, and return the future of the task."""
        return self.client.submit(*task, workers=sorted(on), pure=False)


def run(
    work: Callable[[Any], Any],
    items: Sequence[Any],
    workers: Workers,
    timeout: float,
    unavailable: type[Exception],
) -> Iterator[tuple[int, Outcome]]:
    """Run `work` on every item, and iterate over outcomes in the order of completion.

    The iterator yields the same pairs as `mxeon.jobs.pool.run`. An item that takes `timeout`
    seconds ends its worker process, and Dask's nanny starts a new process. If `work` raises
    `unavailable`, another worker processes the item. Raises NotRun if the cluster has no compatible
    worker for too long, or if the connection to the scheduler is lost.
    """
    from distributed import wait

    waiting = deque(_Task(index, item) for index, item in enumerate(items))
    running: dict[Any, _Task] = {}
    try:
        while waiting or running:
            compatible = workers.compatible()
            while waiting and len(running) < WINDOW * len(compatible):
                task = waiting.popleft()
                chosen = compatible - task.tried or compatible
                future = workers.submit(
                    _work_timed, work, task.item, timeout, unavailable, on=chosen
                )
                running[future] = replace(task, chosen=chosen)
            if not running:
                workers.await_compatible()
                continue
            with suppress(TimeoutError):
                wait(list(running), timeout=POLL, return_when="FIRST_COMPLETED")
            for future, task in list(running.items()):
                outcome, retry = _progress(future, task, compatible)
                if outcome or retry:
                    del running[future]
                if outcome:
                    yield task.index, outcome
                elif retry:
                    waiting.append(retry)
    except (OSError, futures.CancelledError):  # the connection is lost; items' errors are outcomes
        raise NotRun(GONE) from None


@dataclass(frozen=True)
class _Task:
    index: int
    item: Any
    tried: frozenset[str] = frozenset()
    chosen: frozenset[str] = frozenset()


class WorkerUnavailable(Exception):
    """A worker cannot process an item. The arguments are the reason and the worker's address."""

    def __init__(self, reason: str, worker: str) -> None:
        super().__init__(reason, worker)
        self.worker = worker

    def __str__(self) -> str:
        return str(self.args[0])


def _progress(
    future: Any, task: _Task, compatible: frozenset[str]
) -> tuple[Outcome | None, _Task | None]:
    """The outcome of a finished task, or the task to submit again, or neither."""
    if not future.done():
        # Submit the task again if none of the chosen workers is left.
        return None, None if task.chosen & compatible else task
    try:
        error = future.exception(timeout=FETCH)
        if error is None:
            return Outcome(future.result(timeout=FETCH)), None
    except TimeoutError:  # the worker is lost with the result, so wait again
        return None, None
    if isinstance(error, WorkerUnavailable):
        tried = task.tried | {error.worker}
        if compatible - tried:
            return None, replace(task, tried=tried)
        return Outcome(None, str(error)), None
    if not type(error).__module__.startswith("distributed."):  # the error is from the work
        log_bug(error)
    return Outcome(None, " ".join(f"{type(error).__name__}: {error}".split())), None


def _work_timed(
    work: Callable[[Any], Any], item: Any, timeout: float, unavailable: type[Exception]
) -> Any:
    """Process an item on a worker. The timeout ends the process of the worker."""
    from distributed import get_worker

    faulthandler.dump_traceback_later(timeout, exit=True, file=sys.__stderr__ or 2)
    try:
        return work(item)
    except unavailable as reason:
        raise WorkerUnavailable(str(reason), get_worker().address) from None
    finally:
        faulthandler.cancel_dump_traceback_later()
