# SPDX-License-Identifier: Apache-2.0
"""Shared code of benchmarks: interleaved rounds, figures with goals, and tables of figures.

Compared functions take turns within a round, so that other load on the machine affects all
functions equally. A ratio is the median of the ratios of all rounds.
"""

import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Figure(NamedTuple):
    """A measured quantity, with a value for each round."""

    name: str
    unit: str  # "x" if the quantity is a ratio
    values: ArrayLike
    goal: float | None = None  # upper limit of the median


class Check(NamedTuple):
    """Largest error of a timed function's values, and the tolerance."""

    name: str
    error: float
    tolerance: float

    @property
    def passed(self):
        return self.error <= self.tolerance  # False for NaN


class Group(NamedTuple):
    title: str
    figures: Sequence[Figure]
    checks: Sequence[Check] = ()


def interleave(functions, rounds, clock=time.perf_counter):
    """Seconds of each function in each round, by name. Functions take turns after a warm-up round.

    The clock `time.process_time` adds the times of all cores, and excludes other processes.
    """
    seconds = {name: [] for name in functions}
    for _ in range(rounds + 1):
        for name, function in functions.items():
            start = clock()
            function()
            seconds[name].append(clock() - start)
    return {name: np.array(each[1:]) for name, each in seconds.items()}


def clock_of(device):
    """Clock for an OpenGL device: processor time for a software device, otherwise wall time."""
    return time.process_time if "llvmpipe" in device else time.perf_counter


def table(group):
    lines = [f"## {group.title}", "", "| | median | quartiles | goal | |", "|---|---|---|---|---|"]
    for name, unit, values, goal in group.figures:
        low, median, high = np.quantile(values, (0.25, 0.5, 0.75))
        limit = verdict = ""
        if goal is not None:
            limit, verdict = f"≤ {goal:g}", "reached" if median <= goal else "**missed**"
        lines.append(
            f"| {name} | {median:.3g} {unit} | {low:.3g} – {high:.3g} | {limit} | {verdict} |"
        )
    if group.checks:
        passed = sum(each.passed for each in group.checks)
        lines += ["", f"Values: {passed} of {len(group.checks)} within tolerance."]
        lines += ["", "| values of | largest error | tolerance |", "|---|---|---|"]
        lines += [f"| {c.name} | {c.error:.2g} | {c.tolerance:.2g} |" for c in group.checks]
    return "\n".join(lines)
