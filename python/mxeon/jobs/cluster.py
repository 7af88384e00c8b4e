# SPDX-License-Identifier: Apache-2.0
"""The workers of a Dask cluster: the connection to them, and which of them are compatible."""

from __future__ import annotations

import logging
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any

import mxeon
from mxeon.errors import InputError, NotRun, PackageError, install
from mxeon.jobs.timeouts import WAIT, check_timeout

ANSWER = 10.0  # seconds until a scheduler answers
GONE = "scheduler must run until the end; it answers no more"
LOGGERS = ("distributed", "tornado", "asyncio")
POLL = 1.0  # seconds between looks at the workers that come and go


@contextmanager
def connect(address: str, wait: float = WAIT) -> Iterator[Workers]:
    """Connect to the workers of a cluster by the address of its scheduler, "tcp://host:8786".

    It may be without a compatible worker for `wait` seconds, now and later: else NotRun. InputError if no
    scheduler answers, or none of the workers is compatible.
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
        if name.partition(".")[0] in LOGGERS:  # what these tell is told here in one line
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
    """What work returns or raises within some seconds; None if it goes on, in a thread that nobody joins.

    Dask waits for a scheduler that takes a connection and says nothing for minutes.
    """
    answers: SimpleQueue[tuple[Any, Exception | None]] = SimpleQueue()

    def answer() -> None:
        try:
            answers.put((work(), None))
        except Exception as error:
            answers.put((None, error))

    Thread(target=answer, daemon=True).start()
    try:
        value, error = answers.get(timeout=seconds)
    except Empty:
        return None
    if error:
        raise error
    return value


class Workers:
    """The workers of a cluster; those that have this version and one thread are compatible."""

    def __init__(self, client: Any, wait: float) -> None:
        self.client = client
        self._wait = wait
        self._compatible: dict[str, bool] = {}
        if not self.compatible() and self._compatible:  # these workers will not change
            raise InputError(
                f"cluster must have a worker with mxeon {mxeon.__version__} and --nthreads 1; "
                f"got {len(self._compatible)} others"
            )
        self.await_compatible()

    def await_compatible(self) -> None:
        """Wait for a compatible worker; NotRun if none comes in time."""
        end = time.monotonic() + self._wait
        while not self.compatible():
            if time.monotonic() > end:
                raise NotRun(
                    f"no compatible Dask worker came within {self._wait:g} s; "
                    "raise it with --waitForWorkers"
                )
            time.sleep(min(POLL, self._wait))

    def compatible(self) -> frozenset[str]:
        """Addresses of the compatible workers; warns once of each other one."""
        info = self.client.scheduler_info(n_workers=-1)
        if "workers" not in info:  # the client has closed
            raise NotRun(GONE)
        threads = {address: worker["nthreads"] for address, worker in info["workers"].items()}
        new = sorted(threads.keys() - self._compatible.keys())
        versions = self.client.run(_version, workers=new, on_error="return") if new else {}
        for address, version in versions.items():
            reason = _incompatibility(version, threads[address])
            self._compatible[address] = not reason
            if reason:
                warnings.warn(f"worker {address} gets no work: {reason}", stacklevel=2)
        return frozenset(address for address in threads if self._compatible.get(address))

    def submit(self, *task: Any, on: frozenset[str]) -> Any:
        """The future of a task that some of the workers may do."""
        return self.client.submit(*task, workers=sorted(on), pure=False)


def _incompatibility(version: object, threads: int) -> str:
    if version != mxeon.__version__:
        return f"it must have mxeon {mxeon.__version__}; got {version}"
    if threads != 1:
        return f"it must have one thread, --nthreads 1, as OpenGL needs; got {threads}"
    return ""


def _version() -> str:
    return mxeon.__version__
