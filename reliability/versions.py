# SPDX-License-Identifier: Apache-2.0
"""Every wheel of MaterialX: what mxeon says of it, and what its shaders are on each host."""

from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon import versions
from mxeon.conformance import read_run
from reliability.runs import DOCUMENT

WHEELS = ("1.38.10", "1.39.0", "1.39.1", "1.39.2", "1.39.3", "1.39.4", "1.39.5")
HOSTS = ("gl", "webgl", "vulkan", "slang")
NODE = "libraries/pbrlib/genglsl/mx_oren_nayar_diffuse_bsdf.glsl"


def measure(progress=iter):
    """Figures of every wheel.

    Returns
    -------
    dict
        hosts; rows: of each version whether its node takes the closure data that eonlib's sources
        need, the line with which it is refused, or the verdicts by host.
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
    return row | {"verdicts": tally}
