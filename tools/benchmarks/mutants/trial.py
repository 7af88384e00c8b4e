# SPDX-License-Identifier: Apache-2.0
"""The trial of a mutant: `mxeon check` of a copy of eonlib that holds it, cheapest tasks first."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mxeon.conformance.results import PASSED, SOURCE, Result
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import CURVE, PICTURE, Task, make_plan
from mxeon.errors import MxeonError
from mxeon.shaders import generators, library
from tools.benchmarks.mutants.mutant import FOLDERS, ROOT, Mutant
from tools.benchmarks.mutants.nodes import changed_nodes, node_tasks
from tools.benchmarks.mutants.reference import TESTS, trial_of_reference, trial_of_tests

KILLED, SURVIVED = "killed", "survived"
CRASHED = "crashed"  # a traceback in place of a verdict
TEXT = "text"

# What Cycles cannot show exactly or at all, tests run in Blender's OSL.
PROFILE, PROFILE_TESTS = "genosl/cycles/", ("tests/hosts/test_osl.py",)
NOISY = ("environment", "furnace")  # checks that take Cycles longest
# Files that no shader for gl holds: there the gl host has nothing to see.
ON_CYCLES = ("genosl/",)
NOT_ON_GL = (*ON_CYCLES, "libraries/diffuse/eonlib_genosl", "libraries/diffuse/eonlib_genmdl")
TEXT_FIRST = ("libraries/diffuse/eonlib_defs.mtlx",)  # other checks fail for what its check names


def trial(mutant: Mutant, judge: Judge, every: bool = False) -> dict[str, Any]:
    """Verdict on a mutant, and the failures that it caused on the first host that saw any."""
    if mutant.tests:
        return _by_tests(trial_of_reference(mutant))
    found = _on_hosts(mutant, judge, every)
    if found["verdict"] == SURVIVED and mutant.file.startswith(PROFILE):
        return _by_tests(trial_of_tests(mutant, (PROFILE_TESTS,)))
    return found


def _by_tests(failure: dict[str, Any] | None) -> dict[str, Any]:
    found = {"host": TESTS, "failures": [failure]} if failure else {}
    return {"verdict": KILLED if failure else SURVIVED} | found


def _on_hosts(mutant: Mutant, judge: Judge, every: bool) -> dict[str, Any]:
    nodes = bool(changed_nodes(mutant))
    with wrong_library(mutant) as path:
        try:
            limit = 1 if mutant.equivalent and not mutant.control and not nodes else None
            found = node_tasks(mutant, path) if nodes else stages(mutant, path)
            for host, stage in islice(found, limit):
                if failures := failures_of(stage, judge, every):
                    rows = ordered(failures)
                    seen = TEXT if rows[0]["host"] == SOURCE else host
                    return {"verdict": KILLED, "host": seen, "failures": rows}
        except MxeonError as error:
            message = first_line(str(error).replace(f"{Path(path).parent}/", ""))
            return {"verdict": KILLED, "host": TEXT, "refusal": message}
        except Exception as error:
            return {"verdict": CRASHED, "error": f"{type(error).__name__}: {error}"}
        return {"verdict": SURVIVED}


@contextmanager
def wrong_library(mutant: Mutant) -> Iterator[str]:
    """Path of a library that is eonlib with one change, in a folder that no cache knows."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        for name in FOLDERS:
            shutil.copytree(ROOT / name, Path(base, name))
        for file, text in mutant.texts().items():
            Path(base, file).write_text(text, encoding="utf-8")
        try:
            yield str(Path(base, "libraries"))
        finally:
            library.read_library.cache_clear()
            generators._library_generator.cache_clear()


def tasks_on_gl(path: str) -> list[Task]:
    """Tasks of `mxeon check --library` that judge something, on the first host."""
    return [task for task in make_plan((), ["gl"], [path]).tasks if task.check != CURVE]


def stages(mutant: Mutant, path: str) -> Iterator[tuple[str, list[Task]]]:
    """Hosts and tasks that can see a mutant, the cheapest first.

    The text and the nodes come first, then surface shaders, then pictures of documents one by one.
    """
    tasks = tasks_on_gl(path)
    if mutant.file.startswith(NOT_ON_GL):
        yield TEXT, [task for task in tasks if task.host == SOURCE]
    else:
        nodes = [task for task in tasks if task.check not in ("lobe", PICTURE)]
        text_first = mutant.file in TEXT_FIRST
        yield "gl", sorted(nodes, key=lambda task: (task.host == SOURCE) != text_first)
        yield "gl", [task for task in tasks if task.check == "lobe"]
        yield from (("gl", [task]) for task in tasks if task.check == PICTURE)
    if mutant.file.startswith(ON_CYCLES):
        yield from _on_cycles(path)


def _on_cycles(path: str) -> Iterator[tuple[str, list[Task]]]:
    """Tasks on Cycles, one by one."""
    planned = make_plan((), ["cycles"], [path]).tasks
    tasks = [task for task in planned if task.host == "cycles" and task.check != PICTURE]
    for task in sorted(tasks, key=lambda task: task.check in NOISY):
        yield "cycles", [task]


def failures_of(
    tasks: Sequence[Task], judge: Judge, every: bool = True, clean: str = "eonlib"
) -> list[Result]:
    """Results that pass with the library without a mutant alone: of all tasks, or of the first."""
    failures: list[Result] = []
    for task in tasks:
        found = _failed(task, judge)
        known = found and _clean_failures(replace(task, library=clean), judge)
        failures += [each for key, each in found.items() if key not in known]
        if failures and not every:
            break
    return failures


def _failed(task: Task, judge: Judge) -> dict[tuple[str, str], Result]:
    """Results that did not pass, by check and subject."""
    results = judge.work(task).results
    return {(each.check, each.subject): each for each in results if each.verdict != PASSED}


@cache
def _clean_failures(task: Task, judge: Judge) -> frozenset[tuple[str, str]]:
    return frozenset(_failed(task, judge))


def ordered(failures: list[Result]) -> list[dict[str, str]]:
    """Failures as plain data, those with the largest error in tolerances first."""
    return [
        {
            "check": each.check,
            "subject": Path(each.subject).name if each.subject.startswith("/") else each.subject,
            "host": each.host,
            "excess": each.excess,
            "diagnosis": first_line(each.diagnosis or f"not run: {each.reason}"),
        }
        for each in sorted(failures, key=_ratio, reverse=True)
    ]


def _ratio(result: Result) -> float:
    """Error in tolerances; infinite where a shader does not compile."""
    if result.error is None:
        return float("inf")
    return result.error / max(result.tolerance or 0.0, 1e-9)


def first_line(text: str) -> str:
    """The first line of a text, where compilers print many."""
    return text.strip().splitlines()[0] if text.strip() else ""
