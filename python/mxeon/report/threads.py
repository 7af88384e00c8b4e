# SPDX-License-Identifier: Apache-2.0
"""Work on many pictures by some threads: what encodes them runs without the interpreter's lock."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from itertools import islice
from typing import TypeVar

THREADS = 4  # each holds a picture or two, and often waits for a disk

T = TypeVar("T")
R = TypeVar("R")


@contextmanager
def in_threads(work: Callable[[T], R], items: Iterable[T]) -> Iterator[Iterator[R]]:
    """Results of `work` on every item, in their order; a few items ahead of the caller are begun.

    The first error ends the work, and is raised. The threads end with the block: if garbage collection
    ended them, it might run in one of them, which would then wait for itself.
    """
    begun = deque[Future[R]]()
    with ThreadPoolExecutor(THREADS) as pool:
        try:
            yield _results((pool.submit(work, item) for item in items), begun)
        finally:
            for future in begun:
                future.cancel()


def _results(futures: Iterator[Future[R]], begun: deque[Future[R]]) -> Iterator[R]:
    """Results of futures, which begin when they are taken, some ahead of the caller."""
    begun.extend(islice(futures, 2 * THREADS))
    while begun:
        yield begun.popleft().result()
        begun.extend(islice(futures, 1))
