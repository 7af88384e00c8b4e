# SPDX-License-Identifier: Apache-2.0
"""Work on many items on the machines of a Dask cluster. Needs the `dask` extra.

Dask places the items, restarts workers and tries items again. This module adds what Dask does not
have: items that only some machines can do, and timeouts. Which workers are compatible says `cluster`.
"""

from __future__ import annotations

import faulthandler
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from mxeon.errors import NotRun
from mxeon.jobs.cluster import GONE, POLL, Workers
from mxeon.jobs.pool import Outcome, log_bug

WINDOW = 2  # items under way for each worker: results do not pile up, newcomers get their share


def run(
    work: Callable[[Any], Any],
    items: Sequence[Any],
    workers: Workers,
    timeout: float,
    unavailable: type[Exception],
) -> Iterator[tuple[int, Outcome]]:
    """Outcomes of `work` on every item, as they come; see `mxeon.jobs.pool.run`.

    An item that takes `timeout` seconds ends its worker process, and the nanny starts another. Where
    `work` raises `unavailable`, the item goes to other workers. NotRun if the cluster is without a
    compatible worker for too long, or its scheduler is gone.
    """
    try:
        yield from _outcomes(work, items, workers, timeout, unavailable)
    except (OSError, CancelledError):  # of the connection: what items raise is in their outcomes
        raise NotRun(GONE) from None


def _outcomes(
    work: Callable[[Any], Any],
    items: Sequence[Any],
    workers: Workers,
    timeout: float,
    unavailable: type[Exception],
) -> Iterator[tuple[int, Outcome]]:
    """Outcomes as those of `run`, while the scheduler runs."""
    from distributed import wait

    waiting = deque(_Task(index, item) for index, item in enumerate(items))
    running: dict[Any, _Task] = {}
    while waiting or running:
        compatible = workers.compatible()
        while waiting and len(running) < WINDOW * len(compatible):
            task = waiting.popleft()
            chosen = compatible - task.tried or compatible
            future = workers.submit(_work_timed, work, task.item, timeout, unavailable, on=chosen)
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


@dataclass(frozen=True)
class _Task:
    """An item, the workers that could not do it, and those it is bound to."""

    index: int
    item: Any
    tried: frozenset[str] = frozenset()
    chosen: frozenset[str] = frozenset()


class WorkerUnavailable(Exception):
    """A worker cannot do an item; holds the reason and its address."""

    def __init__(self, reason: str, worker: str) -> None:
        super().__init__(reason, worker)
        self.worker = worker

    def __str__(self) -> str:
        return str(self.args[0])


def _progress(
    future: Any, task: _Task, compatible: frozenset[str]
) -> tuple[Outcome | None, _Task | None]:
    """The outcome of a task that is done, or the task to submit again, or neither."""
    if not future.done():
        return None, None if task.chosen & compatible else task  # its workers are gone
    error = future.exception()
    if isinstance(error, WorkerUnavailable):
        tried = task.tried | {error.worker}
        return (
            (None, replace(task, tried=tried)) if compatible - tried else (_outcome(future), None)
        )
    return _outcome(future), None


def _outcome(future: Any) -> Outcome:
    error = future.exception()
    if error is None:
        return Outcome(future.result())
    if isinstance(error, WorkerUnavailable):
        return Outcome(None, str(error))
    if not type(error).__module__.startswith("distributed."):  # raised by the work
        log_bug(error)
    return Outcome(None, " ".join(f"{type(error).__name__}: {error}".split()))


def _work_timed(
    work: Callable[[Any], Any], item: Any, timeout: float, unavailable: type[Exception]
) -> Any:
    """Work on an item, on a worker, whose process ends at the timeout."""
    from distributed import get_worker

    faulthandler.dump_traceback_later(timeout, exit=True, file=sys.__stderr__ or 2)
    try:
        return work(item)
    except unavailable as reason:
        raise WorkerUnavailable(str(reason), get_worker().address) from None
    finally:
        faulthandler.cancel_dump_traceback_later()
