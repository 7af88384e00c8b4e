# SPDX-License-Identifier: Apache-2.0
"""The tasks of a run, each a check of one subject on one host with one library, and their findings.

A task is a few words and its findings are plain data, so both travel to other processes and
machines.
"""

from dataclasses import dataclass, field

from mxeon.conformance.results import AlbedoCurve, Picture, Result
from mxeon.hosts.base import Identity

HOST, DEFINITION = "host", "definition"
CURVE, PICTURE = "curve", "picture"
FUNCTIONS, DOCUMENT = "twins", "document"
EVERY_NODE = "every node"


@dataclass(frozen=True)
class Task:
    """One independent piece of a run: a check of one subject on one host with one library."""

    # Key of a row of `mxeon.conformance.checks`, or HOST, DEFINITION, SOURCE, CURVE, PICTURE,
    # FUNCTIONS or DOCUMENT.
    check: str
    subject: str  # title of a node, path of a document, or SHADER_FUNCTIONS
    host: str
    library: str

    def __str__(self) -> str:
        return f"{self.host}, {self.check}, {self.subject}, {self.library}"


@dataclass(frozen=True)
class Plan:
    """The tasks of a run and all that they depend on; equal plans are equal runs."""

    version: str  # of mxeon
    # Versions of the packages that take part (Python, NumPy, MaterialX, ...).
    software: dict[str, str]
    tasks: tuple[Task, ...]
    documents: tuple[str, ...]  # their paths
    # The policy for documents, by the option of the command.
    options: dict[str, str] = field(default_factory=dict)
    # SHA-256 of each file that the findings depend on, by path; "" where it cannot be read. Empty
    # where the run is not kept.
    files: dict[str, str] = field(default_factory=dict)
    # Titles of the nodes of each document, by its path.
    contents: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # For each document, by title of a node, the regions that its inputs are not in.
    unreached: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    # Documents that cannot be read; as of `mxeon.conformance.results.Run`.
    refused: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # As those of `mxeon.conformance.results.Run`.
    libraries: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    compared: tuple[str, ...] = ()  # as of `mxeon.conformance.results.Run`


@dataclass(frozen=True)
class Findings:
    """The outcome of one task; see Run for the fields."""

    results: tuple[Result, ...] = ()
    pictures: tuple[Picture, ...] = ()
    curves: tuple[AlbedoCurve, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()
    errors: tuple[str, ...] = ()
    hosts: tuple[Identity, ...] = ()

    def answer(self, task: Task) -> bool:
        """Whether these are findings of a task: there are some, and all are of its host."""
        records: list[Result | Picture | AlbedoCurve]
        records = [*self.results, *self.pictures, *self.curves]
        location = (task.host, task.library)
        return bool(records or self.errors) and all(
            (record.host, record.library) == location for record in records
        )
