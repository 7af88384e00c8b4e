# SPDX-License-Identifier: Apache-2.0
"""Shared code of benchmarks: interleaved rounds, figures with goals, and their tables.

The functions to compare take turns within a round, so other load on the machine affects all of them
equally; a ratio is the median of the rounds' ratios. Benchmark libraries time functions one after
another, so drift of the machine would affect their ratios.
"""

import time
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Figure:
    """A measured quantity: median and quartiles over the rounds."""

    name: str
    unit: str  # "x" for a ratio
    median: float
    low: float
    high: float
    goal: float | None = None  # upper limit of the median

    @property
    def reached(self):
        """Whether the median reaches the goal; None without a goal."""
        return None if self.goal is None else self.median <= self.goal


@dataclass(frozen=True)
class Check:
    """Largest error of the values that a timed function computed."""

    name: str
    error: float
    tolerance: float

    @property
    def passed(self):
        """Whether the error is a number within the tolerance."""
        return self.error <= self.tolerance


@dataclass(frozen=True)
class Group:
    title: str
    figures: tuple = ()
    checks: tuple = ()


def interleave(rivals, rounds, clock=time.perf_counter):
    """Time functions in turns: an array of seconds by name, one per round after a warm-up round.

    The clock `time.process_time` excludes other processes, and adds up the time of all cores.
    """
    found = {name: [] for name in rivals}
    for _ in range(rounds + 1):
        for name, rival in rivals.items():
            start = clock()
            rival()
            found[name].append(clock() - start)
    return {name: np.array(seconds[1:]) for name, seconds in found.items()}


def clock_of(device):
    """Clock for an OpenGL device: processor time for software devices, otherwise wall time."""
    return time.process_time if "llvmpipe" in device else time.perf_counter


def figure(name, unit, values, goal=None):
    """Summarize values, one per round, as a `Figure`.

    >>> figure("value", "x", [3.0, 1.0, 2.0], goal=2.0).reached
    True
    """
    low, median, high = np.quantile(values, (0.25, 0.5, 0.75)).tolist()
    return Figure(name, unit, median, low, high, goal)


def table(group):
    """Markdown table of a group's figures and checks."""
    lines = [f"## {group.title}", "", "| | median | quartiles | goal | |", "|---|---|---|---|---|"]
    for each in group.figures:
        goal = "" if each.goal is None else f"≤ {each.goal:g}"
        verdict = {None: "", True: "reached", False: "**missed**"}[each.reached]
        cells = f"{each.median:.3g} {each.unit} | {each.low:.3g} – {each.high:.3g} | {goal}"
        lines.append(f"| {each.name} | {cells} | {verdict} |")
    if group.checks:
        right = sum(each.passed for each in group.checks)
        lines += ["", f"Values: {right} of {len(group.checks)} within tolerance."]
        lines += ["", "| values of | largest error | tolerance |", "|---|---|---|"]
        lines += [f"| {c.name} | {c.error:.2g} | {c.tolerance:.2g} |" for c in group.checks]
    return "\n".join(lines)
