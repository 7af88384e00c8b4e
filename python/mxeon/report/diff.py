# SPDX-License-Identifier: Apache-2.0
"""Comparison of two reports: changes for the worse, for the better, and others."""

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any

from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, VERDICTS, Result
from mxeon.conformance.results.records import read_record
from mxeon.errors import InputError
from mxeon.hosts.base import Identity
from mxeon.io.files import regular
from mxeon.io.records import ERRORS, spelled
from mxeon.report import JSON_FORMAT

FACTOR = 2.0  # a figure that changes by less is not reported
ORDER = (PASSED, DIFFERS, NOT_RUN, FAILED)
WORSE, BETTER, OTHER = "worse", "better", "other"
PLACE = ("host", "library", "check", "subject")
SHOWN = ("host", "library", "document", "element", "scene")


@dataclass(frozen=True)
class Change:
    """One difference between two reports, with their values; "none" where one has no such entry.

    WORSE are a worse verdict, a new check that fails, a document that is refused now, and the loss of
    a check that did not fail, unless documents were removed. A figure alone is OTHER.
    """

    kind: str  # WORSE, BETTER or OTHER
    place: str  # host, library, check and subject, or the name of a version
    before: str
    after: str

    def __str__(self) -> str:
        return f"{self.kind}: {self.place}: {self.before} -> {self.after}"


@dataclass(frozen=True)
class ShownPicture:
    """A picture of a report and its files; see `mxeon.report.to_json`."""

    document: str
    element: str
    host: str
    library: str
    scene: str
    exr: str
    png: str
    largest_difference: float | None
    reference: str | None = None

    def __post_init__(self) -> None:
        if (self.largest_difference or 0.0) < 0.0:
            raise InputError(
                f"largest_difference must be at least 0; got {self.largest_difference}"
            )


@dataclass(frozen=True)
class Report:
    """Content of results.json; see `mxeon.report.to_json`."""

    format: int
    verdict: str
    counts: dict[str, int]
    sentence: str
    missing: tuple[str, ...]
    errors: tuple[str, ...]
    version: str
    software: dict[str, str]
    documents: tuple[str, ...]
    notes: tuple[str, ...]
    hosts: tuple[Identity, ...]
    results: tuple[Result, ...]
    pictures: tuple[ShownPicture, ...]
    curves: Any
    refused: tuple[str, ...] = ()
    elsewhere: tuple[dict[str, str], ...] = ()
    libraries: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    compared: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise InputError(f"verdict must be one of {', '.join(VERDICTS)}; got {self.verdict!r}")
        judged = (each for each in self.results if each.library not in self.compared)
        tally = Counter(each.verdict for each in judged)
        if self.counts != {verdict: tally[verdict] for verdict in VERDICTS}:
            raise InputError(f"counts must be those of the results; got {self.counts}")


def read_results(folder: str | PathLike[str]) -> Report:
    """Content of a results.json, or of the one in a report's folder.

    Raises ValueError if it is missing or not of this format, which names the first wrong value.
    """
    path = Path(folder) / "results.json" if Path(folder).is_dir() else Path(folder)
    rule = f"{path}: must be the results.json of a report"
    try:
        with open(path, encoding="utf-8", opener=regular) as file:
            content = json.load(file)
        if (written := content["format"]) == JSON_FORMAT:
            # Earlier reports lack some keys.
            later: dict[str, object] = {"elsewhere": [], "refused": [], "compared": []}
            return read_record({**later, "libraries": {}, **content}, Report)
    except OSError as error:
        raise InputError(f"{rule}; {error.strerror}") from None
    except ERRORS as error:
        reason = f"lacks {error}" if isinstance(error, KeyError) else error
        raise InputError(f"{rule}; {reason}") from None
    raise InputError(
        f"{path}: format must be {JSON_FORMAT}; got {written!r}; write the report again"
    )


def compare(before: Report, after: Report) -> tuple[Change, ...]:
    """Changes from one report to another, those for the worse first."""
    before = _renamed(before, _moved(list(before.libraries), list(after.libraries)))
    removed = {*before.documents} - {*after.documents, *after.refused}
    changes = [
        *(Change(OTHER, document, "checked", "removed") for document in sorted(removed)),
        *_results(_by(PLACE, before.results), _by(PLACE, after.results), bool(removed)),
        *_pictures(_by(SHOWN, before.pictures), _by(SHOWN, after.pictures)),
        *_refusals(set(before.refused), set(after.refused)),
        *_facts(before, after),
    ]
    return tuple(sorted(changes, key=lambda change: (WORSE, BETTER, OTHER).index(change.kind)))


def _moved(before: Sequence[str], after: Sequence[str]) -> dict[str, str]:
    """The folder in `after` that each library folder of `before` is, wherever it lies now.

    It has the same path, or else the same name, or else the same place in `--library`.
    """
    same = {folder: folder for folder in before if folder in after}
    for by_name in (True, False):
        for old in before:
            left = [new for new in after if new not in same.values()]
            if by_name:
                left = [new for new in left if Path(new).name == Path(old).name]
            if old not in same and left:
                same[old] = left[0]
    return same


def _renamed(report: Report, libraries: Mapping[str, str]) -> Report:
    """A report whose results and pictures have other names of libraries."""

    def name(library: str) -> str:
        return libraries.get(library, library)

    return replace(
        report,
        results=tuple(replace(each, library=name(each.library)) for each in report.results),
        pictures=tuple(replace(each, library=name(each.library)) for each in report.pictures),
        compared=tuple(map(name, report.compared)),
    )


def _by(names: tuple[str, ...], records: Iterable[Any]) -> dict[tuple[str, ...], Any]:
    """Records by the values of some attributes; records that share them are numbered."""
    keyed: dict[tuple[str, ...], Any] = {}
    uses: Counter[tuple[str, ...]] = Counter()
    for record in records:
        key = tuple(getattr(record, name) for name in names)
        uses[key] += 1
        keyed[key if uses[key] == 1 else (*key, f"number {uses[key]}")] = record
    return keyed


def _results(
    before: Mapping[tuple[str, ...], Result],
    after: Mapping[tuple[str, ...], Result],
    fewer: bool,
) -> Iterator[Change]:
    """Changes of verdicts and errors; a loss is no worse where there are fewer documents."""
    for key in dict.fromkeys((*before, *after)):
        place, old, new = ", ".join(key), before.get(key), after.get(key)
        if old and new:
            if old.verdict != new.verdict:
                worse = ORDER.index(new.verdict) > ORDER.index(old.verdict)
                yield Change(WORSE if worse else BETTER, place, _with_error(old), _with_error(new))
            elif _apart(old.error, new.error):
                yield Change(OTHER, place, _with_error(old), _with_error(new))
        elif old:
            lost = OTHER if fewer or old.verdict == FAILED else WORSE
            yield Change(lost, place, old.verdict, "none")
        elif new:
            kind = WORSE if new.verdict == FAILED else OTHER
            yield Change(kind, place, "none", _with_error(new))


def _pictures(
    before: Mapping[tuple[str, ...], ShownPicture], after: Mapping[tuple[str, ...], ShownPicture]
) -> Iterator[Change]:
    for key in before.keys() & after.keys():
        old, new = (run[key].largest_difference for run in (before, after))
        if _apart(old, new):
            place = f"{', '.join(key)}, largest difference"
            yield Change(OTHER, place, _number(old), _number(new))


def _refusals(before: Set[str], after: Set[str]) -> Iterator[Change]:
    """A document that is refused was not judged, so nothing else here speaks of it."""
    for document in sorted(before ^ after):
        old, new = ("refused" if document in each else "not refused" for each in (before, after))
        yield Change(WORSE if document in after else BETTER, document, old, new)


def _facts(before: Report, after: Report) -> Iterator[Change]:
    """Changes of the versions of mxeon, of packages and of hosts."""
    old, new = (
        {"mxeon": each.version}
        | each.software
        | {f"host {host.name}": f"{host.version}, {host.device}" for host in each.hosts}
        for each in (before, after)
    )
    for name in dict.fromkeys((*old, *new)):
        if old.get(name) != new.get(name):
            yield Change(OTHER, name, old.get(name, "none"), new.get(name, "none"))


def _apart(old: float | None, new: float | None) -> bool:
    """Whether two figures differ by more than FACTOR, or at all if one is not finite."""
    if old is None or new is None or not (math.isfinite(old) and math.isfinite(new)):
        return _number(old) != _number(new)
    small, large = sorted((old, new))
    return large > FACTOR * small


def _with_error(result: Result) -> str:
    return result.verdict + ("" if result.error is None else f" at {_number(result.error)}")


def _number(value: float | None) -> str:
    if value is None:
        return "none"
    return f"{value:.3g}" if math.isfinite(value) else str(spelled(value))
