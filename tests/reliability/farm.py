# SPDX-License-Identifier: Apache-2.0
"""Time of one run on Dask clusters of several sizes, and what it sends over the network."""

import os
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from distributed import LocalCluster

from mxeon.conformance.run import check
from mxeon.jobs.processes import safe_path
from tests.reliability.memory import document

WORKERS = (1, 2, 4)
DOCUMENTS = 48


def measure(workers=WORKERS, documents=DOCUMENTS, progress=iter):
    """Seconds of a run on clusters of processes of this machine, from the first item to the last.

    Returns
    -------
    dict
        workers, seconds: lists of equal length; cores of this machine; documents; mebibytes of
        a picture and the reference's when they travel.
    """
    with TemporaryDirectory(prefix="mxeon-farm-") as base:
        files = [document(Path(base), number) for number in range(documents)]
        seconds = [_seconds(files, count) for count in progress(workers)]
        run = check(files[:1], workers=1, nodes=["common"])
    sizes = [picture.image.nbytes + picture.reference.nbytes for picture in run.pictures]
    return {
        "workers": list(workers),
        "seconds": seconds,
        "cores": os.cpu_count(),
        "documents": documents,
        "picture_mebibytes": max(sizes) / 2**20,
    }


def _seconds(files, workers):
    options = {"threads_per_worker": 1, "dashboard_address": ":0"}
    with safe_path(), LocalCluster(n_workers=workers, **options) as cluster:
        check(files[:1], scheduler=cluster.scheduler_address, nodes=["common"])  # opens the hosts
        began = time.monotonic()
        run = check(files, scheduler=cluster.scheduler_address, nodes=["common"])
        assert {each.verdict for each in run.results} == {"passed"}
        return time.monotonic() - began
