# SPDX-License-Identifier: Apache-2.0
"""Compares two reports."""

import json
import math
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from os import PathLike
from pathlib import Path
from typing import TypeAlias

from mxeon import errors
from mxeon.conformance import words
from mxeon.conformance.diagnosis import SAME
from mxeon.conformance.results import (
    DIFFERS,
    FAILED,
    NOT_RUN,
    PASSED,
    VERDICTS,
    Difference,
    Region,
    Result,
    Verdict,
    grouped,
)
from mxeon.conformance.results.known_issues import SPREAD
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.results.records import make_converter
from mxeon.errors import InputError, one_line
from mxeon.hosts.base import Identity
from mxeon.io.files import regular
from mxeon.io.records import UNREADABLE, read_strictly, spelled
from mxeon.report import ADDED, JSON_FORMAT, SCHEMA

WORSE, LOST, BETTER, OTHER = KINDS = ("worse", "not run any longer", "better", "other")
RANKS = (PASSED, DIFFERS, FAILED)
PLACE = ("host", "library", "check", "subject")
LISTED = 12  # maximum number of listed entries that the later run leaves out
SAMPLED = (Quantity.VALUES, Quantity.PIXELS)  # counts that depend on which samples are drawn
# For the same samples, errors on different engines or drivers differ by at most the factor EQUAL,
# plus FUNCTIONS, which is the error of built-in functions.
EQUAL, FUNCTIONS = 1.02, 2e-5
# If the samples differ, errors change by at most CHANCE standard deviations, and the rms distance
# to the nearest model changes by at most the factor DISTANCE.
CHANCE, DISTANCE = 6.0, 3.0


@dataclass(frozen=True)
class Growth:
    """A number of a result that changed by more than noise.

    - `key`: A key of `mxeon.conformance.words.GROWTHS`.
    - `region`: The region of samples to which the number applies; None for all samples.
    """

    key: str
    before: float
    after: float
    region: Region | None = None

    @property
    def factor(self) -> float:
        return self.after / self.before if self.before else math.inf


@dataclass(frozen=True)
class Change:
    """A difference between two reports; "none" stands for an entry that a report lacks."""

    kind: str  # one of KINDS
    host: str  # host and library are "" for documents and versions
    library: str
    subject: str
    item: str  # name of a check, document or software
    before: str
    after: str
    reason: str = ""
    growths: tuple[Growth, ...] = ()

    @property
    def location(self) -> str:
        return f"{self.host} with {self.library}" if self.host else ""

    @property
    def place(self) -> str:
        return ", ".join(filter(None, (self.host, self.library, self.item, self.subject)))

    @property
    def size(self) -> float:
        """The largest absolute logarithm of the factors by which numbers grew or fell."""
        factors = (each.factor for each in self.growths)
        return max((abs(math.log(each)) if each else math.inf for each in factors), default=0.0)

    def __str__(self) -> str:
        why = (
            words.growth(each.key, each.before, each.after, each.region)
            for each in self.growths[:1]
        )
        after = "; ".join(filter(None, (self.after, self.reason, *why)))
        return f"{self.item}: {self.before} -> {after}"


@dataclass(frozen=True)
class ShownPicture:
    """A picture in results.json, with the paths of files; see `mxeon.report.to_json`."""

    document: str
    element: str
    host: str
    library: str
    scene: str
    exr: str
    png: str
    difference: Difference | None
    reference: str | None = None


@dataclass(frozen=True)
class Elsewhere:
    """A check that fails for inputs that a document does not use."""

    document: str
    check: str
    subject: str
    host: str
    library: str


@dataclass(frozen=True)
class Report:
    """The content of results.json, except for $schema; see `mxeon.report.to_json`."""

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
    """Read a results.json, given the path of the file or of the folder of a report.

    Raises InputError if the file is missing or invalid. The message names the first wrong value.
    """
    path = Path(folder) / "results.json" if Path(folder).is_dir() else Path(folder)
    rule = f"{path}: must be the results.json of a report"
    try:
        with open(path, encoding="utf-8", opener=regular) as file:
            content = json.load(file)
        if not isinstance(content, dict):
            raise InputError("it must be an object")
        if (written := content["format"]) == JSON_FORMAT:
            return read_report(content)
    except OSError as error:
        raise InputError(f"{rule}; {error.strerror}") from None
    except UNREADABLE as error:
        reason = f"lacks {error}" if isinstance(error, KeyError) else error
        raise InputError(f"{rule}; {reason}") from None
    raise InputError(
        f"{path}: format must be {JSON_FORMAT}; got {written!r}; run the check again with this mxeon"
    )


def read_report(content: dict[str, object]) -> Report:
    """The Report in a JSON object that `mxeon.report.to_json` has written."""
    if (identifier := content.pop("$schema")) != SCHEMA:
        raise InputError(f"$schema must be {SCHEMA}; got {identifier!r}")
    if isinstance(rows := content.get("results"), list):
        absent = dict.fromkeys(ADDED, "")
        content["results"] = [absent | row if isinstance(row, dict) else row for row in rows]
    return read_strictly(make_converter(), content, Report)


def compare(before: Report, after: Report) -> tuple[Change, ...]:
    """Changes between two reports, sorted by kind, host and library, with large changes first."""
    folders = _matching_folders(list(before.libraries), list(after.libraries))
    renamed = [
        replace(each, library=folders.get(each.library, each.library)) for each in before.results
    ]
    # Older reports lack documents.
    unknown = {_place(each) for each in renamed if not each.document}
    shared = (_shared(renamed) | _shared(after.results)) - unknown
    names = {Path(each).name for each in (*after.documents, *after.refused)}
    known = {each.name: each for each in before.hosts}
    renewed = {each.name for each in after.hosts if known.get(each.name, each) != each}
    removed = {each for each in before.documents if Path(each).name not in names}
    changes = [
        *(Change(OTHER, "", "", "", each, "checked", "removed") for each in sorted(removed)),
        *_result_changes(
            _by_place(renamed, shared), _by_place(after.results, shared), bool(removed), renewed
        ),
        *(  # refused documents have no results that could be compared
            Change(WORSE, "", "", "", each, "not refused", "refused")
            if each in after.refused
            else Change(BETTER, "", "", "", each, "refused", "not refused")
            for each in sorted({*before.refused} ^ {*after.refused})
        ),
        *_version_changes(before, after),
    ]
    groups = grouped(changes, _group).items()
    largest = {group: max(each.size for each in rows) for group, rows in groups}

    def order(change: Change) -> tuple[object, ...]:
        kind, *location, subject = group = _group(change)
        return KINDS.index(kind), *location, -largest[group], subject, -change.size

    return tuple(sorted(changes, key=order))


def status(changes: Iterable[Change]) -> int:
    """Exit status: FAILED if something got worse, NOT_RUN if a check no longer runs."""
    kinds = {each.kind for each in changes}
    return errors.FAILED if WORSE in kinds else errors.NOT_RUN if LOST in kinds else errors.PASSED


def _group(change: Change) -> tuple[str, str, str, str]:
    return change.kind, change.host, change.library, change.subject


def lines(changes: Sequence[Change]) -> Iterator[str]:
    """Format sorted changes as text, grouped by kind, host and library, then by subject."""
    out = [each for each in changes if each.kind == OTHER and each.after in ("none", "removed")]
    tally = Counter(each.kind for each in changes)
    if len(out) > LISTED:
        changes = [each for each in changes if each not in out]
    for (kind, location), group in groupby(changes, key=lambda each: (each.kind, each.location)):
        yield f"{kind}: {one_line(location)}".rstrip()
        for subject, rows in groupby(group, key=lambda each: each.subject):
            if subject:
                yield f"  {one_line(subject)}"
            indent = "    " if subject else "  "
            yield from (f"{indent}{one_line(each)}" for each in rows)
    if len(out) > LISTED:
        files = sum(each.after == "removed" for each in out)
        places = {(each.location, each.subject) for each in out if each.after == "none"}
        yield f"not in the later run: {words.counted(files, 'document')}, {len(places)} nodes and materials"
    yield ", ".join(f"{tally[kind]} {kind}" for kind in KINDS if tally[kind]) or "no difference"


def to_json(changes: Iterable[Change]) -> list[dict[str, object]]:
    """Changes as JSON objects, which have the fields of Change and the text `place`."""
    convert = make_converter().unstructure
    return [convert(each) | {"place": each.place} for each in changes]


def annotations(changes: Iterable[Change]) -> Iterator[str]:
    """One annotation per subject with worse or lost checks, since GitHub shows few annotations."""
    for (kind, *_, subject), rows in grouped(changes, _group).items():
        if level := {WORSE: "error", LOST: "warning"}.get(kind):
            title = ", ".join(filter(None, (kind, rows[0].location, subject)))
            yield words.annotation(level, title, "\n".join(map(one_line, rows)))


def _matching_folders(before: Sequence[str], after: Sequence[str]) -> dict[str, str]:
    """Map library folders of `before` to folders of `after`, since folders may have moved.

    Folders are matched by path, then by name, then by position in `--library`.
    """
    matches = {folder: folder for folder in before if folder in after}
    for by_name in (True, False):
        for old in before:
            candidates = (
                new
                for new in after
                if new not in matches.values()
                if Path(new).name == Path(old).name or not by_name
            )
            if old not in matches and (new := next(candidates, "")):
                matches[old] = new
    return matches


def _place(result: Result) -> tuple[str, ...]:
    return tuple(getattr(result, name) for name in PLACE)


def _shared(results: Iterable[Result]) -> set[tuple[str, ...]]:
    """Places of several results, because documents in several folders have the same name."""
    places = {(_place(each), each.document) for each in results if each.document}
    return {place for place, uses in Counter(place for place, _ in places).items() if uses > 1}


def _by_place(
    results: Iterable[Result], shared: Container[tuple[str, ...]]
) -> dict[tuple[str, ...], Result]:
    """Results by host, library, check and subject; if `shared`, also by the document's folder.

    Keys of duplicates have a number.
    """
    keyed: dict[tuple[str, ...], Result] = {}
    uses: Counter[tuple[str, ...]] = Counter()
    for result in results:
        key = _place(result)
        if key in shared:
            key = *key, f"in {Path(result.document).parent.name}"
        uses[key] += 1
        keyed[key if uses[key] == 1 else (*key, f"number {uses[key]}")] = result
    return keyed


Results: TypeAlias = Mapping[tuple[str, ...], Result]


def _result_changes(
    before: Results, after: Results, fewer: bool, renewed: Container[str]
) -> Iterator[Change]:
    """Changes of results.

    If there are `fewer` documents than before, no missing check counts as LOST. The hosts in
    `renewed` have changed their version or device.
    """
    for key in (key for key in before if key in after):
        old, new = before[key], after[key]
        kind, reason, growths = _change(old, new)
        if kind == WORSE and old.host in renewed and _is_rounding(old, new):
            kind, reason = OTHER, words.ROUNDED
        if kind:
            host, library, check, subject, *number = key
            texts = _with_error(old), _with_error(new)
            item = ", ".join((check, *number))
            yield Change(kind, host, library, subject, item, *texts, reason, growths)
    for results, others, is_new in ((before, after, False), (after, before, True)):
        places = {key[:2] for key in others}
        groups: dict[tuple[str, str, str, str], list[Result]] = {}
        for key, result in results.items():
            if key not in others:
                worse = WORSE if result.verdict == FAILED else OTHER
                lost = OTHER if fewer or result.verdict == NOT_RUN else LOST
                # Report a host or library that is missing in one report as a single change.
                subject = result.subject if key[:2] in places else ""
                place = (worse if is_new else lost, result.host, result.library, subject)
                groups.setdefault(place, []).append(result)
        for (kind, host, library, subject), row in groups.items():
            checks = [each.check for each in row]
            item = words.listed(checks) if subject else words.counted(len(row), "check")
            verdicts = words.listed(list(dict.fromkeys(map(_with_error, row))))
            was, now = ("none", verdicts) if is_new else (verdicts, "none")
            yield Change(kind, host, library, subject, item, was, now)


def _change(old: Result, new: Result) -> tuple[str, str, tuple[Growth, ...]]:
    """Kind of a result's change ("" for none), a reason in words, and numbers that grew."""
    if NOT_RUN in (old.verdict, new.verdict):
        if old.verdict == new.verdict:
            return "", "", ()
        # If another failure prevents a check, only the result of the other failure is compared.
        if old.follows or new.follows:
            return OTHER, old.reason or new.reason, ()
        if new.verdict == NOT_RUN:
            return LOST, new.reason, ()
        return WORSE if new.verdict == FAILED else BETTER, "", ()
    grown = _growths(old, new)
    fallen = tuple(replace(x, before=x.after, after=x.before) for x in _growths(new, old))
    if old.verdict != new.verdict:
        worse = RANKS.index(new.verdict) > RANKS.index(old.verdict)
        reason = words.UNEXPLAINED if old.verdict == DIFFERS and worse else ""
        if old.verdict == PASSED and worse:
            # If the error is within the tolerance, the check's negative control passed too.
            reason = words.excess(new) if new.within else words.diagnosis(new.diagnosis)
        return WORSE if worse else BETTER, reason, grown if worse else fallen
    if new.verdict == PASSED:
        return (OTHER, "", grown or fallen) if grown or fallen else ("", "", ())
    if old.pages and not new.pages and new.verdict == FAILED and not _is_repaired(old, new):
        return WORSE, words.LOST_PAGE.format(words.listed(old.pages)), grown
    if grown:
        return WORSE, "", grown
    found = sorted({*new.pages} - {*old.pages})
    if found and old.samples == new.samples:
        return BETTER, words.FOUND_PAGE.format(words.listed(found)), fallen
    return (BETTER, "", fallen) if fallen else ("", "", ())


def _growths(old: Result, new: Result) -> tuple[Growth, ...]:
    """Numbers that grew by more than noise. Numbers for all samples precede numbers for regions.

    A result without samples has a single number, the error. If a number grows by less than the
    tolerance, the growth is ignored.
    """
    margin = (new.tolerance or 0.0) + FUNCTIONS
    if not (old.errors and new.errors):
        least, most = (math.inf if each.error is None else each.error for each in (old, new))
        counted = new.quantity and new.quantity.counted and new.quantity not in SAMPLED
        factor = 1.0 if counted else SPREAD
        return (Growth("error", least, most),) if most > factor * least + margin else ()
    same = old.samples == new.samples
    permitted = old.verdict == new.verdict == DIFFERS
    regions = {each.region: each for each in old.errors}
    found = []
    for now in new.errors[: 1 if permitted else None]:
        if not (was := regions.get(now.region)):
            continue
        # The variance of a mean square is largest if each error is either 0 or the largest error.
        noise = CHANCE * math.hypot(*(x.largest * x.rms / math.sqrt(x.of) for x in (was, now)))
        usual = EQUAL * was.rms if same else math.sqrt(was.rms**2 + noise)
        keys = ("not_finite", *["wrong"] * (now.rms > was.rms + margin and not permitted))
        for key in keys:
            least, most = getattr(was, key) * now.of / was.of, getattr(now, key)
            chance = math.sqrt(least + most) * ((key == "wrong") if same else CHANCE)
            if most > (EQUAL if same else 1.0) * least + chance:
                found.append(Growth(key, least / now.of, most / now.of, now.region))
        if now.rms > usual + margin and not permitted:
            found.append(Growth("rms", was.rms, now.rms, now.region))
        if same and now.largest > SPREAD * was.largest + margin:
            found.append(Growth("largest", was.largest, now.largest, now.region))
    least, most = (each.diagnosis.distance for each in (old, new))
    if new.verdict == FAILED and new.errors[0].rms > old.errors[0].rms and _is_farther(old, new):
        found.append(Growth("best", least, most))
    return tuple(found)


def _is_rounding(old: Result, new: Result) -> bool:
    """Whether rounding of a new driver explains a failure: the rms error is within the tolerance.

    With MaterialX's sheen, the errors of 5 of 6957 samples exceed 2e-5 on llvmpipe, by up to
    1.2e-4. On lavapipe, no error exceeds 2e-5.
    """
    [whole] = new.errors[:1] or [None]
    few = whole and not whole.not_finite and whole.rms <= (new.tolerance or 0.0)
    return bool(few) and old.verdict == PASSED and new.verdict == FAILED


def _is_farther(old: Result, new: Result) -> bool:
    """Whether values are clearly farther from the nearest known model than before."""
    was, now = old.diagnosis.distance, new.diagnosis.distance
    right = next(iter(new.diagnosis.distances.values()), math.inf)
    factor = SPREAD if old.samples == new.samples else DISTANCE
    return SAME * right < now < math.inf and now > factor * was + (new.tolerance or 0.0)


def _is_repaired(old: Result, new: Result) -> bool:
    """Whether a known defect is gone, because the right model is now the nearest model.

    If the samples differ, an error above the size on the defect's page may be due to noise.
    """
    right = next(iter(new.diagnosis.distances.values()), math.inf)
    nearest = old.samples != new.samples or right == new.diagnosis.distance < math.inf
    return nearest and not _is_farther(old, new)


def _version_changes(before: Report, after: Report) -> Iterator[Change]:
    """Changes in the versions of mxeon, packages and hosts."""
    old, new = (
        {"mxeon": each.version}
        | each.software
        | {f"host {host.name}": f"{host.version}, {host.device}" for host in each.hosts}
        for each in (before, after)
    )
    for name in dict.fromkeys((*old, *new)):
        previous, current = old.get(name, "none"), new.get(name, "none")
        if previous != current:
            yield Change(OTHER, "", "", "", name, previous, current)


def _with_error(result: Result) -> str:
    error = result.error
    if result.verdict == NOT_RUN or error is None:
        return result.verdict
    return f"{result.verdict} at {f'{error:.3g}' if math.isfinite(error) else spelled(error)}"
