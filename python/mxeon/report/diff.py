# SPDX-License-Identifier: Apache-2.0
"""Two runs compared: what got worse, what got better, and what else is not the same."""

import json
import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mxeon.conformance.records import ERRORS, read_record, spelled
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, VERDICTS, Result
from mxeon.errors import InputError
from mxeon.io.files import regular
from mxeon.report import JSON_FORMAT
from mxeon.shaders.hosts.base import Identity

FACTOR = 2.0  # by which a figure has to change to be told
ORDER = (PASSED, NOT_RUN, FAILED)
WORSE, BETTER, OTHER = "worse", "better", "other"
PLACE = ("host", "library", "check", "subject")
SHOWN = ("host", "library", "document", "element", "scene")


@dataclass(frozen=True)
class Change:
    """One thing that is not as it was.

    Attributes
    ----------
    kind : str
        WORSE, BETTER or OTHER; a verdict or a check that went is worse, a figure alone is not.
    place : str
        What changed, and where.
    before, after : str
        "none" where there is none.
    """

    kind: str
    place: str
    before: str
    after: str

    def __str__(self):
        return f"{self.kind}: {self.place}: {self.before} -> {self.after}"


@dataclass(frozen=True)
class ShownPicture:
    """A picture of a report, by its files; see `mxeon.report.to_json`."""

    document: str
    element: str
    host: str
    library: str
    scene: str
    exr: str
    png: str
    largest_difference: float | None

    def __post_init__(self):
        if (self.largest_difference or 0.0) < 0.0:
            raise InputError(
                f"largest_difference must be at least 0; got {self.largest_difference}"
            )


@dataclass(frozen=True)
class Report:
    """What results.json holds; see `mxeon.report.to_json`."""

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

    def __post_init__(self):
        if self.verdict not in VERDICTS:
            raise InputError(f"verdict must be one of {', '.join(VERDICTS)}; got {self.verdict!r}")
        tally = Counter(result.verdict for result in self.results)
        if self.counts != {verdict: tally[verdict] for verdict in VERDICTS}:
            raise InputError(f"counts must be those of the results; got {self.counts}")


def read_results(folder):
    """What `mxeon check --report` wrote as results.json.

    Parameters
    ----------
    folder : path-like
        Of the report, or the file itself.

    Returns
    -------
    Report

    Raises
    ------
    ValueError
        If there is none, or it is not of this format; names the first value that is wrong.
    """
    path = Path(folder) / "results.json" if Path(folder).is_dir() else Path(folder)
    rule = f"{path}: must be the results.json of a report"
    try:
        with open(path, encoding="utf-8", opener=regular) as file:
            content = json.load(file)
        if (written := content["format"]) == JSON_FORMAT:
            return read_record(content, Report)
    except OSError as error:
        raise InputError(f"{rule}; {error.strerror}") from None
    except ERRORS as error:
        reason = f"lacks {error}" if isinstance(error, KeyError) else error
        raise InputError(f"{rule}; {reason}") from None
    raise InputError(f"{path}: format must be {JSON_FORMAT}; got {written!r}: make it anew")


def compare(before, after):
    """Changes from one run to another, the worse ones first.

    Parameters
    ----------
    before, after : Report

    Returns
    -------
    tuple of Change
    """
    changes = [
        *_results(_by(PLACE, before.results), _by(PLACE, after.results)),
        *_pictures(_by(SHOWN, before.pictures), _by(SHOWN, after.pictures)),
        *_facts(_identities(before), _identities(after)),
    ]
    return tuple(sorted(changes, key=lambda change: (WORSE, BETTER, OTHER).index(change.kind)))


def _by(names, records):
    """Records by the values of some names; those that share them are numbered."""
    found, seen = {}, Counter()
    for record in records:
        key = tuple(getattr(record, name) for name in names)
        seen[key] += 1
        found[key if seen[key] == 1 else (*key, f"number {seen[key]}")] = record
    return found


def _results(before, after):
    for key in before | after:
        place, old, new = ", ".join(key), before.get(key), after.get(key)
        if old is None:
            yield Change(OTHER, place, "none", new.verdict)
        elif new is None:
            yield Change(WORSE, place, old.verdict, "none")
        elif old.verdict != new.verdict:
            worse = ORDER.index(new.verdict) > ORDER.index(old.verdict)
            yield Change(WORSE if worse else BETTER, place, _told(old), _told(new))
        elif _apart(old.error, new.error):
            yield Change(OTHER, place, _told(old), _told(new))


def _pictures(before, after):
    for key in before.keys() & after.keys():
        old, new = (run[key].largest_difference for run in (before, after))
        if _apart(old, new):
            place = f"{', '.join(key)}, largest difference"
            yield Change(OTHER, place, _number(old), _number(new))


def _facts(before, after):
    for name in before | after:
        old, new = before.get(name, "none"), after.get(name, "none")
        if old != new:
            yield Change(OTHER, name, old, new)


def _identities(run):
    hosts = {f"host {each.name}": f"{each.version}, {each.device}" for each in run.hosts}
    return {"mxeon": run.version} | run.software | hosts


def _apart(old, new):
    """Whether two figures differ by more than FACTOR; those that are no finite numbers, at all."""
    if None in (old, new) or not (math.isfinite(old) and math.isfinite(new)):
        return _number(old) != _number(new)
    small, large = sorted((old, new))
    return large > FACTOR * small


def _told(result):
    return result.verdict + ("" if result.error is None else f" at {_number(result.error)}")


def _number(value):
    if value is None or not math.isfinite(value):
        return "none" if value is None else spelled(value)
    return f"{value:.3g}"
