# SPDX-License-Identifier: Apache-2.0
"""Every wheel of MaterialX: whether mxeon runs with it, and what its shaders are on each host.

A version is a folder that comes before all others on the path of Python, so that everything else
is what it is here.
"""

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon.conformance.run import read_run
from tests.reliability.faults import DOCUMENT

ROOT = Path(__file__).resolve().parents[2]

WHEELS = ("1.38.10", "1.39.0", "1.39.1", "1.39.2", "1.39.3", "1.39.4", "1.39.5")
HOSTS = ("gl", "webgl", "vulkan", "slang")
DOWNLOAD = 300.0  # seconds, of 25 MB
NODE = "libraries/pbrlib/genglsl/mx_oren_nayar_diffuse_bsdf.glsl"


def measure(progress=iter):
    """Figures of every wheel."""
    with TemporaryDirectory(prefix="mxeon-versions-") as base:
        rows = [_row(version, Path(base, version)) for version in progress(WHEELS)]
    return {"hosts": HOSTS, "rows": rows}


def install(version, folder):
    """Install a version of MaterialX, and nothing else, into a new folder."""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", folder]
    command += ["--timeout", "30", f"materialx=={version}"]
    subprocess.run(command, check=True, capture_output=True, timeout=DOWNLOAD)


def run(folder, *arguments, module="mxeon"):
    """A module run as a command with the MaterialX of a folder: the finished process."""
    paths = [str(folder), *map(str, (ROOT, ROOT / "python"))]
    if os.environ.get("PYTHONPATH"):
        paths.append(os.environ["PYTHONPATH"])
    return subprocess.run(
        [sys.executable, "-P", "-m", module, *arguments],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
    )


def _row(version, folder):
    wheel, report = folder / "wheel", folder / "report"
    install(version, wheel)
    node = wheel / "MaterialX" / NODE
    row = {"version": version, "closure": node.is_file() and "ClosureData" in node.read_text()}
    hosts = [word for host in HOSTS for word in ("--host", host)]
    process = run(
        wheel, "check", str(DOCUMENT), "--node", "common", *hosts, "--report", str(report)
    )
    if process.returncode == 2:
        return row | {"refused": process.stderr.strip()}
    tally = {host: Counter() for host in HOSTS}
    for result in read_run(report).results:
        if result.host in tally:
            tally[result.host][result.verdict] += 1
    return row | {"verdicts": tally, "unjudged": _unjudged(wheel)}


def _unjudged(wheel):
    """Lines of `tests.fuzz.reach`, run with the MaterialX of a folder, of what is not judged."""
    process = run(wheel, module="tests.fuzz.reach")
    lines = [line for line in process.stdout.splitlines() if line.startswith("not judged")]
    return lines or ([] if process.returncode == 0 else [process.stderr.strip().splitlines()[-1]])
