# SPDX-License-Identifier: Apache-2.0
"""Executes the tasks of a run in sequence, on hosts that stay open between tasks."""

import os
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from mxeon.conformance import checks, pictures, reference, release, results, shader_functions, text
from mxeon.conformance.backends import backend_of, own_nodes
from mxeon.conformance.case import Case, make_case
from mxeon.conformance.results.known_issues import with_pages
from mxeon.conformance.run import plan
from mxeon.conformance.run.plan import DOCUMENT, FUNCTIONS, HOST, Findings, Task
from mxeon.conformance.samples import SEED
from mxeon.conformance.specs import ALL
from mxeon.errors import DocumentError, ImageError, InterfaceError, MxeonError, NotRun, ShaderError
from mxeon.hosts import base, open_engine
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.library import examples_folder
from mxeon.shaders.library_tree import root
from mxeon.shaders.methods import Methods

CLAIMS = {
    HOST: "The host runs on this machine.",
    results.SOURCE: "The generated source was checked.",
    DOCUMENT: pictures.DOCUMENT_CLAIM,
    FUNCTIONS: "The shader functions match NumPy's.",
    release.RELEASE: release.CLAIM,
    plan.PICTURE: pictures.MATCH,
}


def one_result(
    task: Task,
    verdict: results.Verdict,
    reason: str = "",
    diagnosis: results.Diagnosis = results.NO_DIAGNOSIS,
) -> Findings:
    """Findings with a single result, which has a reason or a diagnosis but no measurement."""
    if task.check == plan.STUDIO:  # a STUDIO task has no results
        return Findings(notes=((f"not drawn in the studio: {reason}", Path(task.subject).name),))
    if not (claim := CLAIMS.get(task.check)):
        own_nodes(task.host)  # imports a renderer's checks
        claim = next(each.claim for each in checks.CHECKS if each.key == task.check)
    place = (task.check, claim, task.subject, task.host, task.library)
    document = str(Path(task.subject)) if task.check in (DOCUMENT, plan.PICTURE) else ""
    result = results.Result(*place, verdict, reason=reason, document=document, diagnosis=diagnosis)
    return Findings((result,))


class Judge:
    def __init__(self, policy: Policy, opened: Callable[[str], base.Engine] = open_engine) -> None:
        self._policy, self._open = policy, opened
        self._hosts: dict[str, base.Engine | NotRun] = {}  # open hosts, or errors
        self._reference = reference.Reference()
        self._case = lru_cache(maxsize=1)(_case)  # caches one case, because pairs take much memory

    def work(self, task: Task) -> Findings:
        """The findings of a task, including the faults of a document that cannot be read.

        Raise NotRun if the host cannot be opened.
        """
        SEED.set(task.seed)
        begin = time.monotonic()
        try:
            findings = self._findings(task)
            # The folder whose `libraries` replace MaterialX's libraries, or "".
            materialx = root(task.library) if os.path.isabs(task.library) else ""
            share = round((time.monotonic() - begin) / max(1, len(findings.results)), 3)
            completed = (
                replace(with_pages(each, materialx), seconds=share) for each in findings.results
            )
            return replace(findings, results=tuple(completed))
        except InterfaceError as reason:
            return one_result(task, results.NOT_RUN, reason=str(reason))
        except DocumentError as reason:  # mxeon itself wrote the refused document
            refused = results.Cause(results.Kind.DEFECT, "own_document_refused", text=str(reason))
            return one_result(task, results.FAILED, diagnosis=results.Diagnosis((refused,)))

    def close(self) -> None:
        for host in self._hosts.values():
            if not isinstance(host, NotRun):
                host.close()

    def _host(self, name: str) -> base.Engine:
        if name not in self._hosts:
            try:
                self._hosts[name] = self._open(name)
            except NotRun as reason:
                self._hosts[name] = reason
        host = self._hosts[name]
        if isinstance(host, NotRun):
            raise host
        return host

    def _findings(self, task: Task) -> Findings:
        if task.check == results.SOURCE:
            return Findings(text.check_texts(plan.diffuse_specs(task.library), task.library))
        if task.check == DOCUMENT:
            return self._document(task)
        host = self._host(task.host)
        host.choose(task.methods)
        if task.check == HOST:
            whole = task.subject == plan.EVERY_NODE
            place = "" if whole else f": {task.subject} with {task.library}"
            raise NotRun(f"{task.host}: none of the requested checks applies to this host{place}")
        return replace(self._on_host(task, host), hosts=(host.identity(),))

    def _on_host(self, task: Task, host: base.Engine) -> Findings:
        if isinstance(host, base.Host):
            if task.check == plan.PICTURE:
                return self._document(task, host)
            if task.check == plan.STUDIO:
                with suppress(MxeonError):  # the result of the PICTURE task states the error
                    subject = Path(task.subject), host, task.library, self._policy
                    return Findings(pictures=pictures.studio_pictures(*subject))
                return Findings()
            if task.check == release.RELEASE:
                nodes = () if task.subject == plan.EVERY_NODE else task.subject.split(",")
                compared, unjudged = release.check_release(host, task.library, nodes)
                return Findings(compared, unjudged=unjudged)
            if task.check == FUNCTIONS:
                return Findings(shader_functions.judge_functions(host, task.library))
        case = self._case(host, task.subject, task.library, task.seed, task.methods)
        check = next(each for each in checks.CHECKS if each.key == task.check)
        result = check.judge(case)
        images: tuple[results.Picture, ...] = ()
        if task.check in results.DIRECT:
            with suppress(NotRun, ShaderError):  # the check's result states the error
                images = pictures.comparison_pictures(case)
        return Findings((result,), images)

    def _document(self, task: Task, host: base.Host | None = None) -> Findings:
        """Findings of a document, from a host's pictures or (without a host) generated shaders."""
        path = Path(task.subject)
        images: tuple[results.Picture, ...] = ()
        try:
            if host is None:
                subject = path, task.host, task.library, self._policy
                judged, notes = pictures.generate_document(*subject)
            else:
                judged, images, notes = pictures.judge_document(
                    path, host, self._reference, task.library, self._policy
                )
        except (DocumentError, ImageError) as error:
            is_example = path.resolve().is_relative_to(examples_folder())
            if is_example and isinstance(error, DocumentError):
                raise
            return Findings(errors=error.args)
        return Findings(judged, images, notes=notes)


def _case(host: base.Engine, title: str, library: str, seed: int, methods: Methods) -> Case:
    spec = next(each for each in own_nodes(host.name) or ALL if each.title == title)
    backend = backend_of(host.name, spec)
    assert backend is not None  # all tasks have specs with a backend
    return make_case(backend, host, spec, library)
