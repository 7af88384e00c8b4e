# SPDX-License-Identifier: Apache-2.0
"""A plan of a run, findings of its tasks, and their journal."""

import numpy as np

from mxeon.conformance.results import FAILED, AlbedoCurve, Control, Picture, Result
from mxeon.conformance.run.journal import Journal
from mxeon.conformance.run.plan import Findings, Plan, Task
from mxeon.hosts.base import Identity

TASKS = tuple(Task("value", name, "gl", "eonlib") for name in "abc")
OPTIONS, FILES = {"--maxSize": "9"}, {"clay.mtlx": "00", "clay.png": "01"}
PLAN = Plan("1.0", {"Python": "3"}, TASKS, ("clay.mtlx",), OPTIONS, FILES)
PIXELS = np.linspace(0.0, 1.0, 12, dtype=np.float32).reshape(2, 2, 3)
FINDINGS = Findings(
    results=(
        Result(
            "value",
            "claim",
            "a",
            "gl",
            "eonlib",
            FAILED,
            error=float("inf"),
            tolerance=1.0,
            worst={"wo": [0.0, 1.0]},
            control=Control("wrong", 2.0, True),
        ),
    ),
    pictures=(Picture("d", "e", "gl", "eonlib", "side", PIXELS, None, {"version": "1"}),),
    curves=(
        AlbedoCurve(
            "a", "gl", "eonlib", (1.0, 0.5, 0.0), 0.5, np.arange(2.0), PIXELS[0], PIXELS[1]
        ),
    ),
    notes=(("text", "place"),),
    errors=("broken",),
    hosts=(Identity("gl", "4.5", "device"),),
)


def journal(folder, plan=PLAN, **options):
    return Journal(folder, plan, **options)
