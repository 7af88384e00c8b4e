# SPDX-License-Identifier: Apache-2.0
"""Results of the benchmarks as JSON, with the machine and the versions that made them."""

import json
import os
import platform
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from benchmarks.rounds import Check, Figure, Group

PACKAGES = ("mxeon", "MaterialX", "numpy", "moderngl", "numba")


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


def write(file, groups):
    """Write the groups; those of an earlier run that are not among them stay."""
    kept = {}
    if file.is_file():
        kept = json.loads(file.read_text(encoding="utf-8"))["groups"]
    setting = machine() | {"load before": LOAD}
    for group in groups:
        kept[group.name] = asdict(group) | {"machine": setting}
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"groups": kept}, indent=1) + "\n", encoding="utf-8")


def read(file):
    """Pairs of a group and the machine it was measured on."""
    stored = json.loads(file.read_text(encoding="utf-8"))["groups"].values()
    return [(_group(each), each["machine"]) for each in stored]


def _group(stored):
    return Group(
        stored["name"],
        stored["title"],
        tuple(Figure(**each) for each in stored["figures"]),
        tuple(Check(**each) for each in stored["checks"]),
        stored["series"],
    )
