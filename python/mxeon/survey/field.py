# SPDX-License-Identifier: Apache-2.0
"""A comparison of renderers' nodes, which is read from any number of reports."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TypeAlias

from mxeon.conformance import words
from mxeon.conformance.results import (
    DIRECT,
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    RESULTS,
    Diagnosis,
    Kind,
    Result,
    Verdict,
)
from mxeon.conformance.specs.diffuse import DIFFUSE, SURFACE_LOBES
from mxeon.errors import InputError
from mxeon.io.files import AnyPath
from mxeon.models.table import diffuse_model
from mxeon.report.diff import Report, read_results
from mxeon.survey import ROWS, nodes

Place: TypeAlias = tuple[str, str, str]  # host, library and node

BACK = "back"
# Checks for each column of the page. If a node has several of the checks, the first check counts.
# The column BACK has no checks, because portraits are judged instead.
CHECKS = {
    "direct": DIRECT,
    "surroundings": ("environment",),
    "energy": ("furnace",),
    "color": ("integral", "environment"),
    "black": ("black",),
    "back": (),
}


@dataclass(frozen=True)
class Portrait:
    """A picture of a node and its reference, as EXR files."""

    scene: str
    image: Path
    reference: Path
    difference: float


@dataclass(frozen=True)
class Entry:
    """A node of a renderer in one run."""

    mxeon: str  # version of mxeon
    host: str
    library: str
    node: str
    version: str  # version and device are empty if the host did not run
    device: str
    claimed: str  # title of the claimed model
    form: str  # title of the published form that the checks used
    cells: Mapping[str, Result]  # keys: columns of CHECKS
    pages: tuple[str, ...]  # pages of docs/upstream on the node's defects
    portraits: Mapping[str, Portrait]  # keys: scenes
    report: Path  # folder of the report

    @property
    def verdict(self) -> Verdict:
        verdicts = [cell.verdict for cell in self.cells.values()]
        if FAILED in verdicts:
            return FAILED
        return PASSED if PASSED in verdicts else NOT_RUN

    @property
    def harm(self) -> float:
        """Largest error of a failed check; 0 if no check failed, -1 if no check ran."""
        if self.verdict == NOT_RUN:
            return -1.0
        failed = [cell.error for cell in self.cells.values() if cell.verdict == FAILED]
        return max((math.inf if each is None else each for each in failed), default=0.0)

    @property
    def cause(self) -> tuple[object, ...]:
        """Properties of an entry. Entries with equal properties share a row of the page."""
        verdicts = tuple((column, cell.verdict) for column, cell in self.cells.items())
        models = self.claimed, self.form, self.found, self.found_around
        return self.host, *models, verdicts, self.pages

    @property
    def found(self) -> str:
        """The model found in direct light, or the reason why no model is known."""
        return model_of(self.cells["direct"], self.form or self.claimed)

    @property
    def found_around(self) -> str:
        """The model found in a white environment; "" without such a check."""
        cell = self.cells.get("surroundings")
        return model_of(cell, self.form or self.claimed) if cell else ""


def by_harm(entries: Sequence[Entry]) -> list[list[Entry]]:
    """Group entries by renderer and cause. The largest errors of failed checks come first."""
    rows: dict[tuple[object, ...], list[Entry]] = {}
    for entry in sorted(entries, key=lambda each: each.harm, reverse=True):
        rows.setdefault(entry.cause, []).append(entry)
    hosts = list(dict.fromkeys(row[0].host for row in rows.values()))
    return sorted(rows.values(), key=lambda row: hosts.index(row[0].host))


def model_of(result: Result, expected: str) -> str:
    """The model that a check found, or a description of the first cause of a failure."""
    if result.verdict == PASSED:
        return expected
    if result.verdict == NOT_RUN:
        return "not run"
    first = result.diagnosis.first
    return (
        first.key
        if first.kind is Kind.MODEL
        else words.diagnosis(Diagnosis((first,), result.diagnosis.distances))
    )


def reports_in(folder: AnyPath) -> list[Path]:
    """Folders that contain a report, which are the given folder or some of its subfolders."""
    if Path(folder, RESULTS).is_file():
        return [Path(folder)]
    return sorted(path.parent for path in Path(folder).glob(f"*/{RESULTS}"))


def read_field(folders: Sequence[str | PathLike[str]]) -> tuple[Entry, ...]:
    """Nodes that claim a rough diffuse model, from folders of reports; see `reports_in`.

    If several reports have the same host, version, device, library and node, the last report
    counts. Raises InputError if a folder has no report, or if no node claims a rough diffuse model.
    """
    entries = {}
    for folder in folders:
        reports = reports_in(folder)
        if not reports:
            raise InputError(f"{folder}: must be the folder of a report, or hold some")
        for report in reports:
            for entry in _entries(read_results(report), report):
                key = entry.host, entry.version, entry.device, entry.library, entry.node
                entries[key] = entry
    if not entries:
        raise InputError("a report must have a node that claims a rough diffuse model; none has")
    return tuple(entries.values())


def _entries(report: Report, folder: Path) -> Iterator[Entry]:
    claims = {spec.title: diffuse_model(spec.model).title for spec in (*DIFFUSE, *SURFACE_LOBES)}
    native = {(row.name, spec.title): spec.claimed for row in ROWS for spec in nodes(row.name)}
    places: dict[Place, dict[str, Result]] = {}
    for result in report.results:
        place = result.host, result.library, result.subject
        places.setdefault(place, {})[result.check] = result
    for place, results in places.items():
        direct = next((results[key] for key in DIRECT if key in results), None)
        # A result does not name the claimed model if the host did not run.
        default = native.get((place[0], place[2])) or claims.get(place[2])
        claimed = direct and (direct.claimed or default)
        if direct and claimed:
            portraits = {each.scene: each for each in _portraits(report, place, folder)}
            cells = {
                column: next(results[key] for key in keys if key in results)
                for column, keys in CHECKS.items()
                if any(key in results for key in keys)
            }
            # The back-lit portrait passes if its error is within the tolerance for direct light.
            if BACK in portraits and direct.tolerance is not None:
                error, allowed = portraits[BACK].difference, direct.tolerance
                verdict: Verdict = PASSED if error <= allowed else FAILED
                check = PORTRAIT, "The picture in light from behind matches the model."
                node = direct.subject, direct.host, direct.library
                cells[BACK] = Result(*check, *node, verdict, error, direct.quantity, allowed)
            pages = tuple(dict.fromkeys(page for each in results.values() for page in each.pages))
            hosts = {each.name: (each.version, each.device) for each in report.hosts}
            names = (*place, *hosts.get(direct.host, ("", "")), claimed, direct.model)
            yield Entry(report.version, *names, cells, pages, portraits, folder)


def _portraits(report: Report, place: Place, folder: Path) -> Iterator[Portrait]:
    for each in report.pictures:
        if (each.document, each.host, each.library, each.element) != (PORTRAIT, *place):
            continue
        if each.reference and each.difference:
            # Reports may come from anywhere, so only the names of files are used, not the paths.
            image, model = (
                folder / "pictures" / Path(file).name for file in (each.exr, each.reference)
            )
            yield Portrait(each.scene, image, model, abs(each.difference.largest))
