# SPDX-License-Identifier: Apache-2.0
"""Every wheel of MaterialX: what mxeon says of it, and what its shaders are on each host."""

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon import versions
from mxeon.conformance import read_run
from reliability.runs import DOCUMENT

WHEELS = ("1.38.10", "1.39.0", "1.39.1", "1.39.2", "1.39.3", "1.39.4", "1.39.5")
HOSTS = ("gl", "webgl", "vulkan", "slang")
ROOT = Path(__file__).resolve().parents[1]
NODE = "libraries/pbrlib/genglsl/mx_oren_nayar_diffuse_bsdf.glsl"


def measure(progress=iter):
    """Figures of every wheel.

    Returns
    -------
    dict
        hosts; rows: of each version whether its node takes the closure data that eonlib's sources
        need, the line with which it is refused, or the verdicts by host and what text of a document
        reaches source unjudged.
    """
    with TemporaryDirectory(prefix="mxeon-versions-") as base:
        return {"hosts": HOSTS, "rows": [_row(version, Path(base, version)) for version in progress(WHEELS)]}


def _row(version, folder):
    versions.install(version, folder / "wheel")
    node = folder / "wheel" / "MaterialX" / NODE
    row = {"version": version, "closure": node.is_file() and "ClosureData" in node.read_text()}
    options = [option for host in HOSTS for option in ("--host", host)]
    try:
        arguments = [str(DOCUMENT), *options]
        versions.check_in(folder / "wheel", version, arguments, folder / "report")
    except ValueError as refused:
        return row | {"refused": str(refused)}
    tally = {host: Counter() for host in HOSTS}
    for result in read_run(folder / "report").results:
        if result.host in tally:
            tally[result.host][result.verdict] += 1
    return row | {"verdicts": tally, "unjudged": _unjudged(folder / "wheel")}


def _unjudged(environment):
    """Lines of `fuzz.reach`, run with the MaterialX of a folder, of what is not judged."""
    paths = os.pathsep.join(map(str, (environment, ROOT)))
    command = [sys.executable, "-P", "-m", "fuzz.reach"]
    done = subprocess.run(command, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if line.startswith("not judged")]
    return lines or ([] if done.returncode == 0 else [done.stderr.strip().splitlines()[-1]])
