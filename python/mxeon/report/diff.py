# SPDX-License-Identifier: Apache-2.0
"""Comparison of two reports."""

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from os import PathLike
from pathlib import Path
from typing import Any

from mxeon.conformance import words
from mxeon.conformance.results import (
    DIFFERS,
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    VERDICTS,
    Diagnosis,
    Result,
    Verdict,
)
from mxeon.conformance.results.known_issues import SPREAD
from mxeon.conformance.results.records import make_converter
from mxeon.errors import InputError, one_line
from mxeon.hosts.base import Identity
from mxeon.io.files import regular
from mxeon.io.records import ERRORS, read_strictly, spelled
from mxeon.report import JSON_FORMAT, SCHEMA

WORSE, LOST, BETTER, OTHER = KINDS = ("worse", "not run any longer", "better", "other")
RANKS = (PASSED, DIFFERS, FAILED)
PLACE = ("host", "library", "check", "subject")
SHOWN = ("host", "library", "subject", "scene")


@dataclass(frozen=True)
class Change:
    """One difference between two reports; a missing entry has the value "none".

    - WORSE: a worse verdict; a new check that fails; a newly refused document; a check that failed or differed before,
      with an error more than SPREAD times larger (engines and drivers may add that much), or with a different error and
      a different cause.
    - LOST: a check that no longer runs, unless documents were removed.
    - OTHER: anything else that is not BETTER, such as an error within its tolerance.
    """

    kind: str  # one of KINDS
    host: str  # host and library are "" for documents and versions
    library: str
    subject: str
    item: str  # check, scene of a picture, document or software
    before: str
    after: str
    growth: float = 1.0  # new error over old error; infinite for a first or non-finite error
    reason: str = ""

    @property
    def place(self) -> str:
        return ", ".join(filter(None, (self.host, self.library, self.item, self.subject)))

    def __str__(self) -> str:
        factor = max(self.growth, 1.0 / self.growth if self.growth else math.inf)
        larger = "larger" if self.growth > 1.0 else "smaller"
        times = f"{words.in_words(factor)} times {larger}" * (SPREAD < factor < math.inf)
        after = "; ".join(filter(None, (self.after, times, self.reason)))
        return f"{self.item}: {self.before} -> {after}"


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

    @property
    def subject(self) -> str:
        """The subject of the picture's results, without the document's folder."""
        is_node = self.document == PORTRAIT
        return self.element if is_node else f"{Path(self.document).name}: {self.element}"


@dataclass(frozen=True)
class Elsewhere:
    """A failure for inputs that a document does not use."""

    document: str
    check: str
    subject: str
    host: str
    library: str


@dataclass(frozen=True)
class Report:
    """Content of results.json without $schema; see `mxeon.report.to_json`."""

    format: int
    verdict: Verdict
    passed: bool
    exit_status: int
    counts: dict[Verdict, int]
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
    refused: tuple[str, ...]
    elsewhere: tuple[Elsewhere, ...]
    libraries: dict[str, dict[str, tuple[str, ...]]]
    compared: tuple[str, ...]
    unjudged: tuple[tuple[str, str], ...]
    seconds: float | None

    def __post_init__(self) -> None:
        judged = (each for each in self.results if each.library not in self.compared)
        tally = Counter(each.verdict for each in judged)
        if self.counts != {verdict: tally[verdict] for verdict in VERDICTS}:
            raise InputError(f"counts must be those of the results; got {self.counts}")


def read_results(folder: str | PathLike[str]) -> Report:
    """Content of a results.json, given by its path or its report's folder.

    Raises InputError if it is missing, or names its first wrong value.
    """
    path = Path(folder) / "results.json" if Path(folder).is_dir() else Path(folder)
    rule = f"{path}: must be the results.json of a report"
    try:
        with open(path, encoding="utf-8", opener=regular) as file:
            content = json.load(file)
        if not isinstance(content, dict):
            raise InputError("it must be an object")
        if (written := content["format"]) == JSON_FORMAT:
            if (named := content.pop("$schema")) != SCHEMA:
                raise InputError(f"$schema must be {SCHEMA}; got {named!r}")
            return read_strictly(make_converter(), content, Report)
    except OSError as error:
        raise InputError(f"{rule}; {error.strerror}") from None
    except ERRORS as error:
        reason = f"lacks {error}" if isinstance(error, KeyError) else error
        raise InputError(f"{rule}; {reason}") from None
    raise InputError(
        f"{path}: format must be {JSON_FORMAT}; got {written!r}; run the check again with this mxeon"
    )


def compare(before: Report, after: Report) -> tuple[Change, ...]:
    """Changes between two reports by kind, host, library and subject; the largest first."""
    before = _renamed(before, _moved(list(before.libraries), list(after.libraries)))
    names = {Path(each).name for each in (*after.documents, *after.refused)}
    removed = {each for each in before.documents if Path(each).name not in names}
    changes = [
        *(Change(OTHER, "", "", "", each, "checked", "removed") for each in sorted(removed)),
        *_results(_by(PLACE, before.results), _by(PLACE, after.results), bool(removed)),
        *_pictures(before, after),
        *(  # nothing else reports a refused document, which was not judged
            Change(WORSE, "", "", "", each, "not refused", "refused")
            if each in after.refused
            else Change(BETTER, "", "", "", each, "refused", "not refused")
            for each in sorted({*before.refused} ^ {*after.refused})
        ),
        *_facts(before, after),
    ]

    def size(change: Change) -> float:
        return math.inf if change.growth == 0.0 else abs(math.log(change.growth))

    largest: dict[tuple[str, ...], float] = {}
    for each in changes:
        group = _group(each)
        largest[group] = max(size(each), largest.get(group, 0.0))

    def order(change: Change) -> tuple[object, ...]:
        kind, *location, subject = group = _group(change)
        return KINDS.index(kind), *location, -largest[group], subject, -size(change)

    return tuple(sorted(changes, key=order))


def _group(change: Change) -> tuple[str, str, str, str]:
    return change.kind, change.host, change.library, change.subject


def lines(changes: Sequence[Change]) -> Iterator[str]:
    """Sorted changes as text, grouped by kind, host and library, then by subject."""
    location: list[str] = []
    for group, rows in groupby(changes, key=_group):
        kind, host, library, subject = group
        if location != (location := [kind, host, library]):
            yield f"{kind}: {one_line(f'{host} with {library}' if host else '')}".rstrip()
        if subject:
            yield f"  {one_line(subject)}"
        yield from (f"  {'  ' * bool(subject)}{one_line(each)}" for each in rows)
    tally = Counter(each.kind for each in changes)
    yield ", ".join(f"{tally[kind]} {kind}" for kind in KINDS if tally[kind]) or "no difference"


def _moved(before: Sequence[str], after: Sequence[str]) -> dict[str, str]:
    """Maps library folders of `before` to the same folders in `after`, which may have moved.

    Matches by path, then by name, then by position in `--library`.
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
    def name(library: str) -> str:
        return libraries.get(library, library)

    return replace(
        report,
        results=tuple(replace(each, library=name(each.library)) for each in report.results),
        pictures=tuple(replace(each, library=name(each.library)) for each in report.pictures),
        compared=tuple(map(name, report.compared)),
    )


def _by(names: tuple[str, ...], records: Iterable[Any]) -> dict[tuple[str, ...], Any]:
    """Records by the values of some attributes; duplicates are numbered."""
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
    """Changes of results; with `fewer` documents, missing checks are not LOST."""
    for key in dict.fromkeys((*before, *after)):
        old, new = before.get(key), after.get(key)
        host, library, check, subject, *number = key
        growth = 1.0
        if old and new:
            kind, reason = _change(old, new)
            growth = _growth(old.error, new.error)
        elif old:
            kind, reason = OTHER if fewer or old.verdict == NOT_RUN else LOST, ""
        else:
            kind, reason = WORSE if new and new.verdict == FAILED else OTHER, ""
        if kind:
            texts = (_with_error(old), _with_error(new))
            item = ", ".join((check, *number))
            yield Change(kind, host, library, subject, item, *texts, growth, reason)


def _change(old: Result, new: Result) -> tuple[str, str]:
    """Kind of a change of a result ("" for none), and the reason if the values do not show it."""
    if NOT_RUN in (old.verdict, new.verdict):
        if old.verdict == new.verdict:
            return "", ""
        # The failure that prevents this check is compared on its own.
        if old.follows or new.follows:
            return OTHER, old.reason or new.reason
        if new.verdict == NOT_RUN:
            return LOST, new.reason
        return WORSE if new.verdict == FAILED else BETTER, ""
    if old.verdict != new.verdict:
        kind = WORSE if RANKS.index(new.verdict) > RANKS.index(old.verdict) else BETTER
        explained = old.verdict == DIFFERS and new.verdict == FAILED
        return kind, "no permitted reading explains it any longer" * explained
    growth = _growth(old.error, new.error)
    if not 1.0 / SPREAD <= growth <= SPREAD:
        return OTHER if new.verdict == PASSED else WORSE if growth > 1.0 else BETTER, ""
    lost, found = sorted({*old.pages} - {*new.pages}), sorted({*new.pages} - {*old.pages})
    kind, reason = "", ""
    if lost:
        kind, reason = WORSE, f"{words.listed(lost)} no longer explains it"
    elif (
        new.diagnosis.names_a_cause and old.diagnosis.first.identity != new.diagnosis.first.identity
    ):
        was, now = (
            words.diagnosis(Diagnosis((each.diagnosis.first,))) or "none" for each in (old, new)
        )
        kind, reason = WORSE, f"diagnosis was {was}, is {now}"
    elif found:
        kind, reason = BETTER, f"{words.listed(found)} explains it"
    # The same error with a new explanation is neither better nor worse.
    return OTHER if kind and _number(old.error) == _number(new.error) else kind, reason


def _pictures(before: Report, after: Report) -> Iterator[Change]:
    """Changes of pictures; within the tolerance they are OTHER."""
    shown = [_by(SHOWN, each.pictures) for each in (before, after)]
    failed = [
        {
            (each.host, each.library, each.subject)
            for each in report.results
            if each.verdict == FAILED
        }
        for report in (before, after)
    ]
    for key in (key for key in shown[0] if key in shown[1]):
        old, new = (each[key].largest_difference for each in shown)
        growth = _growth(old, new)
        if 1.0 / SPREAD <= growth <= SPREAD:
            continue
        host, library, subject, scene, *number = key
        worse = growth > 1.0
        counts = (host, library, subject) in failed[worse]
        kind = (WORSE if worse else BETTER) if counts else OTHER
        item = ", ".join((scene, *number, "largest difference"))
        yield Change(kind, host, library, subject, item, _number(old), _number(new), growth)


def _facts(before: Report, after: Report) -> Iterator[Change]:
    """Changes of versions of mxeon, packages and hosts."""
    old, new = (
        {"mxeon": each.version}
        | each.software
        | {f"host {host.name}": f"{host.version}, {host.device}" for host in each.hosts}
        for each in (before, after)
    )
    for name in dict.fromkeys((*old, *new)):
        if old.get(name) != new.get(name):
            values = old.get(name, "none"), new.get(name, "none")
            yield Change(OTHER, "", "", "", name, *values)


def _growth(old: float | None, new: float | None) -> float:
    """New error over old error; missing and non-finite errors count as infinite."""
    small, large = (
        math.inf if each is None or not math.isfinite(each) else each for each in (old, new)
    )
    if small == large:
        return 1.0
    return 0.0 if math.isinf(small) else large / small if small else math.inf


def _with_error(result: Result | None) -> str:
    if result is None:
        return "none"
    ran = result.verdict != NOT_RUN and result.error is not None
    return f"{result.verdict} at {_number(result.error)}" if ran else result.verdict


def _number(value: float | None) -> str:
    if value is None:
        return "none"
    return f"{value:.3g}" if math.isfinite(value) else str(spelled(value))
