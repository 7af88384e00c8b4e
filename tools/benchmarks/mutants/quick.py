# SPDX-License-Identifier: Apache-2.0
"""Checks of the nodes of pbrlib as a mutant needs them: up to the first error, and nothing else.

What does not depend on the library is computed once: pairs, quadratures, and the float64 reference.
Neither controls nor diagnoses are asked for, since a check that fails is judged already. A check that
fails with eonlib as it is, on the same host, says nothing about a mutant.
"""

import re
from dataclasses import replace
from tempfile import gettempdir
from typing import Any

import numpy as np

from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.diagnosis.verdicts import renderer_warnings
from mxeon.conformance.probes.families import PBR_SUBJECTS, probe_type, probe_type_of
from mxeon.conformance.run.tasks import Task
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import Metric
from mxeon.errors import MxeonError
from mxeon.hosts import open_host
from mxeon.hosts.base import Host

FOLDER = re.compile(rf"{re.escape(gettempdir())}/\S*/")  # of a file that a compiler names
ROWS = {check.key: check for check in CHECKS}
SUBJECTS = {subject.title: subject for subject in PBR_SUBJECTS}


class Exceeded(Exception):
    """An error above its tolerance."""


def remembered(subject: Any) -> Any:
    """A copy of a subject that computes what is expected of a batch once."""
    values: dict[
        int, tuple[Batch, Array]
    ] = {}  # each batch is kept, so that its identity is its own

    def expected(batch: Batch) -> Array:
        if id(batch) not in values:
            values[id(batch)] = batch, subject.expected(batch)
        return values[id(batch)][1]

    copy = replace(subject)
    object.__setattr__(copy, "expected", expected)  # the class is frozen, its copy is ours
    return copy


class Quick:
    """Judges nodes with one library after the other, and keeps the hosts and what they share."""

    def __init__(self, clean: str = "eonlib") -> None:
        self._library = clean  # without a mutant
        self._hosts: dict[str, Host] = {}
        self._probes: dict[tuple[str, str], Any] = {}
        self._current: set[tuple[str, str]] = set()  # probes of the library that is judged
        self._clean: dict[Task, dict[tuple[str, str], str]] = {}  # failures without a mutant

    def close(self) -> None:
        """Close the hosts."""
        for host in self._hosts.values():
            host.close()

    def renew(self) -> None:
        """Forget what depends on the library: another is judged from now on."""
        self._current.clear()

    def failure(self, task: Task) -> dict[str, str] | None:
        """The first failure of a task that the library without a mutant does not share: check, excess, host and
        diagnosis. None if there is none.
        """
        found = self._failures(task)
        clean = replace(task, library=self._library)
        if found and clean not in self._clean:
            self._clean[clean] = self._failures(clean)
        for key, diagnosis in found.items():
            if key not in self._clean[clean]:
                return {"check": key[0], "excess": "", "host": task.host, "diagnosis": diagnosis}
        return None

    def _failures(self, task: Task) -> dict[tuple[str, str], str]:
        """Diagnoses of what fails, by check and subject."""
        row, probe = ROWS[task.check], self._probe(task)
        try:
            with renderer_warnings():
                excess = exceeds(row, probe)
        except MxeonError as error:
            excess = FOLDER.sub("", str(error).strip().partition("\n")[0])
        return {(task.check, task.subject): excess} if excess else {}

    def _probe(self, task: Task) -> Any:
        """The probe of a task, with all that one of another library has computed."""
        if task.host not in self._hosts:
            self._hosts[task.host] = open_host(task.host)
        host, key = self._hosts[task.host], (task.host, task.subject)
        first = self._probes.get(key)
        if first is None:
            subject = SUBJECTS[task.subject]
            kind = probe_type_of(subject, probe_type(task.host))  # type: ignore[arg-type]
            assert kind is not None  # or there were no task
            self._probes[key] = kind(host, remembered(subject), task.library)
        elif key not in self._current or first.library != task.library:
            probe = type(first)(host, first.subject, task.library)
            kept = {name: value for name, value in vars(first).items() if name in SHARED}
            vars(probe).update(kept)
            self._probes[key] = probe
        self._current.add(key)
        return self._probes[key]


# What probes keep that no library changes.
SHARED = (
    "batches",
    "few",
    "edges",
    "turned",
    "mirrored",
    "integrated",
    "integrals",
    "albedos",
    "stretched",
    "films",
)


def exceeds(check: Check, probe: Any) -> str:
    """The first error of a check above its tolerance, in words; "" if there is none."""
    allowed = check.tolerance(probe.kind)
    assert allowed is not None  # or there were no task
    tolerance = check.adapt(allowed, probe.subject, probe.kind, probe.host)

    def metric(measured: Array, expected: Array) -> Array:
        errors = np.asarray(tolerance.metric(measured, expected))
        if not errors.max() <= tolerance.value:
            raise Exceeded(f"{errors.max():.3g} > {tolerance.value:.3g} {tolerance.unit}")
        return errors

    asked: Metric = metric
    try:
        error = check.measured(probe, asked).error
    except Exceeded as excess:
        return str(excess)
    return "" if error <= tolerance.value else f"{error:.3g} > {tolerance.value:.3g}"
