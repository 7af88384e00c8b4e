# SPDX-License-Identifier: Apache-2.0
"""Results of the benchmarks as JSON, with the machine and the versions that made them."""

import json
import os
import platform
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

import moderngl
import numpy as np

from tools.benchmarks.rounds import Check, Figure, Group

PACKAGES = ("mxeon", "MaterialX", "numpy", "moderngl", "numba", "mitsuba")


def machine():
    """Hardware and versions that the figures depend on, by name."""
    found = {
        "processor": _processor(),
        "NumPy's vectors": _vectors(),
        "cores": os.cpu_count(),
        "load before": round(os.getloadavg()[0], 2),
        "system": platform.platform(terse=True),
        "Python": platform.python_version(),
        "date": datetime.now(UTC).date().isoformat(),
    }
    return found | {name: _version(name) for name in PACKAGES}


# Features of processors that NumPy has code for, the widest first, and their width.
VECTORS = {
    "AVX512_SKX": "AVX-512, 512 bits",
    "AVX2": "AVX2, 256 bits",
    "SVE": "SVE",
    "ASIMD": "ASIMD, 128 bits",
    "SSE42": "SSE4.2, 128 bits",
}


def _vectors():
    """The widest vectors that NumPy uses; NPY_DISABLE_CPU_FEATURES takes some from it."""
    enabled = np._core._multiarray_umath.__cpu_features__
    return next((VECTORS[name] for name in VECTORS if enabled.get(name)), "unknown")


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


def write(file, groups, kind="", seconds=None):
    """Write the groups, measured in so many seconds; those of another run or kind of machine stay."""
    kept = {}
    if file.is_file():
        kept = json.loads(file.read_text(encoding="utf-8"))["groups"]
    setting = machine() | {"OpenGL": _renderer(), "load before": LOAD}
    setting["load after"] = round(os.getloadavg()[0], 2)
    setting |= {} if seconds is None else {"minutes": round(seconds / 60.0, 1)}
    setting |= {"kind": kind} if kind else {}
    for group in groups:
        title = f"{group.title}; {kind}" if kind else group.title
        key = f"{group.name}; {kind}" if kind else group.name
        kept[key] = asdict(group) | {"title": title, "machine": setting}
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
