# SPDX-License-Identifier: Apache-2.0
"""Tests a mutant by running `mxeon check` on a mutated copy of eonlib, cheapest tasks first.

A mutant of pbrlib is tested by the checks of all nodes that use the mutated code. A mutant of the
reference is tested by the tests of the models, which run on a mutated copy of mxeon. Any other
mutant is tested by all checks of eonlib.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

from mxeon.conformance import words
from mxeon.conformance.results import PASSED, SOURCE, Result
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import PICTURE, Task, make_plan
from mxeon.conformance.specs import PBRLIB
from mxeon.conformance.specs.combinations import COMBINED_SPECS
from mxeon.errors import MxeonError
from mxeon.shaders import generators, library
from mxeon.shaders.nodes import EON, OREN_NAYAR
from tools.benchmarks.mutants import operators
from tools.benchmarks.mutants.mutant import FOLDERS, ROOT, Mutant

KILLED, SURVIVED = "killed", "survived"
CRASHED = "crashed"
TEXT, TESTS = "text", "tests"  # values of `host` if no host is needed

PATH = "genglsl/path/"  # code for path tracers; no check runs this code
# Tests by folder of the mutated file. For PATH, the tests replace the checks. For other folders,
# the tests run after the checks, because the checks cannot detect some mutants.
FOLDER_TESTS = {
    PATH: ("tests/shaders/test_path_tracing.py",),
    "genosl/cycles/": ("tests/hosts/test_osl.py",),  # runs Blender's OSL
    operators.ENVIRONMENT: (
        "tests/conformance/test_conformance.py::test_other_lobes_are_lit_alike_by_eonlib_s_lookups",
        "tests/hosts/test_document_hosts.py::"
        "test_microfacets_in_the_dome_of_storm_are_as_bright_as_their_albedo",
    ),
}
LOBE = "genglsl/lib/microfacet_lobe.glsl"  # calls environment lookups without an #include
NOISY = ("environment", "furnace")  # slowest checks on Cycles
# Shaders for gl do not contain the following files, so gl cannot detect mutants in these files.
ON_CYCLES = ("genosl/",)
CLOSURES = "libraries/diffuse/eonlib_genosl"  # calls closures that only the host osl evaluates
NOT_ON_GL = (*ON_CYCLES, CLOSURES, "libraries/diffuse/eonlib_genmdl")
TEXT_FIRST = ("libraries/diffuse/eonlib_defs.mtlx",)


def trial(mutant: Mutant, judge: Judge) -> dict[str, Any]:
    """Verdict on a mutant, with the failed checks and the first cause in the first failed task."""
    if mutant.tests:
        named = tuple(f"{MODEL_TESTS}/{name}" for name in mutant.tests)
        return by_tests(mutant, (named,) if mutant.equivalent else (named, (MODEL_TESTS,)))
    found = {"verdict": SURVIVED}
    if not mutant.file.startswith(PATH):
        found = by_checks(mutant, judge)
    for folder, tests in FOLDER_TESTS.items():
        if found["verdict"] == SURVIVED and mutant.file.startswith(folder):
            found = by_tests(mutant, (tests,))
    return found


def by_checks(mutant: Mutant, judge: Judge) -> dict[str, Any]:
    """Verdict of checks on a mutated copy of eonlib, with failures in the first failed task."""
    nodes = bool(changed_nodes(mutant))
    with wrong_library(mutant) as path:
        try:
            limit = 1 if mutant.equivalent and not mutant.control and not nodes else None
            found = node_tasks(mutant, path) if nodes else stages(mutant, path)
            for host, stage in islice(found, limit):
                if failures := failures_of(stage, judge):
                    first = failures[0]
                    place = TEXT if first.host == SOURCE else host
                    cause = words.diagnosis(first.diagnosis) or f"not run: {first.reason}"
                    return killed(place, [each.check for each in failures], cause)
        except MxeonError as error:
            return killed(TEXT, ["refused"], str(error).replace(f"{Path(path).parent}/", ""))
        except Exception as error:
            return {"verdict": CRASHED, "error": f"{type(error).__name__}: {error}"}
        return {"verdict": SURVIVED}


def killed(host: str, checks: Sequence[str], explanation: str) -> dict[str, Any]:
    """Record of a detected mutant, with the first line of the explanation."""
    line, folder = explanation.strip().split("\n")[0], re.escape(tempfile.gettempdir())
    line, found = re.sub(rf"{folder}/\S*/", "", line), list(dict.fromkeys(checks))
    return {"verdict": KILLED, "host": host, "checks": found, "explanation": line}


def write_wrong(mutant: Mutant, base: str, *folders: str) -> None:
    """Copy folders of the repository to `base`, and write the mutant's files there."""
    for name in folders:
        shutil.copytree(ROOT / name, Path(base, name))
    for file, text in mutant.texts().items():
        Path(base, file).write_text(text, encoding="utf-8")


@contextmanager
def wrong_library(mutant: Mutant) -> Iterator[str]:
    """Path of a mutated copy of eonlib, in a new folder that no cache knows."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        write_wrong(mutant, base, *FOLDERS)
        try:
            yield str(Path(base, "libraries"))
        finally:
            library.read_library.cache_clear()
            generators._library_generator.cache_clear()


def failures_of(tasks: Sequence[Task], judge: Judge) -> list[Result]:
    """New failures, compared with unchanged eonlib, in the first task that has new failures."""
    for task in tasks:
        if failures := _failed(task, judge):
            known = _original_failures(replace(task, library="eonlib"), judge)
            if new := [each for key, each in failures.items() if key not in known]:
                return new
    return []


def _failed(task: Task, judge: Judge) -> dict[tuple[str, str], Result]:
    """Results of a task by check and subject, except results with the verdict PASSED."""
    results = judge.work(task).results
    return {(each.check, each.subject): each for each in results if each.verdict != PASSED}


_original_failures = cache(_failed)  # results of unchanged eonlib stay the same


# --- tasks of a library ---------------------------------------------------------------------------


def stages(mutant: Mutant, path: str) -> Iterator[tuple[str, list[Task]]]:
    """Yield hosts and tasks that can detect a mutant, beginning with the cheapest tasks.

    The order is text and nodes, surface shaders, pictures of documents, OSL closures, and Cycles.
    Each picture and each task of Cycles is a separate stage.
    """
    tasks = make_plan((), ["gl"], [path]).tasks
    if mutant.file.startswith(NOT_ON_GL):
        yield TEXT, [task for task in tasks if task.host == SOURCE]
    else:
        nodes = [task for task in tasks if task.check not in ("lobe", PICTURE)]
        text_first = mutant.file in TEXT_FIRST
        yield "gl", sorted(nodes, key=lambda task: (task.host == SOURCE) != text_first)
        yield "gl", [task for task in tasks if task.check == "lobe"]
        yield from (("gl", [task]) for task in tasks if task.check == PICTURE)
    if mutant.file.startswith(CLOSURES):
        planned = make_plan((), ["osl"], [path], nodes=(OREN_NAYAR, EON)).tasks
        yield "osl", [task for task in planned if task.host == "osl"]
    if mutant.file.startswith(ON_CYCLES):
        planned = make_plan((), ["cycles"], [path]).tasks
        chosen = [task for task in planned if task.host == "cycles" and task.check != PICTURE]
        for task in sorted(chosen, key=lambda task: task.check in NOISY):
            yield "cycles", [task]


# --- tasks of nodes of pbrlib ---------------------------------------------------------------------

DOCUMENTS = (
    "libraries/diffuse/eonlib_genglsl_impl.mtlx",
    "libraries/pbrlib/eonlib_pbrlib_genglsl_impl.mtlx",
    "libraries/pbrlib/eonlib_pbrlib_genosl_impl.mtlx",
    "genosl/cycles/eonlib_cycles_impl.xml",
)
INCLUDE = re.compile(r'^#include "([\w./]+)"$', re.MULTILINE)
# Pairs of a target and a host that runs shaders for the target. The cheapest host is first.
HOSTS = (("genglsl", "gl"), ("genosl", "osl"), ("genosl", "cycles"))
LATE = ("inputs", "transmitted_inputs", "integral", "energy")


def changed_nodes(mutant: Mutant) -> set[tuple[str, str]]:
    """Target and title of each subject whose code a mutant changes."""
    texts = mutant.texts()
    changed = {LOBE if each.startswith(operators.ENVIRONMENT) else each for each in texts}
    entries: set[tuple[str, ...]] = set()
    for document in DOCUMENTS:
        original = _entries(document, (ROOT / document).read_text(encoding="utf-8"))
        entries |= {entry for entry in original if not changed.isdisjoint(_sources(entry[2]))}
        if document in texts:
            mutated = set() if mutant.control else _entries(document, texts[document])
            entries |= original ^ mutated
    return {(target, title) for nodedef, target, *_ in entries for title in _titles(nodedef)}


def node_tasks(mutant: Mutant, path: str) -> Iterator[tuple[str, list[Task]]]:
    """Yield each host with the tasks on subjects whose code a mutant changes."""
    changed = changed_nodes(mutant)
    for target, host in HOSTS:
        titles = {title for each, title in changed if each == target}
        tasks = [task for task in _tasks(host) if task.subject in titles and task.host == host]
        yield host, [replace(task, library=path) for task in tasks]


@cache
def _tasks(host: str) -> tuple[Task, ...]:
    """All tasks of a host with eonlib, grouped by subject to compile each shader once.

    The order of subjects is reversed, because transmission, the last subject, runs most code. Films
    come last, because failures of films take longest to diagnose.
    """
    places = {spec.title: -place for place, spec in enumerate(PBRLIB)}
    tasks = make_plan((), [host], ["eonlib"], nodes=["all"]).tasks

    def order(task: Task) -> tuple[bool, bool, int]:
        return task.check in LATE, "film" in task.subject, places.get(task.subject, 0)

    return tuple(sorted(tasks, key=order))


@cache
def _titles(nodedef: str) -> frozenset[str]:
    definition = library.load_library("eonlib").getNodeDef(nodedef)
    if not definition:
        return frozenset()
    kind, node = definition.getType(), definition.getNodeString()
    titles = {spec.title for spec in PBRLIB if spec.node == node}
    for word in ("EDF", "VDF"):  # nodes such as `add` have several types
        titles = {title for title in titles if (word in title.upper()) == (word == kind)}
    if kind == "BSDF" and titles:  # a rough diffuse node has none here, and is judged by `stages`
        combined = (spec for spec in PBRLIB if spec in COMBINED_SPECS)
        titles |= {spec.title for spec in combined if f"<{node} " in spec.document()}
    return frozenset(titles)


@cache
def _sources(file: str) -> frozenset[str]:
    """Paths of a file and of all files that the file includes, directly or indirectly."""
    path = ROOT / file
    if not path.is_file():
        return frozenset()
    included = INCLUDE.findall(path.read_text(encoding="utf-8"))
    paths = (os.path.normpath(Path(file).parent / each) for each in included)
    return frozenset({file}.union(*map(_sources, paths)))


def _entries(document: str, text: str) -> set[tuple[str, ...]]:
    """Attributes of the implementations in a document, or no attributes if the XML is not valid."""
    try:
        elements = ElementTree.fromstring(text).iter("implementation")
    except ElementTree.ParseError:
        return set()
    found = set()
    for each in elements:
        path = os.path.normpath(Path(document).parent / each.get("file", ""))
        rest = (each.get(name, "") for name in ("function", "name", "sourcecode"))
        found.add((each.get("nodedef", ""), each.get("target", ""), path, *rest))
    return found


# --- tests that judge a reference -----------------------------------------------------------------

MODEL_TESTS = "tests/models"
OPTIONS = ("-x", "-q", "--tb=line", "-rfE", "-p", "no:cacheprovider", "--no-header")
FAILED = re.compile(r"^(?:FAILED|ERROR) \S*?(\w+\.py)(?:::(\w+))?.*?(?: - (.*))?$", re.MULTILINE)
WIDTH = {"COLUMNS": "200"}  # pytest truncates messages at this width
BLENDER = {"MXEON_CYCLES_PYTHON": f"{ROOT}/.venv-cycles/bin/python"}
GOOD, NO_TEST = 0, 5  # exit statuses of pytest


def by_tests(mutant: Mutant, steps: Sequence[tuple[str, ...]]) -> dict[str, Any]:
    """Verdict of tests on a mutated copy of mxeon and eonlib, and the first failed test."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        write_wrong(mutant, base, "python", *FOLDERS)
        for tests in steps:
            if failure := _original_failure(str(ROOT / "python"), tests):
                raise RuntimeError(f"a test fails without any change: {failure}")
            if failure := _failure(str(Path(base, "python")), tests):
                return killed(TESTS, [failure[0]], failure[1])
    return {"verdict": SURVIVED}


def _failure(package: str, tests: Sequence[str]) -> tuple[str, str] | None:
    """Name and message of the first test that fails with `package` in PYTHONPATH, or None."""
    command = [sys.executable, "-m", "pytest", *OPTIONS, *tests]
    env = BLENDER | os.environ | WIDTH | {"PYTHONPATH": package}
    ended = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, check=False)
    if ended.returncode == GOOD:
        return None
    match = FAILED.search(ended.stdout)
    if ended.returncode == NO_TEST or match is None:
        raise RuntimeError(f"no test ran: {ended.stdout[-400:]}{ended.stderr[-400:]}")
    file, test, message = match.groups()
    return test or "import", f"{file}: {message}" if message else file


_original_failure = cache(_failure)  # results of unchanged code stay the same
