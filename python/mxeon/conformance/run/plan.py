# SPDX-License-Identifier: Apache-2.0
"""The plan of a run, which consists of tasks, and the findings of tasks.

A task checks one subject on one host with one library. Plans and findings are plain data, so that
processes can exchange them.
"""

from __future__ import annotations

import os
import platform
import sysconfig
from collections.abc import Container, Generator, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import chain, product
from pathlib import Path
from typing import NamedTuple

import MaterialX as mx
import moderngl
import numpy as np
import OpenImageIO as oiio

import mxeon
from mxeon.conformance import backends, checks
from mxeon.conformance import shader_functions as functions
from mxeon.conformance.diagnosis.regions import unreached
from mxeon.conformance.release import RELEASE
from mxeon.conformance.results import (
    SHADER_FUNCTIONS,
    SOURCE,
    Picture,
    Refused,
    Region,
    Result,
    Scope,
)
from mxeon.conformance.results.known_issues import RENDERER_NODES
from mxeon.conformance.spec import Spec
from mxeon.conformance.specs import ALL as ALL_SPECS
from mxeon.conformance.specs import COMMON as COMMON_SPECS
from mxeon.conformance.specs import PBRLIB, diffuse, emission, microfacets, surface_texts
from mxeon.errors import DocumentError, InputError, MxeonError, assert_known
from mxeon.hosts import HOSTS, base, host_names, host_row
from mxeon.jobs import pool
from mxeon.shaders.contents import ShownNode, document_nodes, node_of
from mxeon.shaders.document.drawn_values import LIT
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.document.references import digests
from mxeon.shaders.functions import has_functions
from mxeon.shaders.library import (
    check_version,
    examples_folder,
    has_profile,
    kind_of,
    library_name,
    load_library,
)
from mxeon.shaders.library_tree import LIBRARIES, OVERLAY, origins
from mxeon.shaders.methods import GENERATED, UNCHOSEN, UNTABLED, Methods
from mxeon.shaders.released_graphs import hidden

Source = tuple[str, str]  # a document, and the library that reads the document


class Reading(NamedTuple):
    """Contents of documents, with the same fields as `mxeon.conformance.results.Scope`."""

    contents: dict[str, tuple[str, ...]]
    unreached: dict[str, dict[str, tuple[Region, ...]]]
    refused: tuple[Refused, ...]


def read_documents(
    files: Sequence[str], libraries: Sequence[str], policy: Policy, workers: int, timeout: float
) -> Reading:
    """Read documents with each library, in worker processes unless `workers` is 0.

    A document that crashes a worker counts as empty. The task that draws the document reports the
    crash. Raise MxeonError if a library cannot be used.
    """
    sources = [(file, library) for file in dict.fromkeys(files) for library in libraries]
    titles: dict[str, dict[str, set[Region]]] = {file: {} for file in files}
    faults: dict[Source, tuple[str, ...]] = {}
    with closing(_nodes(sources, policy, workers, timeout)) as answers:
        for (file, library), nodes in zip(sources, answers, strict=True):
            if isinstance(nodes, DocumentError):
                # If a bundled example cannot be read, the library is at fault, and the example is
                # not refused.
                if not Path(file).resolve().is_relative_to(examples_folder()):
                    faults[file, library] = nodes.args
            elif isinstance(nodes, MxeonError):
                raise nodes
            else:
                for (spec, mode), node in product(_modes(), nodes or ()):
                    has_bsdf = "bsdf" in dict(node.inputs)
                    if isinstance(spec, emission.EmittingSurface) and spec.has_bsdf != has_bsdf:
                        continue
                    if node.has(mode) and (node.film or not isinstance(spec, microfacets.FilmSpec)):
                        regions = set(unreached(dict(node.values)))
                        titles[file].setdefault(spec.title, regions).intersection_update(regions)
    refused: list[Refused] = []
    for file in dict.fromkeys(file for file, _ in faults):
        lines_by_library = {name: lines for (each, name), lines in faults.items() if each == file}
        if lines_by_library.keys() >= set(libraries):
            every_line = dict.fromkeys(chain.from_iterable(lines_by_library.values()))
            refused.append(Refused(file, tuple(every_line)))
        else:  # another library can read the file
            refused += [
                Refused(file, tuple(f"{line} (with {library})" for line in lines), library)
                for library, lines in lines_by_library.items()
            ]
    unreached_by_file = {
        file: {title: tuple(sorted(each, key=repr)) for title, each in found.items() if each}
        for file, found in titles.items()
    }
    contents = {file: tuple(each) for file, each in titles.items()}
    return Reading(contents, unreached_by_file, tuple(refused))


def _nodes(
    sources: Sequence[Source], policy: Policy, workers: int, timeout: float
) -> Generator[tuple[ShownNode, ...] | MxeonError | None, None, None]:
    """The nodes of each document, or an error, or None if the document crashed the process.

    The processes continue to read until the generator is closed.
    """
    work = partial(document_nodes, policy)
    if not workers:
        yield from map(work, sources)
    elif sources:
        for outcome in pool.in_order(pool.run(work, sources, workers, timeout)):
            yield outcome.value


@cache
def _modes() -> tuple[tuple[Spec, ShownNode], ...]:
    """Each spec and its node, in the judged mode, without specs that only users can request."""
    specs = (spec for spec in ALL_SPECS if spec not in surface_texts.SENTENCES)
    return tuple((spec, node_of(spec.document(), spec.node)) for spec in specs)


# --- the tasks of a run ---------------------------------------------------------------------------

HOST = "host"
PICTURE, STUDIO = "picture", "studio"
STUDIED = 4  # maximum number of documents with studio pictures in a report
FUNCTIONS, DOCUMENT = "twins", "document"
EVERY_NODE = "every node"


@dataclass(frozen=True)
class Task:
    """An independent part of a run: one check of one subject on one host with one library."""

    # Key of a row of `mxeon.conformance.checks`, or HOST, SOURCE, PICTURE, STUDIO, FUNCTIONS,
    # RELEASE or DOCUMENT.
    check: str
    # Title of a node, path of a document, SHADER_FUNCTIONS, EVERY_NODE, or names of nodes
    subject: str
    host: str
    library: str
    seed: int = 1
    methods: Methods = UNCHOSEN  # lighting methods that the client chose

    def __str__(self) -> str:
        return f"{self.host}, {self.check}, {self.subject}, {self.library}"


@dataclass(frozen=True)
class Plan(Scope):
    """All tasks of a run and all data that findings depend on. Equal plans have equal findings."""

    tasks: tuple[Task, ...]
    # Options of `mxeon check` that set the policy, the seed and the lighting methods.
    options: dict[str, str] = field(default_factory=dict)
    # SHA-256 of each file that the findings depend on, or "" for a file that cannot be read. Plans
    # of runs without a journal contain no files.
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Findings:
    """The outcome of a task; see Run for the meaning of the fields."""

    results: tuple[Result, ...] = ()
    pictures: tuple[Picture, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()
    errors: tuple[str, ...] = ()
    hosts: tuple[base.Identity, ...] = ()
    unjudged: tuple[tuple[str, str], ...] = ()

    def belong_to(self, task: Task) -> bool:
        """Whether the findings are not empty and have the same host and library as a task."""
        records: list[Result | Picture] = [*self.results, *self.pictures]
        location = (task.host, task.library)
        return bool(records or self.errors or self.unjudged or task.check == STUDIO) and all(
            (record.host, record.library) == location for record in records
        )


ALL, COMMON = "all", "common"  # names of groups of nodes


def assert_known_names(hosts: Iterable[str], nodes: Iterable[str]) -> None:
    """Raise InputError for an unknown host or node, and ImportError if MaterialX is too old."""
    check_version()
    for name in hosts:
        assert_known("host", name, host_names())
    for name in nodes:
        assert_known("node", name, (*node_names(), COMMON, ALL), "mxeon check --node list")


def node_names() -> tuple[str, ...]:
    return tuple(dict.fromkeys(spec.node for spec in ALL_SPECS))


def _titles(nodes: Container[str]) -> set[str]:
    return {spec.title for spec in ALL_SPECS if spec.node in nodes}


def _selected(
    tasks: Sequence[Task], files: Sequence[str], nodes: Sequence[str], reading: Reading
) -> list[Task]:
    """The requested tasks, beginning with the tasks for the user's documents.

    Raise InputError if no task judges any of the nodes.
    """
    texts = {spec.title for spec in surface_texts.SENTENCES}
    uncommon = {spec.title for spec in PBRLIB} - {spec.title for spec in COMMON_SPECS} | texts
    audit = COMMON in nodes or not (nodes or files)
    by_name = {check.key for check in checks.CHECKS if check.profile}
    if nodes:
        titles = _titles(nodes)
    else:
        titles = {title for file in files for title in reading.contents.get(file, ())}
    selected = [
        task
        for task in tasks
        if (ALL in nodes and task.subject not in texts)
        or task.subject in files
        or (task.subject in titles and (nodes or task.check not in by_name))
        or (audit and task.subject not in uncommon and task.check not in by_name)
        # The graphs of a folder may differ from the release without an effect in pictures, because
        # the reference pictures are also computed with the folder's graphs.
        or (task.check == RELEASE and files and not nodes and os.path.isabs(task.library))
    ]
    if selected or not nodes:
        return sorted(selected, key=lambda task: task.subject not in files)
    hosts = ", ".join(dict.fromkeys(task.host for task in tasks if task.host != SOURCE))
    message = f"node must be judged on one of the hosts {hosts}; got {', '.join(nodes)}"
    places = []
    for library in LIBRARIES:
        if judging := [
            row.name
            for row in HOSTS
            if any(task.subject in titles for task in _on_host(row.name, library, ()))
        ]:
            places.append(f"with --library {library} on {', '.join(judging)}")
    raise InputError(f"{message}, judged {'; '.join(places)}" if places else message)


def make_plan(
    files: Sequence[str | os.PathLike[str]],
    hosts: Sequence[str],
    libraries: Sequence[str],
    policy: Policy = DEFAULT,
    resumable: bool = False,
    nodes: Sequence[str] = (),
    reading: Reading | None = None,
    compared: Sequence[str] = (),
    seed: int = 1,
    methods: Methods = UNCHOSEN,
) -> Plan:
    """The tasks of a run, grouped by host and library.

    If `resumable`, the plan lists the files that the run depends on. `nodes` has categories, ALL or
    COMMON. If `nodes` is empty, the nodes of `files` are judged, or the common nodes if there are
    no files. Failures of libraries in `compared` do not change the verdict.

    Raises InputError if a name is unknown or if no host judges the nodes, and ImportError if this
    MaterialX is too old.
    """
    assert_known_names(hosts, nodes)
    reading = reading or Reading({}, {}, ())
    libraries = tuple(dict.fromkeys(map(library_name, libraries)))
    hosts = tuple(dict.fromkeys(hosts))
    tasks: list[Task] = []
    documents: list[str] = []
    # If there are documents or several libraries, every library is judged on all nodes.
    everywhere = bool(files and not nodes) or len(libraries) > 1
    for library in libraries:
        # A file is refused if the file cannot be read with this library.
        names = map(str, files)
        readable = [
            name
            for name in names
            if not any(each.concerns(name, library) for each in reading.refused)
        ]
        paths = list(map(Path, readable)) if files else _examples(library)
        documents += map(str, paths)
        tasks.append(Task(SOURCE, EVERY_NODE, SOURCE, library))
        for host in hosts:
            if not host_row(host).scenes:
                tasks += [Task(DOCUMENT, file, host, library) for file in readable]
            tasks += _on_host(host, library, paths, everywhere, methods.over(GENERATED))
            if resumable and host == "gl":  # reports show studio pictures
                tasks += [Task(STUDIO, file, host, library) for file in readable[:STUDIED]]
    for host in hosts:  # renderers' own nodes and materials need no library
        for spec in backends.own_nodes(host):
            tasks += _checks_of(spec, host, RENDERER_NODES)
        if files and host_row(host).scenes and not host_row(host).target:
            tasks += [Task(PICTURE, file, host, RENDERER_NODES) for file in readable]
    comparisons = [each for each in tasks if each.check == RELEASE and os.path.isabs(each.library)]
    tasks = _selected(tasks, list(map(str, files)), nodes, reading)
    # Report hosts that measure nothing. Renderers that read no documents are left out, because
    # DOCUMENT tasks report such renderers.
    measuring = {
        task.host for task in tasks if task.check != DOCUMENT or not host_row(task.host).target
    }
    idle = [host for host in hosts if tasks and host not in measuring]
    tasks += [Task(HOST, EVERY_NODE, host, libraries[0]) for host in idle]
    # Unless all hosts are idle, report requested nodes that no host judges.
    if len(idle) < len(hosts):
        subjects = {task.subject for task in tasks}
        named = (each for each in nodes if each not in (ALL, COMMON))
        unmeasured = [each for each in named if subjects.isdisjoint(_titles([each]))]
        tasks += [Task(HOST, node, hosts[0], libraries[0]) for node in unmeasured]
    if not files and nodes and {ALL, COMMON}.isdisjoint(nodes):
        documents = []
    # Definitions and graphs of the requested nodes in a folder may differ from the release.
    own = sorted({each.getNodeString() for each in load_library("stock").getNodeDefs()} & {*nodes})
    if own and not any(task.check == RELEASE for task in tasks):
        compared_there = (each for each in comparisons if each.host in measuring)
        tasks += [replace(each, subject=",".join(own)) for each in compared_there]
    audited = any(task.check == SOURCE for task in tasks)
    defining = (*libraries, *policy.definitions)
    return Plan(
        version=mxeon.__version__,
        software=_software(),
        tasks=tuple(replace(task, seed=seed, methods=methods) for task in tasks),
        documents=tuple(map(Path, dict.fromkeys(documents))),
        contents={file: reading.contents.get(file, ()) for file in documents} if files else {},
        unreached=reading.unreached if files and not nodes else {},
        refused=reading.refused,
        libraries={each: origins(each) for each in libraries if each not in LIBRARIES},
        compared=tuple(compared),
        unjudged=(
            *((*UNJUDGED, *_untabled(hosts)) if audited else ()),
            *chain.from_iterable(map(unjudged, libraries)),
        ),
        options=policy.options | {"--seed": str(seed)} | methods.options,
        files=digests(dict.fromkeys(documents), policy, defining) if resumable else {},
    )


# Subjects that no check judges with any library, and the reasons.
UNJUDGED = (
    ("displacement, volume shaders and backsurfaceshader", "no host draws them"),
    ("u_envRadianceMips above 1, shadow maps of varying depth", "no host has them"),
    ("patterns and images of stdlib", "they are only compared with the installed MaterialX"),
)


def _untabled(hosts: Iterable[str]) -> Iterator[tuple[str, str]]:
    for host in hosts:
        if host_row(host).target in UNTABLED:
            _, reason, page = UNTABLED[host_row(host).target]
            text = f"MaterialX's shader {reason}; see docs/upstream/{page}.md"
            yield f"albedo tables on {host}", text


def unjudged(library: str) -> tuple[tuple[str, str], ...]:
    """Nodes without a model that a library adds and that scatter or emit light."""
    own, stock = (load_library(each).getNodeDefs() for each in (library, "stock"))
    names = {each.getNodeString() for each in own if each.getType() in LIT}
    names -= {*node_names(), *(each.getNodeString() for each in stock)}
    return tuple((name, f"{library} adds this node, which has no model") for name in sorted(names))


def diffuse_specs(library: str) -> list[diffuse.DiffuseSpec]:
    data = load_library(library)
    return [spec for spec in diffuse.DIFFUSE if data.getMatchingNodeDefs(spec.node)]


def _on_host(
    host: str,
    library: str,
    files: Iterable[Path],
    everywhere: bool = False,
    methods: Methods = GENERATED,
) -> Iterator[Task]:
    """Tasks of a host with a library: checks of nodes, checks of functions, pictures of files."""
    ways, row = backends.ways_of(host), host_row(host)
    if not ways:
        yield Task(HOST, EVERY_NODE, host, library)
    if not ways or not row.target:
        return
    kind, is_release = kind_of(library), library == "stock" and hidden() is None
    if row.way == "pairs" and not is_release:
        yield Task(RELEASE, EVERY_NODE, host, library)
    language = "osl" if row.target == "osl" else "glsl"
    if row.way in functions.KINDS and has_functions(library, language):
        yield Task(FUNCTIONS, SHADER_FUNCTIONS, host, library)
    for spec in diffuse_specs(library):
        yield from _checks_of(spec, host, library, methods)
    # Pictures of a renderer's own closures are judged only with the library "stock".
    no_closures = row.way == "pictures" and row.target == "osl" and kind in ("eonlib", "diffuse")
    defines = load_library(library).getMatchingNodeDefs
    for each in (*PBRLIB, *surface_texts.SENTENCES):
        missing = each.libraries and not defines(each.node)  # MaterialX lacks eonlib's nodes
        # If there are no documents, judge a bundled library only on nodes that the library repairs.
        judged = everywhere or kind in (OVERLAY, *(each.libraries or LIBRARIES))
        if judged and not missing and not (each.closure and no_closures):
            yield from _checks_of(each, host, library, methods)
    if row.surfaces:
        for lobe in diffuse.SURFACE_LOBES:
            judging = lobe.libraries or LIBRARIES
            if everywhere or ("eonlib" if kind == OVERLAY else kind) in judging:
                yield from _checks_of(lobe, host, library, methods)
    if row.scenes:
        yield from (Task(PICTURE, str(file), host, library) for file in files)


def _checks_of(spec: Spec, host: str, library: str, methods: Methods = GENERATED) -> Iterator[Task]:
    if backend := backends.backend_of(host, spec):
        for check in checks.CHECKS:
            has_text = not check.profile or has_profile(library, check.profile)
            if has_text and check.applies_to(spec, backend, host, methods):
                yield Task(check.key, spec.title, host, library)


def _software() -> dict[str, str]:
    """Versions of packages, read from modules because a build from source has no metadata."""
    folder = str(Path(mx.__file__).parents[1])
    installed = folder in sysconfig.get_paths().values()
    return {
        "Python": platform.python_version(),
        "MaterialX": mx.getVersionString(),
        **({} if installed else {"MaterialX folder": folder}),
        "numpy": np.__version__,
        "OpenImageIO": oiio.__version__,
        "moderngl": moderngl.__version__,  # type: ignore[attr-defined]
    }


def _examples(library: str) -> list[Path]:
    """The bundled documents, except documents with a node that the library lacks."""
    files = sorted(examples_folder().glob("*.mtlx"))
    missing = [spec.node for spec in diffuse.DIFFUSE if spec not in diffuse_specs(library)]
    return [file for file in files if not any(node in file.read_text("utf-8") for node in missing)]
