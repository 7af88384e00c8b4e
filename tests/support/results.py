# SPDX-License-Identifier: Apache-2.0
"""Invented results and journals, for tests that process results."""

from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from mxeon.conformance.results import (
    Cause,
    Control,
    Diagnosis,
    Difference,
    Kind,
    Picture,
    Region,
    Result,
    Run,
    quoted,
)
from mxeon.conformance.run import read_run, to_run
from mxeon.conformance.run.journal import JOURNAL, LOCK, PREVIOUS, Journal, read_journal
from mxeon.conformance.run.plan import Findings, Plan, Task
from mxeon.hosts.base import Identity
from tests.support.verdicts import FAILED, PASSED

__all__ = ["Control", "Difference", "Identity", "Picture", "Region", "Result", "Run", "quoted"]
__all__ += ["JOURNAL", "LOCK", "PREVIOUS", "read_journal", "read_run", "to_run"]

EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
TASKS = tuple(Task("value", name, "gl", "eonlib") for name in "abc")
OPTIONS, FILES = {"--maxSize": "9"}, {"clay.mtlx": "00", "clay.png": "01"}
PLAN = Plan("1.0", {"Python": "3"}, TASKS, OPTIONS, FILES, documents=(Path("clay.mtlx"),))
PIXELS = np.linspace(0.0, 1.0, 12, dtype=np.float32).reshape(2, 2, 3)


def made(verdict=PASSED, key="value", subject=EON, library="eonlib", host="gl", **fields):
    """Result with invented values, as if a check had judged a node (by default, the EON node)."""
    error = {PASSED: 1e-7, FAILED: 0.37}.get(verdict)
    numbers = {"error": error, "tolerance": 2e-6} if error else {}
    return Result(key, "claim", subject, host, library, verdict, **numbers | fields)


def shown(element, verdict=PASSED, document="a/clay.mtlx", key="picture", **fields):
    """Result with invented values, as if a document's material had been rendered and judged."""
    place = {"document": document, "element": element}
    return made(verdict, key, f"{Path(document).name}: {element}", **place | fields)


def made_run(*results, documents=("a/clay.mtlx",), **fields):
    contents = dict.fromkeys(documents, (EON,))
    software, hosts = {"MaterialX": "1.39.5"}, (Identity("gl", "4.5", "cpu"),)
    return Run("1", software, hosts, results, contents=contents, **fields)


INFINITE = {"error": float("inf"), "worst": {"wo": [0.0, 1.0]}}
INFINITE["control"] = Control("wrong", 2.0, True)
FINDINGS = Findings(
    results=(made(FAILED, subject="a", **INFINITE),),
    pictures=(Picture("d", "e", "gl", "eonlib", "side", PIXELS, None, {"version": "1"}),),
    notes=(("text", "place"),),
    errors=("broken",),
    hosts=(Identity("gl", "4.5", "device"),),
)


def caused(kind, key="", *names, distances=None, **fields):
    return Diagnosis((Cause(Kind(kind), key, names, **fields),), distances or {})


@contextmanager
def journal(folder, plan=PLAN, **options):
    with Journal(folder, **options) as written:
        written.begin(plan)
        yield written


def kept(folder, *results):
    """Write the journal of a run with the given results, and return the journal's folder."""
    tasks = tuple(Task(each.check, each.subject, each.host, each.library) for each in results)
    with journal(folder, replace(PLAN, tasks=tasks)) as written:
        for number, each in enumerate(results):
            written.add(number, Findings(results=(each,)))
    return folder
