# SPDX-License-Identifier: Apache-2.0
"""Two runs compared: what got worse, what got better, and what else is not the same."""

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from mxeon.report import JSON_FORMAT
from mxeon.results import FAILED, NOT_RUN, PASSED

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


def read_results(folder):
    """What `mxeon check --report` wrote as results.json.

    Parameters
    ----------
    folder : path-like
        Of the report, or the file itself.

    Returns
    -------
    dict
        See `mxeon.report.to_json`.

    Raises
    ------
    ValueError
        If there is none, or it is not of this format.
    """
    path = Path(folder) / "results.json" if Path(folder).is_dir() else Path(folder)
    if not path.is_file():  # a pipe may have no end
        raise ValueError(f"{path}: must be the results.json of a report; there is no such file")
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        written = found["format"]
        if written == JSON_FORMAT:
            compare(found, found)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        reason = f"it lacks {error}" if isinstance(error, KeyError) else error
        raise ValueError(f"{path}: must be the results.json of a report; {reason}") from None
    if written != JSON_FORMAT:
        raise ValueError(f"{path}: format must be {JSON_FORMAT}; got {written!r}: make it anew")
    return found


def compare(before, after):
    """Changes from one run to another, the worse ones first.

    Parameters
    ----------
    before, after : dict
        See `read_results`.

    Returns
    -------
    tuple of Change
    """
    changes = [
        *_results(_by(PLACE, before["results"]), _by(PLACE, after["results"])),
        *_pictures(_by(SHOWN, before["pictures"]), _by(SHOWN, after["pictures"])),
        *_facts(_identities(before), _identities(after)),
    ]
    return tuple(sorted(changes, key=lambda change: (WORSE, BETTER, OTHER).index(change.kind)))


def _by(names, records):
    """Records by the values of some names; those that share them are numbered."""
    found, seen = {}, Counter()
    for record in records:
        key = tuple(record[name] for name in names)
        seen[key] += 1
        found[key if seen[key] == 1 else (*key, f"number {seen[key]}")] = record
    return found


def _results(before, after):
    for key in before | after:
        place, old, new = ", ".join(key), before.get(key), after.get(key)
        if old is None:
            yield Change(OTHER, place, "none", new["verdict"])
        elif new is None:
            yield Change(WORSE, place, old["verdict"], "none")
        elif old["verdict"] != new["verdict"]:
            worse = ORDER.index(new["verdict"]) > ORDER.index(old["verdict"])
            yield Change(WORSE if worse else BETTER, place, _told(old), _told(new))
        elif _apart(old["figure"], new["figure"]):
            yield Change(OTHER, place, _told(old), _told(new))


def _pictures(before, after):
    for key in before.keys() & after.keys():
        old, new = (run[key]["largest_difference"] for run in (before, after))
        if _apart(old, new):
            place = f"{', '.join(key)}, largest difference"
            yield Change(OTHER, place, _number(old), _number(new))


def _facts(before, after):
    for name in before | after:
        old, new = before.get(name, "none"), after.get(name, "none")
        if old != new:
            yield Change(OTHER, name, old, new)


def _identities(run):
    hosts = {f"host {each['name']}": f"{each['version']}, {each['device']}" for each in run["hosts"]}
    return {"mxeon": run["version"]} | run["software"] | hosts


def _apart(old, new):
    """Whether two figures differ by more than FACTOR; those that are no numbers, at all."""
    if None in (old, new) or isinstance(old, str) or isinstance(new, str):
        return old != new
    small, large = sorted((abs(old), abs(new)))
    return large > FACTOR * small


def _told(result):
    figure = result["figure"]
    return result["verdict"] + ("" if figure is None else f" at {_number(figure)}")


def _number(value):
    return f"{value:.3g}" if isinstance(value, float | int) else str(value)
