# SPDX-License-Identifier: Apache-2.0
"""The nodes of pbrlib that a mutant changes, and the tasks that judge them alone."""

import os
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from mxeon.conformance.run.plan import Task, make_plan
from mxeon.conformance.specs import PBRLIB
from mxeon.conformance.specs.combinations import COMBINED_SPECS
from mxeon.shaders.library import load_library
from tools.benchmarks.mutants.mutant import ROOT, Mutant

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
TITLES = tuple(spec.title for spec in PBRLIB)


def changed_nodes(mutant: Mutant) -> set[tuple[str, str]]:
    """Target and title of each subject whose implementation a mutant changes."""
    texts = mutant.texts()
    entries: set[tuple[str, ...]] = set()
    for document in DOCUMENTS:
        before = _entries(document, (ROOT / document).read_text(encoding="utf-8"))
        after = _entries(document, texts[document]) if document in texts else before
        entries |= before ^ after
        if mutant.control and document in texts:
            entries |= before
        entries |= {entry for entry in before if not texts.keys().isdisjoint(_sources(entry[2]))}
    return {(target, title) for nodedef, target, *_ in entries for title in _titles(nodedef)}


def node_tasks(mutant: Mutant, path: str) -> Iterator[tuple[str, list[Task]]]:
    """Hosts and tasks that judge the subjects that a mutant changes, cheap hosts first."""
    changed = changed_nodes(mutant)
    for target, host in HOSTS:
        titles = {title for each, title in changed if each == target}
        yield (
            host,
            [
                replace(task, library=path)
                for task in _tasks(host)
                if task.subject in titles and task.host == host
            ],
        )


@cache
def _tasks(host: str) -> tuple[Task, ...]:
    """All tasks of a host with eonlib: subject by subject, since each has a shader to compile.

    The last subjects come first, those of transmission, which need most of a source; films, whose failures take
    longest to diagnose, come last.
    """
    places = {title: -place for place, title in enumerate(TITLES)}
    tasks = make_plan((), [host], ["eonlib"], nodes=["all"]).tasks
    late = {task: (task.check in LATE, "film" in task.subject) for task in tasks}
    return tuple(sorted(tasks, key=lambda task: (late[task], places.get(task.subject, 0))))


@cache
def _titles(nodedef: str) -> frozenset[str]:
    """Subjects that are nodes of a definition: of its category, and of its type."""
    definition = load_library("eonlib").getNodeDef(nodedef)
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
