# SPDX-License-Identifier: Apache-2.0
"""Work on many pictures by some threads: what encodes them runs without the interpreter's lock."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

THREADS = 4  # each holds a picture or two, and often waits for a disk

T = TypeVar("T")
R = TypeVar("R")


def in_threads(work: Callable[[T], R], items: Iterable[T]) -> Iterator[R]:
    """Results of `work` on every item, in their order; a few items ahead of the caller are begun.

    The first error ends the work, and is raised.
    """
    waiting, begun = iter(items), deque[Future[R]]()
    with ThreadPoolExecutor(THREADS) as pool:
        try:
            begun.extend(pool.submit(work, item) for item in islice(waiting, 2 * THREADS))
            while begun:
                yield begun.popleft().result()
                begun.extend(pool.submit(work, item) for item in islice(waiting, 1))
        finally:
            for future in begun:
                future.cancel()
