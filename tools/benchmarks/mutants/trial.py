# SPDX-License-Identifier: Apache-2.0
"""The trial of a mutant: `mxeon check` on a copy of eonlib with the mutant, cheapest tasks first.

A wrong node of pbrlib is judged by the checks of the nodes that it changes, other sources by the checks
of a library, text first, and a wrong reference by the tests of the models on a copy of mxeon.
"""

import os
import re
import shutil
import subprocess
import sys
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
CRASHED = "crashed"  # traceback instead of a verdict
TEXT, TESTS = "text", "tests"  # replace the name of a host

# Cycles cannot show these exactly or at all; tests run them in Blender's OSL.
PROFILE, PROFILE_TESTS = "genosl/cycles/", ("tests/hosts/test_osl.py",)
PATH, PATH_TESTS = "genglsl/path/", ("tests/shaders/test_path_tracing.py",)  # run by no check
LOBE = "genglsl/lib/microfacet_lobe.glsl"  # calls environment lookups that no source includes
ENVIRONMENT_TESTS = (
    "tests/conformance/test_conformance.py::test_other_lobes_are_lit_alike_by_eonlib_s_lookups",
    "tests/hosts/test_document_hosts.py::"
    "test_microfacets_in_the_dome_of_storm_are_as_bright_as_their_albedo",
)
NOISY = ("environment", "furnace")  # checks that take Cycles longest
# Files that no shader for gl contains: the gl host cannot detect mutants in them.
ON_CYCLES = ("genosl/",)
CLOSURES = "libraries/diffuse/eonlib_genosl"  # calls of closures, which host osl evaluates
NOT_ON_GL = (*ON_CYCLES, CLOSURES, "libraries/diffuse/eonlib_genmdl")
TEXT_FIRST = ("libraries/diffuse/eonlib_defs.mtlx",)  # its mistakes also fail other checks


def trial(mutant: Mutant, judge: Judge, every: bool = False) -> dict[str, Any]:
    """Verdict on a mutant, and the failures that it caused on the first host that saw any."""
    if mutant.tests:
        named = tuple(f"{MODEL_TESTS}/{name}" for name in mutant.tests)
        return by_tests(mutant, (named,) if mutant.equivalent else (named, (MODEL_TESTS,)))
    if mutant.file.startswith(PATH):
        return by_tests(mutant, (PATH_TESTS,))
    found = _on_hosts(mutant, judge, every)
    if found["verdict"] == SURVIVED and mutant.file.startswith(PROFILE):
        return by_tests(mutant, (PROFILE_TESTS,))
    if found["verdict"] == SURVIVED and mutant.file.startswith(operators.ENVIRONMENT):
        return by_tests(mutant, (ENVIRONMENT_TESTS,))
    return found


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


def write_wrong(mutant: Mutant, base: str, *folders: str) -> None:
    """Copy folders of the repository, with the mutant's files."""
    for name in folders:
        shutil.copytree(ROOT / name, Path(base, name))
    for file, text in mutant.texts().items():
        Path(base, file).write_text(text, encoding="utf-8")


@contextmanager
def wrong_library(mutant: Mutant) -> Iterator[str]:
    """Path of eonlib with one change, in a folder that no cache contains."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        write_wrong(mutant, base, *FOLDERS)
        try:
            yield str(Path(base, "libraries"))
        finally:
            library.read_library.cache_clear()
            generators._library_generator.cache_clear()


def failures_of(
    tasks: Sequence[Task], judge: Judge, every: bool = True, clean: str = "eonlib"
) -> list[Result]:
    """Results that only pass without the mutant; stops after the first task that has some unless `every`."""
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
    """Failures as plain data: compiler errors first, then by descending error over tolerance."""

    def ratio(result: Result) -> float:
        if result.error is None:
            return float("inf")
        return result.error / max(result.tolerance or 0.0, 1e-9)

    return [
        {
            "check": each.check,
            "subject": Path(each.subject).name if each.subject.startswith("/") else each.subject,
            "host": each.host,
            "excess": words.excess(each),
            "diagnosis": first_line(words.diagnosis(each.diagnosis) or f"not run: {each.reason}"),
        }
        for each in sorted(failures, key=ratio, reverse=True)
    ]


def first_line(text: str) -> str:
    """The first line of a text; compilers print many."""
    return text.strip().splitlines()[0] if text.strip() else ""


# --- tasks of a library ---------------------------------------------------------------------------


def tasks_on_gl(path: str) -> list[Task]:
    """Tasks of `mxeon check --library` that judge something, on the first host."""
    return [task for task in make_plan((), ["gl"], [path]).tasks]


def stages(mutant: Mutant, path: str) -> Iterator[tuple[str, list[Task]]]:
    """Hosts and tasks that can see a mutant, the cheapest first.

    The text and the nodes come first, then surface shaders, then pictures of documents one by one; then
    the closures of OSL; then Cycles, one by one.
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
# Targets, and hosts that run their text, cheap hosts first.
HOSTS = (("genglsl", "gl"), ("genosl", "osl"), ("genosl", "cycles"))
# Checks that take longest.
LATE = ("inputs", "transmitted_inputs", "integral", "energy")


def changed_nodes(mutant: Mutant) -> set[tuple[str, str]]:
    """Target and title of each subject whose implementation a mutant changes."""
    texts = mutant.texts()
    changed = {LOBE if each.startswith(operators.ENVIRONMENT) else each for each in texts}
    entries: set[tuple[str, ...]] = set()
    for document in DOCUMENTS:
        before = _entries(document, (ROOT / document).read_text(encoding="utf-8"))
        after = _entries(document, texts[document]) if document in texts else before
        entries |= before ^ after
        if mutant.control and document in texts:
            entries |= before
        entries |= {entry for entry in before if not changed.isdisjoint(_sources(entry[2]))}
    return {(target, title) for nodedef, target, *_ in entries for title in _titles(nodedef)}


def node_tasks(mutant: Mutant, path: str) -> Iterator[tuple[str, list[Task]]]:
    """Hosts and tasks that judge the subjects that a mutant changes, cheap hosts first."""
    changed = changed_nodes(mutant)
    for target, host in HOSTS:
        titles = {title for each, title in changed if each == target}
        tasks = [task for task in _tasks(host) if task.subject in titles and task.host == host]
        yield host, [replace(task, library=path) for task in tasks]


@cache
def _tasks(host: str) -> tuple[Task, ...]:
    """All tasks of a host with eonlib: subject by subject, since each has a shader to compile.

    The last subjects come first (transmission, which uses most of a source); films come last, because their
    failures take longest to diagnose.
    """
    places = {spec.title: -place for place, spec in enumerate(PBRLIB)}
    tasks = make_plan((), [host], ["eonlib"], nodes=["all"]).tasks
    late = {task: (task.check in LATE, "film" in task.subject) for task in tasks}
    return tuple(sorted(tasks, key=lambda task: (late[task], places.get(task.subject, 0))))


@cache
def _titles(nodedef: str) -> frozenset[str]:
    """Subjects that are nodes of a definition: of its category, and of its type."""
    definition = library.load_library("eonlib").getNodeDef(nodedef)
    if not definition:
        return frozenset()
    kind, node = definition.getType(), definition.getNodeString()
    return frozenset(
        spec.title
        for spec in PBRLIB
        if (
            spec.node == node
            and all((word == kind) == (word in spec.title.upper()) for word in ("EDF", "VDF"))
        )
        or (kind == "BSDF" and spec in COMBINED_SPECS and f"<{node} " in spec.document())
    )


@cache
def _sources(file: str) -> frozenset[str]:
    """Paths of a source and of all that it includes, from the root."""
    path = ROOT / file
    if not path.is_file():
        return frozenset()
    included = INCLUDE.findall(path.read_text(encoding="utf-8"))
    folder = Path(file).parent
    return frozenset(
        {file}.union(*(_sources(os.path.normpath(folder / each)) for each in included))
    )


def _entries(document: str, text: str) -> set[tuple[str, ...]]:
    """Definition, target, file, function, name and text of implementations; none where unreadable."""
    try:
        elements = ElementTree.fromstring(text).iter("implementation")
    except ElementTree.ParseError:
        return set()
    return {
        (
            each.get("nodedef", ""),
            each.get("target", ""),
            os.path.normpath(Path(document).parent / each.get("file", "")),
            each.get("function", ""),
            each.get("name", ""),
            each.get("sourcecode", ""),
        )
        for each in elements
    }


# --- tests that judge a reference -----------------------------------------------------------------

MODEL_TESTS = "tests/models"
OPTIONS = ("-x", "-q", "--tb=line", "-rfE", "-p", "no:cacheprovider", "--no-header")
FAILED = re.compile(r"^(?:FAILED|ERROR) \S*?(\w+\.py)(?:::(\w+))?.*?(?: - (.*))?$", re.MULTILINE)
WIDTH = {"COLUMNS": "200"}  # otherwise pytest truncates messages
BLENDER = {"MXEON_CYCLES_PYTHON": f"{ROOT}/.venv-cycles/bin/python"}  # a copy has no environment
GOOD, NO_TEST = 0, 5  # exit statuses of pytest


def by_tests(mutant: Mutant, steps: Sequence[tuple[str, ...]]) -> dict[str, Any]:
    """Verdict of tests on a copy of mxeon and of eonlib, and the first that fails."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        write_wrong(mutant, base, "python", *FOLDERS)
        for tests in steps:
            if failure := _first_failure(str(ROOT / "python"), tests):
                raise RuntimeError(f"a test fails without any change: {failure}")
            if failure := _failure(str(Path(base, "python")), tests):
                return {"verdict": KILLED, "host": TESTS, "failures": [failure]}
    return {"verdict": SURVIVED}


def _failure(package: str, tests: Sequence[str]) -> dict[str, str] | None:
    """The first of some tests that fails with the package of a folder, or None."""
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *OPTIONS, *tests],
        cwd=ROOT,
        env=BLENDER | os.environ | WIDTH | {"PYTHONPATH": package},
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode == GOOD:
        return None
    match = FAILED.search(ended.stdout)
    if ended.returncode == NO_TEST or match is None:
        raise RuntimeError(f"no test ran: {ended.stdout[-400:]}{ended.stderr[-400:]}")
    file, test, message = match.groups()
    diagnosis = f"{file}: {message}" if message else file
    return {"check": test or "import", "excess": "", "host": TESTS, "diagnosis": diagnosis}


_first_failure = cache(_failure)  # cached for the unchanged package
