# SPDX-License-Identifier: Apache-2.0
"""Work that goes wrong on purpose, in processes that the tests of the pool start; full disks."""

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
    """Misbehave in the way that the item names; a number is squared instead."""
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
    """Die at the first attempt: the item is a file that the first attempt leaves behind."""
    path = Path(item)
    if not path.exists():
        path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


class Lost:
    """A result whose process dies on the first attempt to send it."""

    def __init__(self, item):
        self.item = item

    def __reduce__(self):
        return str, (once(self.item),)


def meet(folder):
    """Process ID, once another process has begun to work."""
    Path(folder, str(os.getpid())).touch()
    end = time.monotonic() + 300.0
    while len(os.listdir(folder)) < 2 and time.monotonic() < end:
        os.sched_yield()
    return os.getpid()


def need(item):
    """Read the environment variable that the item names."""
    if item not in os.environ:
        raise NotRun(f"{item}: missing")
    return os.environ[item]


@contextmanager
def room_for(size):
    """Limit the size of files in bytes, to simulate a full disk."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
