# SPDX-License-Identifier: Apache-2.0
"""Work on many items on the machines of a Dask cluster. Needs the `dask` extra.

Dask places the items, brings dead workers back and tries their items again. Here is what it cannot
know: which workers fit, that an item one machine cannot do may be done by another, and time limits.
"""

import faulthandler
import sys
import time
import warnings
from collections import deque
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace

import mxeon
from mxeon.errors import InputError, NotRun, PackageError
from mxeon.jobs.pool import Outcome, check_limit

WINDOW = 2  # items under way for each worker: results do not pile up, newcomers get their share
ANSWER = 10.0  # seconds until a scheduler answers
WAIT = 60.0  # seconds for workers to come, or to come back when all restart at once
POLL = 1.0  # seconds between looks at the workers that come and go


@contextmanager
def connected(address, wait=WAIT):
    """The workers of a cluster.

    Parameters
    ----------
    address : str
        Of the scheduler, "tcp://host:8786".
    wait : float
        Seconds that the cluster may be without a worker that fits, now and later.

    Raises
    ------
    ValueError
        If no scheduler answers at the address, none of its workers fits, or `wait` is out of range.
    NotRun
        If it has no workers and none comes in time.
    ImportError
        If Dask is not installed; says what to install.
    """
    check_limit(wait, "waitForWorkers")
    client = _connect(address)
    try:
        yield _Workers(client, wait)
    finally:
        client.close()


def run(work, items, workers, limit, elsewhere):
    """Outcomes of `work` on every item, as they come; see `mxeon.jobs.pool.run`.

    Parameters
    ----------
    work : callable (item) -> object
        Can be imported by name on the workers.
    items : sequence
    workers : what `connected` gives
    limit : float
        Seconds for one item, after which its worker process ends and its nanny starts another.
    elsewhere : type of exception
        What `work` raises when this worker cannot do the item; others are asked then.

    Yields
    ------
    int, Outcome

    Raises
    ------
    NotRun
        If the cluster is without a worker that fits for too long, or its scheduler is gone.
    """
    from distributed import wait

    waiting = deque(_Task(place, item) for place, item in enumerate(items))
    running = {}
    while waiting or running:
        fit = workers.fit()
        while waiting and len(running) < WINDOW * len(fit):
            task = waiting.popleft()
            chosen = fit - task.tried or fit
            future = workers.submit(_timed, work, task.item, limit, elsewhere, among=chosen)
            running[future] = replace(task, chosen=chosen)
        if not running:
            workers.await_fit()
            continue
        with suppress(TimeoutError):
            wait(list(running), timeout=POLL, return_when="FIRST_COMPLETED")
        for future, task in list(running.items()):
            if future.done():
                outcome, task = _ended(future, task, fit)
            elif not task.chosen & fit:  # for those that came instead
                outcome = None
            else:
                continue
            del running[future]
            if outcome:
                yield task.place, outcome
            else:
                waiting.append(task)


@dataclass(frozen=True)
class _Task:
    """An item, the workers that could not do it, and those it is bound to."""

    place: int
    item: object
    tried: frozenset = frozenset()
    chosen: frozenset = frozenset()


def _connect(address):
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise PackageError("--scheduler needs distributed: pip install 'mxeon[dask]'") from None
    try:
        return Client(address, timeout=ANSWER)
    except (OSError, ValueError) as error:
        reason = str(error).partition("\n")[0]
        raise InputError(
            f"scheduler must be the address of a running Dask scheduler; got {address}: {reason}"
        ) from None


def _ended(future, task, fit):
    """The outcome of a task that ended; or none, and the task as others are to try it."""
    error = future.exception()
    if isinstance(error, Elsewhere):
        tried = task.tried | {error.worker}
        if fit - tried:
            return None, replace(task, tried=tried)
    return _outcome(future, error), task


def _outcome(future, error):
    if error is None:
        return Outcome(future.result())
    if isinstance(error, Elsewhere):
        return Outcome(None, str(error))
    return Outcome(None, " ".join(f"{type(error).__name__}: {error}".split()))


class _Workers:
    """The workers of a cluster, of which those fit that have this version and one thread."""

    def __init__(self, client, wait):
        self.client = client
        self._wait = wait
        self._fits = {}
        if not self.fit() and self._fits:  # who is there will not change
            raise InputError(
                f"cluster must have a worker with mxeon {mxeon.__version__} and --nthreads 1; "
                f"got {len(self._fits)} others"
            )
        self.await_fit()

    def await_fit(self):
        """Wait for a worker that fits.

        Raises
        ------
        NotRun
            If none comes in time.
        """
        end = time.monotonic() + self._wait
        while not self.fit():
            if time.monotonic() > end:
                rule = f"cluster must have a worker that fits; none came within {self._wait:g} s"
                raise NotRun(f"{rule}: --waitForWorkers moves the limit")
            time.sleep(min(POLL, self._wait))

    def fit(self):
        """Addresses of the workers that fit; a warning for each other one when it is first seen."""
        known = self.client.scheduler_info(n_workers=-1)
        if "workers" not in known:  # the client has closed
            raise NotRun("scheduler must run until the end; it answers no more")
        threads = {address: each["nthreads"] for address, each in known["workers"].items()}
        unknown = sorted(threads.keys() - self._fits.keys())
        versions = self.client.run(_version, workers=unknown, on_error="return") if unknown else {}
        for address, version in versions.items():
            why = _unfit(version, threads[address])
            self._fits[address] = not why
            if why:
                warnings.warn(f"worker {address} gets no work: {why}", stacklevel=2)
        return frozenset(address for address in threads if self._fits.get(address))

    def submit(self, *task, among):
        """The future of a task that some of the workers may do."""
        return self.client.submit(*task, workers=sorted(among), pure=False)


class Elsewhere(Exception):
    """A worker cannot do an item, and says its address."""

    def __init__(self, reason, worker):
        super().__init__(reason, worker)
        self.worker = worker

    def __str__(self):
        return self.args[0]


def _timed(work, item, limit, elsewhere):
    """The work on an item, on a worker, whose process ends if it takes too long."""
    from distributed import get_worker

    faulthandler.dump_traceback_later(limit, exit=True, file=sys.__stderr__)
    try:
        return work(item)
    except elsewhere as reason:
        raise Elsewhere(str(reason), get_worker().address) from None
    finally:
        faulthandler.cancel_dump_traceback_later()


def _unfit(version, threads):
    if version != mxeon.__version__:
        return f"it must have mxeon {mxeon.__version__}; got {version}"
    if threads != 1:
        return f"it must have one thread, --nthreads 1, as OpenGL needs; got {threads}"
    return ""


def _version():
    return mxeon.__version__
