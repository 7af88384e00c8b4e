# SPDX-License-Identifier: Apache-2.0
"""The type of a known issue, and who may have one."""

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

from mxeon.conformance.results import DIFFERS, FAILED, PASSED, Cause, Kind, Region, Result
from mxeon.conformance.results.quantities import Quantity

STOCK = "stock"
RENDERER_NODES = "its own nodes"  # in the place of a library
Row = tuple[str, str]  # key of a check, and subject


@dataclass(frozen=True)
class Issue:
    """An issue upstream: its page, and the results that show it."""

    page: str  # its name without suffix
    title: str  # its heading, which says what is wrong
    host: str  # the host that shows it; "source" for generated text
    rows: tuple[Row, ...]  # results that all fail
    also: tuple[str, ...] = ()  # other hosts that show it
    implied: tuple[Row, ...] = ()  # other results that fail for it, on those hosts or in the text
    library: str = STOCK  # the library that has it; RENDERER_NODES for a renderer's own nodes
    unavoidable: bool = False  # each library has it: no text can repair it, or none of ours does
    differs: bool = False  # the text leaves the choice
    cause: Cause | None = None  # the first one of the diagnosis of the first of `rows`
    patch: tuple[str, ...] = ()  # a file of MaterialX, and a text of it before and after
    repaired: tuple[Row, ...] = ()  # results that it explains no longer once it is patched
    # The largest errors that were measured.
    sizes: Mapping[Row, float] = field(default_factory=dict, hash=False)


def read_issues() -> tuple[Issue, ...]:
    """The issues of `known_issues.toml` that a check shows, with what `measured.json` says of them."""
    file, plain = Path(__file__), ("title", "host", "library", "unavoidable", "differs")
    found = json.loads(file.with_name("measured.json").read_text("utf-8"))
    text = file.with_name("known_issues.toml").read_text("utf-8")
    return tuple(
        Issue(
            page,
            **{name: entry[name] for name in plain if name in entry},
            rows=_pairs(entry.get("rows", {})),
            also=tuple(entry.get("also", ())),
            implied=_pairs(entry.get("implied", {})),
            repaired=_pairs(entry.get("repaired", {}), *entry.get("remains", {}).values()),
            cause=cause_of(found.get(page, {}).get("cause")),
            patch=tuple(found.get(page, {}).get("patch", ())),
            sizes={
                (check, subject): size
                for check, subjects in found.get(page, {}).get("sizes", {}).items()
                for subject, size in subjects.items()
            },
        )
        for page, entry in tomllib.loads(text).items()
        if "host" in entry
    )


def cause_of(fields: Mapping[str, Any] | None) -> Cause | None:
    """A cause of what `measured.json` has of it, its identity."""
    if not fields:
        return None
    region, names = fields.get("region"), tuple(fields.get("names", ()))
    place = Region(**region | {"channels": tuple(region["channels"])}) if region else None
    kind, key, branch = Kind(fields["kind"]), fields["key"], fields.get("branch", "")
    return Cause(kind, key, names, branch=branch, region=place)


def _pairs(*groups: Mapping[str, Sequence[str]]) -> tuple[Row, ...]:
    """Keys of checks with their subjects."""
    rows = chain.from_iterable(each.items() for each in groups)
    return tuple((check, subject) for check, subjects in rows for subject in subjects)


RENDERERS = {
    "cycles": "this Blender",
    "three": "this three.js",
    "babylon": "this Babylon.js",
    "luxcore": "this LuxCoreRender",
    "three-gpu-pathtracer": "this three-gpu-pathtracer",
}
LEFT = 30.0  # smaller errors of the right model have another cause than the issue
SPREAD = 1.5  # by which engines, drivers and versions of MaterialX may exceed an issue's size
ISSUES = read_issues()


def issues_of(result: Result) -> tuple[Issue, ...]:
    """The known issues on whose pages the defects are that a result shows."""
    return tuple({issue.page: issue for issue in ISSUES if issue.page in result.pages}.values())


def with_pages(result: Result, materialx: str = "") -> Result:
    """A result with the pages of the issues that explain it, if any do.

    `materialx` is the folder whose `libraries` were judged instead of the installed ones: a copy of
    MaterialX's has the issues of stock, but for those that it repairs.
    """
    if result.verdict not in (FAILED, DIFFERS):
        return replace(result, pages=())
    library = STOCK if materialx else result.library
    found = [
        issue
        for issue in ISSUES
        if (library == issue.library or issue.unavoidable)
        and result.host in (issue.host, *issue.also)
        and (result.check, result.subject) in (*issue.rows, *issue.implied)
        and _explains(issue, result, materialx)
    ]
    # What the text leaves open explains no failure by itself.
    left_open = result.verdict == FAILED and all(issue.differs for issue in found)
    return replace(result, pages=() if left_open else tuple(issue.page for issue in found))


def repaired(results: Sequence[Result], software: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Notes on issues that are repaired, all of whose rows pass: a text and a page for each."""
    verdicts = {
        (result.library, result.host, result.check, result.subject): result.verdict
        for result in results
    }
    notes = []
    for issue in ISSUES:
        found = [verdicts.get((issue.library, issue.host, *row)) for row in issue.rows]
        if {*found} == {PASSED}:
            own = RENDERERS.get(issue.host)
            if not own or issue.page.startswith("gen"):  # the name of a generator of MaterialX
                own = f"MaterialX {software['MaterialX']}"
            page = f"docs/upstream/{issue.page}.md"
            notes.append((f"repaired in {own}, so that its page can go", page))
    return tuple(notes)


def _explains(issue: Issue, result: Result, materialx: str) -> bool:
    """Whether an issue explains what was measured, by its size, its diagnosis and its text."""
    row = result.check, result.subject
    # Hosts that show pictures alone measure relative errors, which have no size in another unit.
    sized = result.host == issue.host or result.quantity is not Quantity.RELATIVE
    if result.error is None and issue.sizes:  # as of a shader that does not compile
        return False
    size = issue.sizes.get(row, math.inf)
    if sized and (result.error or 0.0) > SPREAD * size:
        return False
    # Where the node's own model is nearest, a defect many times as large is mended; what is left has another cause.
    own, *others = result.diagnosis.distances.values() or (math.inf,)
    if sized and own < min(others, default=own) and (result.error or 0.0) < size / LEFT:
        return False
    gone = row in issue.repaired or set(issue.rows) <= set(issue.repaired)
    if result.diagnosis.kind is Kind.FAULT or (gone and _is_repaired(issue, materialx)):
        return False
    first = result.host == issue.host and issue.rows[:1] == (row,)
    known = issue.cause if first and result.diagnosis.causes else None
    return not known or result.diagnosis.first.identity == known.identity


@cache
def _is_repaired(issue: Issue, materialx: str) -> bool:
    """Whether MaterialX, the installed one if no folder is named, has the patch of an issue."""
    if not issue.patch:
        return False
    import MaterialX as mx

    name, old, new = issue.patch
    file = Path(materialx or Path(mx.__file__).parent, name)
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    return new in text and old not in text.replace(new, "")
