# SPDX-License-Identifier: Apache-2.0
"""Interleaved rounds, their medians and ratios, and what one benchmark found.

Rivals take turns within a round, so that what else the machine does falls on all of them alike; a
ratio is the median of the ratios of the rounds. Benchmark libraries time one function after the
other, which makes ratios of what drifts between them; hence these few lines.
"""

import statistics
import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A median over rounds and its quartiles."""

    name: str
    unit: str  # "x" for a ratio
    median: float
    low: float
    high: float
    goal: float | None = None  # the median is at most this,
    at_least: bool = False  # or at least

    @property
    def reached(self):
        """Whether the goal is; None without a goal."""
        if self.goal is None:
            return None
        return self.median >= self.goal if self.at_least else self.median <= self.goal


@dataclass(frozen=True)
class Check:
    """Whether what was timed gave right values, in the same run."""

    name: str
    error: float
    tolerance: float

    @property
    def passed(self):
        """Whether the error is a number within the tolerance."""
        return self.error <= self.tolerance


@dataclass(frozen=True)
class Group:
    """One benchmark's findings."""

    name: str
    title: str
    figures: tuple = ()
    checks: tuple = ()


def interleave(rivals, rounds, clock=time.perf_counter):
    """Seconds of each call of each rival, one call per round, in turn; a first round is dropped.

    `time.process_time` as the clock leaves out what else the machine does, and adds up the cores.
    """
    found = {name: [] for name in rivals}
    for _ in range(rounds + 1):
        for name, rival in rivals.items():
            start = clock()
            rival()
            found[name].append(clock() - start)
    return {name: seconds[1:] for name, seconds in found.items()}


def clock_of(device):
    """The clock for a device of OpenGL: on a software device, processor time."""
    return time.process_time if "llvmpipe" in device else time.perf_counter


def figure(name, unit, values, goal=None, at_least=False):
    """The `Figure` of one value per round.

    Examples
    --------
    >>> figure("value", "x", [3.0, 1.0, 2.0], goal=2.0).reached
    True
    """
    low, median, high = (
        statistics.quantiles(values, n=4, method="inclusive") if len(values) > 1 else values * 3
    )
    return Figure(name, unit, median, low, high, goal, at_least)


def scaled(name, unit, values, factor):
    """The `Figure` of values times a factor."""
    return figure(name, unit, [factor * value for value in values])


def ratio(name, values, others, goal=None, at_least=False):
    """The `Figure` of the ratios of two rivals, round by round."""
    pairs = zip(values, others, strict=True)
    return figure(name, "x", [a / b for a, b in pairs], goal, at_least)


def less(values, others):
    """Differences of two rivals, round by round."""
    return [a - b for a, b in zip(values, others, strict=True)]
