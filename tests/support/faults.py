# SPDX-License-Identifier: Apache-2.0
"""Functions that fail on purpose in processes of the pool, and a simulation of a full disk."""

import os
import resource
import signal
import sys
import time
from contextlib import contextmanager
from pathlib import Path

from mxeon.errors import NotRun


def square(item):
    return item * item


def misbehave(item):
    """Fail as the item says, or return the square if the item is a number."""
    if isinstance(item, int):
        return square(item)
    print(f"about to {item}", file=sys.stderr, flush=True)
    if item == "hang":
        signal.pause()
    if item == "exit":
        os._exit(7)
    if item == "raise":
        raise RuntimeError("no light")
    os.kill(os.getpid(), getattr(signal, item))


def once(item):
    """Kill this process on the first attempt, and succeed on the next.

    The first attempt creates the file that the item names.
    """
    path = Path(item)
    if not path.exists():
        path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


class Lost:
    """A result whose pickling kills the process at the first attempt and succeeds at the next."""

    def __init__(self, item):
        self.item = item

    def __reduce__(self):
        return str, (once(self.item),)


def meet(folder):
    """Wait until another process has begun to work, and return the ID of this process."""
    Path(folder, str(os.getpid())).touch()
    end = time.monotonic() + 300.0
    while len(os.listdir(folder)) < 2 and time.monotonic() < end:
        os.sched_yield()
    return os.getpid()


def need(item):
    """Return the environment variable `item`. If the variable is not set, raise NotRun."""
    if item not in os.environ:
        raise NotRun(f"{item}: missing")
    return os.environ[item]


@contextmanager
def room_for(size):
    """Limit the size of each file to `size` bytes, as if the disk were full."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
