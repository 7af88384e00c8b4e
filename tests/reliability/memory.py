# SPDX-License-Identifier: Apache-2.0
"""Memory of a run against its number of documents."""

import time
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text
from tests.reliability.runs import start

COUNTS = (10, 100, 1000)
MIB = 1 << 20


def measure(counts=COUNTS, progress=iter):
    """Peak memory in MiB of the parent and of its largest worker, for each number of documents."""
    found = {"documents": list(counts), "parent": [], "worker": [], "seconds": [], "ended": []}
    for count in progress(counts):
        with TemporaryDirectory(prefix="mxeon-memory-") as base:
            files = [document(Path(base), number) for number in range(count)]
            began = time.monotonic()
            process = start(Path(base, "run"), files=files, capture=False)
            parent, worker = _peaks(process)
            found["parent"].append(parent / MIB)
            found["worker"].append(worker / MIB)
            found["seconds"].append(time.monotonic() - began)
            found["ended"].append(process.wait())
    return found


def document(folder, number):
    """A material that no other document has."""
    path = folder / f"document_{number:04}.mtlx"
    color = (number % 97 / 97, 0.5, number % 31 / 31)
    path.write_text(
        material_text(OREN_NAYAR, {"color": color, "roughness": number % 13 / 13, FLAG: True})
    )
    return path


def _peaks(process):
    """Largest memory of a process and of any of its children, sampled until it ends."""
    parent = worker = 0
    while process.poll() is None:
        with suppress(psutil.Error):
            parent = max(parent, process.memory_info().rss)
            children = process.children(recursive=True)
            worker = max([worker, *(child.memory_info().rss for child in children)])
        time.sleep(0.1)
    return parent, worker
