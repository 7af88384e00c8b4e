# SPDX-License-Identifier: Apache-2.0
"""Results of the benchmarks as JSON and Markdown, with the machine and the versions."""

import json
import os
import platform
import time
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

import moderngl

from tools.benchmarks.rounds import Check, Figure, Group

PACKAGES = ("mxeon", "MaterialX", "numpy", "moderngl", "mitsuba")


def machine():
    """Hardware and versions that the figures depend on, by name."""
    found = {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load before": round(os.getloadavg()[0], 2),
        "system": platform.platform(terse=True),
        "Python": platform.python_version(),
        "date": datetime.now(UTC).date().isoformat(),
    }
    return found | {name: _version(name) for name in PACKAGES}


def _renderer():
    """OpenGL's device, which for llvmpipe states the width of its vectors."""
    try:
        context = moderngl.create_standalone_context(require=430, backend="egl")
    except Exception:  # moderngl and glcontext raise bare Exception
        return "none"
    renderer = context.info["GL_RENDERER"]
    context.release()
    return renderer


def _processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _version(name):
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


LOAD = machine()["load before"]


def write(file, group, kind="", start=None):
    """Add a group to the file; `start` is when its measurement began, by the monotonic clock."""
    kept = json.loads(file.read_text(encoding="utf-8"))["groups"] if file.is_file() else {}
    setting = machine() | {"OpenGL": _renderer(), "load before": LOAD}
    setting["load after"] = round(os.getloadavg()[0], 2)
    setting |= {} if start is None else {"minutes": round((time.monotonic() - start) / 60.0, 1)}
    setting |= {"kind": kind} if kind else {}
    suffix = f"; {kind}" if kind else ""
    title = {"title": group.title + suffix, "machine": setting}
    kept[group.name + suffix] = asdict(group) | title
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"groups": kept}, indent=1) + "\n", encoding="utf-8")


def read(file):
    """Pairs of a group and the machine it was measured on."""
    return [
        (
            Group(
                each["name"],
                each["title"],
                tuple(Figure(**figure) for figure in each["figures"]),
                tuple(Check(**check) for check in each["checks"]),
            ),
            each["machine"],
        )
        for each in json.loads(file.read_text(encoding="utf-8"))["groups"].values()
    ]


def page(file):
    """Goals, and the tables of all groups, in Markdown."""
    measured = read(file)
    parts = ["# Benchmarks", goals([group for group, _ in measured])]
    for group, setting in measured:
        words = ", ".join(f"{name} {value}" for name, value in setting.items())
        parts += [table(group), f"Measured on: {words}."]
    return "\n\n".join(parts) + "\n"


def goals(groups):
    """How many goals each group reaches, and those that it misses, in Markdown."""
    lines = ["## Goals", "", "| group | reached | missed |", "|---|---|---|"]
    for group in groups:
        aims = [each for each in group.figures if each.goal is not None]
        missed = [
            f"{each.name} ({each.median:.3g} {each.unit}, goal {each.goal:g})"
            for each in aims
            if not each.reached
        ]
        if aims:
            count = f"{len(aims) - len(missed)} of {len(aims)}"
            lines.append(f"| {group.title} | {count} | {'; '.join(missed)} |")
    return "\n".join(lines)


def table(group):
    """The figures of a group and its checks, in Markdown."""
    lines = [f"## {group.title}", "", "| | median | quartiles | goal | |", "|---|---|---|---|---|"]
    for each in group.figures:
        sign = "≥" if each.at_least else "≤"
        goal = "" if each.goal is None else f"{sign} {each.goal:g}"
        verdict = {None: "", True: "reached", False: "**missed**"}[each.reached]
        cells = f"{each.median:.3g} {each.unit} | {each.low:.3g} – {each.high:.3g} | {goal}"
        lines.append(f"| {each.name} | {cells} | {verdict} |")
    if group.checks:
        right = sum(each.passed for each in group.checks)
        lines += ["", f"Values: {right} of {len(group.checks)} within tolerance."]
        lines += ["", "| values of | largest error | tolerance |", "|---|---|---|"]
        lines += [f"| {c.name} | {c.error:.2g} | {c.tolerance:.2g} |" for c in group.checks]
    return "\n".join(lines)
