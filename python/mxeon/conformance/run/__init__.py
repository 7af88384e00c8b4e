# SPDX-License-Identifier: Apache-2.0
"""A conformance run. Tasks are planned, executed in processes, and recorded in a journal."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import fields, replace
from functools import lru_cache, partial
from itertools import chain, product
from pathlib import Path

from mxeon.conformance.results import NOT_RUN, REPORT, SOURCE, Refused, Run, Scope
from mxeon.conformance.run import plan
from mxeon.conformance.run.journal import Journal, read_journal, refusal
from mxeon.conformance.run.judge import Judge, one_result
from mxeon.conformance.run.plan import Findings, Plan, Task, assert_known_names, make_plan
from mxeon.errors import InputError, InterfaceError, NotRun
from mxeon.hosts import HOSTS, Row, host_names, host_row, register, registered
from mxeon.io.files import AnyPath, Names, check_output, names_of, one_name
from mxeon.jobs import TIMEOUT, WAIT, check_timeout, dask, pool
from mxeon.shaders import generation, library_tree
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.document.references import documents_in, files_read
from mxeon.shaders.library import examples_folder, library_name, untested
from mxeon.shaders.methods import UNCHOSEN, Methods
from mxeon.shaders.targets import CLASSES

__all__ = ["check", "read_run", "to_run", "work"]

# Hosts that stay open when the library changes.
EVALUATING = {row.name for row in HOSTS if row.way == "pairs"}

Outcomes = Iterable[tuple[int, Findings]]
Executor = Callable[[Sequence[Task]], Iterable[tuple[int, pool.Outcome]]]


def check(
    files: Names | None = None,
    hosts: Names = "gl",
    libraries: Names = "eonlib",
    *,
    workers: int = 0,
    timeout: float = TIMEOUT,
    folder: AnyPath | None = None,
    resume: bool = False,
    scheduler: str | None = None,
    wait: float = WAIT,
    policy: Policy | None = None,
    nodes: Names | None = None,
    progress: Callable[[Outcomes, int], Outcomes] | None = None,
    refuse: Callable[[str], None] | None = None,
    compared: Names = (),
    seed: int = 1,
    methods: Methods | None = None,
) -> Run:
    """Run every check on every host, and compare pictures of documents with the reference.

    Parameters of type `Names` take one or more names or paths.

    - `files`: MaterialX documents, and folders with documents. If None, the library's common nodes
      and the bundled examples are judged.
    - `hosts`: Hosts to judge, or "all"; `mxeon.hosts.host_names` lists them.
    - `libraries`: "eonlib", "stock" for unmodified MaterialX, and folders of MaterialX documents.
    - `workers`: Number of worker processes, which may crash or hang without ending the run. If 0,
      this process does the work.
    - `timeout`: Maximum seconds per task in a worker.
    - `folder`: Folder of the journal, from which an interrupted run can be resumed. If None, there
      is no journal. The folder must contain neither files that the run reads nor another
      interrupted run. Results of an earlier run are moved to the subfolder `previous_run`.
    - `resume`: Continue the run in `folder`.
    - `scheduler`, `wait`: Address of a Dask scheduler whose workers execute the tasks, and maximum
      seconds to wait for a compatible worker.
    - `policy`: Permissions and limits of documents, by default `Policy()`.
    - `nodes`: Categories of nodes to judge, or "all", or "common" for the nodes of an audit. If
      None, the nodes of `files` are judged, or the common nodes if there are no files.
    - `progress`: Function that is called as `progress(tasks, total)` and returns an iterator over
      `tasks` that shows the progress, such as `lambda tasks, total: tqdm(tasks, total=total)`.
    - `refuse`: Function that is called with each fault of each document that cannot be read, before
      any other work.
    - `compared`: Additional libraries for comparison, whose failures do not change the verdict. The
      command uses `compared="stock"` for documents.
    - `seed`: Seed of the samples, at least 0; verdicts should not depend on the seed.
    - `methods`: How generated shaders compute lighting, by default with each host's own methods.

    Documents that cannot be judged are refused, and the other documents are judged. A run that
    refuses a document has not passed; see `mxeon.Run`.

    Raises ValueError if a name or number is wrong, if the run to resume differs, or if no scheduler
    answers. Raises NotRun if no process can start, or if the cluster has no workers for too long.
    """
    begin = time.monotonic()
    policy = policy or DEFAULT
    folder = None if folder is None else one_name("folder", folder)
    given = () if files is None else names_of("files", files)
    engines = names_of("hosts", hosts)
    engines = host_names() if "all" in engines else engines
    categories = () if nodes is None else names_of("nodes", nodes)
    judged, others = names_of("libraries", libraries), names_of("compared", compared, least=0)
    if folder is not None:
        inputs = _inputs(given, (*judged, *others), policy)
        check_output(folder, inputs, replaced=REPORT, apart=True)
    with nullcontext() if folder is None else Journal(folder, resume) as journal:
        assert_known_names(engines, categories)
        documents = documents_in(given)
        judged, others = (tuple(map(library_name, each)) for each in (judged, others))
        if both := [each for each in others if each in judged]:
            raise InputError(f"compared must differ from the judged libraries; got {both[0]!r}")
        loaded = tuple(dict.fromkeys((*judged, *others)))
        for library in filter(library_tree.root, loaded):
            for target in {host_row(host).target for host in engines} & {*generation.TARGETS}:
                try:
                    generation.check_generator(library, target)
                except InterfaceError as reason:  # no task of the library can run
                    raise InputError(str(reason)) from None
        if workers < 0:
            raise InputError(f"workers must be at least 0; got {workers}")
        if seed < 0:
            raise InputError(f"seed must be at least 0; got {seed}")
        check_timeout(timeout)
        check_timeout(wait, "waitForWorkers")
        reading = plan.read_documents(documents, loaded, policy, workers, timeout)
        options = policy, folder is not None, categories, reading, others, seed, methods or UNCHOSEN
        planned = make_plan(documents, engines, loaded, *options)
        if refuse:
            for line in to_run(planned, {}).errors:
                refuse(line)
        with _executor(policy, workers, timeout, scheduler, wait) as executor:
            if journal:
                journal.begin(planned)
            done: dict[int, Findings] = journal.findings if journal else {}
            numbers = [n for n in range(len(planned.tasks)) if n not in done]
            tasks = [planned.tasks[number] for number in numbers]
            # Hosts on the machines of a cluster may differ from the hosts of the earlier run.
            earlier = {
                host.name: host
                for findings in ([] if scheduler else done.values())
                for host in findings.hosts
            }
            all_findings = (
                (position, outcome.value or one_result(tasks[position], NOT_RUN, outcome.failure))
                for position, outcome in executor(tasks)
            )
            with closing(all_findings) as outcomes:  # workers run until the generator closes
                for position, findings in progress(outcomes, len(tasks)) if progress else outcomes:
                    if differences := [
                        f"host {old.name} ({old.version}, {old.device}, now {new.version}, "
                        f"{new.device})"
                        for new in findings.hosts
                        if (old := earlier.get(new.name, new)) != new
                    ]:
                        raise InputError(refusal(folder, differences))
                    if journal:
                        journal.add(numbers[position], findings)  # writes the pictures to disk
                    else:
                        done[numbers[position]] = findings
            seconds = round(time.monotonic() - begin, 3)
            # If there is no journal, a report has to draw the studio pictures.
            studio = None if journal else policy
            return replace(to_run(planned, done), seconds=seconds, policy=studio)


def with_studio(run: Run, policy: Policy) -> Run:
    """The run with studio pictures of documents, which `check` only draws if a folder is given."""
    libraries = dict.fromkeys(each.library for each in run.results if each.host == "gl")
    subjects = product(libraries, list(run.contents)[: plan.STUDIED])
    tasks = [Task(plan.STUDIO, file, "gl", library) for library, file in subjects]
    findings = (each.value for _, each in _run_inline(policy, tasks))
    pictures = chain.from_iterable(each.pictures for each in findings)
    return replace(run, policy=None, pictures=(*run.pictures, *pictures))


def _inputs(files: Sequence[AnyPath], libraries: Iterable[str], policy: Policy) -> Iterator[str]:
    """Every file that a run may read."""
    documents = [
        str(path)
        for file in files or [examples_folder()]
        for path in (sorted(Path(file).rglob("*.mtlx")) if os.path.isdir(file) else [file])
    ]
    yield from files_read(documents, policy, libraries).values()


def read_run(folder: AnyPath) -> Run:
    """The completed part of a run. Raise ValueError if `folder` has no journal of this version."""
    return to_run(*read_journal(folder))


def work(policy: Policy, rows: Sequence[Row], task: Task) -> Findings:
    """The findings of a task in a worker.

    The worker first registers the renderers in `rows`. Raise NotRun if the host cannot be opened.
    """
    register(*rows)
    return _judge(policy).work(task)


def work_or_not_run(work: Callable[[Task], Findings], task: Task) -> Findings:
    """The findings of a task, or a result "not run" if the host cannot be opened."""
    try:
        return work(task)
    except NotRun as reason:
        return one_result(task, NOT_RUN, reason=str(reason))


@lru_cache(maxsize=1)
def _judge(policy: Policy) -> Judge:
    return Judge(policy)


def to_run(planned: Plan, findings: Mapping[int, Findings]) -> Run:
    """The run that consists of a plan and of the findings of completed tasks."""
    done = [findings[number] for number in sorted(findings)]
    notes = [note for each in done for note in each.notes]
    refused = {(each.document, each.library): each.faults for each in planned.refused}
    for number in sorted(findings):
        if lines := findings[number].errors:
            file = planned.tasks[number].subject, ""
            refused[file] = tuple(dict.fromkeys((*refused.get(file, ()), *lines)))
    # If only a library for comparison cannot read a document, the document's faults become notes.
    for document, library in product(planned.contents, planned.compared):
        lines = refused.pop((document, library), ())
        notes += [(line, document) for line in lines]
    version = planned.software.get("MaterialX")
    if version and (warning := untested(version)):
        notes.append((warning, "every result"))
    places: dict[str, list[str]] = {}  # subjects of each note; [] if the note names the subject
    for text, place in dict.fromkeys(notes):
        places.setdefault(text, []).extend([] if place in text else [place])
    hosts = tuple(dict.fromkeys(host for each in done for host in each.hosts))
    audited = any(task.check == SOURCE for task in planned.tasks)
    own = planned.libraries.values() if hosts and not planned.contents else ()
    written = {part for files in own for file in files["folder"] for part in file.split("/")}
    unjudged = (
        *texts_not_run({host.name for host in hosts}, None if audited else written),
        *planned.unjudged,
        *(row for each in done for row in each.unjudged),
    )
    shared = {each.name: getattr(planned, each.name) for each in fields(Scope)}
    return Run(
        **shared
        | {
            "refused": tuple(Refused(name, lines, by) for (name, by), lines in refused.items()),
            "unjudged": tuple(dict.fromkeys(unjudged)),
        },
        hosts=hosts,
        results=tuple(result for each in done for result in each.results),
        pictures=tuple(picture for each in done for picture in each.pictures),
        notes=tuple(
            f"{text}: {', '.join(listed)}" if listed else text for text, listed in places.items()
        ),
        missing=tuple(str(task) for n, task in enumerate(planned.tasks) if n not in findings),
    )


def texts_not_run(
    hosts: Container[str], written: Container[str] | None = None
) -> Iterator[tuple[str, str]]:
    """Targets that none of the given hosts compiles, and the reasons.

    With `written`, only targets whose folder of sources is in `written`, such as "genosl", and is
    not the folder of a target that a host compiles.
    """
    targets = {row.target for row in HOSTS if row.name in hosts}
    folders = {CLASSES[target][0].lower() for target in targets}
    for row in HOSTS:
        folder = CLASSES[row.target][0].lower()
        named = written is None or (folder in written and folder not in folders)
        if row.target not in targets and named:
            targets.add(row.target)
            if written is not None:
                folders.add(folder)  # its first target stands for all
            yield row.target, f"needs {row.needs}" if row.needs else "no host for it ran"


@contextmanager
def _executor(
    policy: Policy, workers: int, timeout: float, scheduler: str | None, wait: float
) -> Iterator[Executor]:
    if scheduler is not None:
        with dask.connect(scheduler, wait) as remote:
            job = partial(work, policy, registered())
            yield partial(dask.run, job, workers=remote, timeout=timeout, unavailable=NotRun)
    elif workers:
        job = partial(work_or_not_run, partial(work, policy, registered()))
        yield partial(pool.run, job, workers=workers, timeout=timeout, group=_subject)
    else:
        yield partial(_run_inline, policy)


def _subject(task: Task) -> tuple[str, str, str]:
    """A key that is equal for tasks that should run in one worker.

    Tasks with equal keys share shaders, samples and diagnoses. Libraries share the expected values,
    but some hosts must be opened again for each library.
    """
    return task.host, "" if task.host in EVALUATING else task.library, task.subject


def _run_inline(policy: Policy, tasks: Sequence[Task]) -> Iterator[tuple[int, pool.Outcome]]:
    with closing(Judge(policy)) as judge:
        for position in pool.by_group(list(map(_subject, tasks))):
            yield position, pool.Outcome(work_or_not_run(judge.work, tasks[position]))
