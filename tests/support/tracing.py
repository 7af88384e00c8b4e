# SPDX-License-Identifier: Apache-2.0
"""Turns off coverage's line tracing for a block of code."""

from contextlib import contextmanager

from coverage import Coverage


@contextmanager
def untraced():
    coverage = Coverage.current()
    if coverage is None:
        yield
        return
    coverage.stop()
    try:
        yield
    finally:
        coverage.start()
