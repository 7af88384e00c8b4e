# SPDX-License-Identifier: Apache-2.0
"""Known defects: the row at the head of each page of the ledger, and the results that it explains."""

import json
import math
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import cattrs

from mxeon import errors, hosts
from mxeon.conformance.results import DIFFERS, FAILED, Cause, Kind, Quantity, Result
from mxeon.io.records import UNREADABLE, strict_converter
from mxeon.shaders.library import data_folder

STOCK, EONLIB = "stock", "eonlib"
RENDERER_NODES = "its own nodes"  # replaces the library
Row = tuple[str, str]  # key of a check, and subject
Table = Mapping[str, Sequence[str]]  # the checks of subjects
GENERATED_GLSL = ("webgl", "vulkan", "wgsl", "slang")  # hosts that draw the same GLSL as "gl"
# A page begins with its row as TOML in a comment, unless that is empty, then its title.
PAGE = re.compile(r"(?:<!--\n(?P<row>.*?)\n-->\n)?(?P<text># (?P<title>[^\n]*)\n.*)", re.DOTALL)


@dataclass(frozen=True)
class Issue:
    """A defect: the row of its page, whose keys are these fields, and its measurements in
    `measured.json`.

    In a page, `rows`, `implied` and `repaired` are tables: a subject, or several with `; ` between
    them, and their checks. So may the key of a cause in `remains` be several.
    """

    page: str  # the file without suffix
    title: str  # the heading, which states the defect
    text: str = field(repr=False)  # the page without the row
    group: (
        str  # a part of the index, see tools/site/ledger/pages.py; by default the name's first word
    )
    host: str = ""  # the host that shows it, by default "gl"; "source" for generated text; "" if no check does
    also: tuple[str, ...] = ()  # additional hosts that show it, besides GENERATED_GLSL for "gl"
    # The library whose results show it: EONLIB for graphs, which need correct lobes;
    # RENDERER_NODES.
    library: str = STOCK
    unavoidable: bool = False  # every library has it: no text, or none of ours, can repair it
    differs: bool = False  # the specification permits both
    rows: tuple[Row, ...] = ()  # results that all fail: the page's table
    # Other results that fail or differ, or may, because of it on those hosts.
    implied: tuple[Row, ...] = ()
    # Results that pass with its patch: by default `rows`, except for `remains`.
    repaired: tuple[Row, ...] = ()
    # Results that pass with its patch, or still fail for one of these causes.
    remains: Mapping[Row, tuple[Cause, ...]] = field(default_factory=dict, hash=False)
    needs: tuple[str, ...] = ()  # pages whose patches are required for that
    kind: str = ""  # kind of the patch: "choice", "NaN" or "compiles"
    pull: int = 0  # the pull request that repairs it after the release
    cause: Cause | None = None  # first cause in the diagnosis of the first of `rows`
    patch: tuple[str, ...] = ()  # a file of MaterialX, with a text before and after the patch
    # The largest measured errors.
    sizes: Mapping[Row, float] = field(default_factory=dict, hash=False)

    @property
    def hosts(self) -> tuple[str, ...]:
        """The hosts that show it."""
        return (self.host, *self.also, *(GENERATED_GLSL if self.host == "gl" else ()))

    @property
    def mended(self) -> set[Row]:
        """Results that the defect no longer explains after its patch."""
        return {*self.repaired, *self.remains}


def folder() -> Path:
    """The folder of the pages: inside an installed package, else in the checkout."""
    installed = data_folder() / "upstream"
    return installed if installed.is_dir() else data_folder() / "docs" / "upstream"


@cache
def issues() -> Mapping[str, Issue]:
    """The defects by page, read at the first failure."""
    measured = json.loads((folder() / "measured.json").read_text("utf-8"))
    pages = sorted(path for path in folder().glob("*.md") if path.stem != "README")
    names = {path.stem: path.read_text("utf-8") for path in pages}
    return {name: read_issue(name, text, measured.get(name, {})) for name, text in names.items()}


def read_issue(page: str, text: str, measured: Mapping[str, object]) -> Issue:
    """The defect of a page, with its measurements.

    Raises CheckError if the page does not begin with a row or a title, or the row has an unknown key.
    """
    parts = PAGE.fullmatch(text)
    if not parts:
        raise errors.CheckError(f"{page}.md must begin with a row in a comment, or a title")
    head = {"page": page, "title": parts["title"], "text": parts["text"]}
    row = {"group": page.partition("_")[0]} | tomllib.loads(parts["row"] or "") | head
    row |= {name: measured[name] for name in ("cause", "patch", "sizes") if name in measured}
    if row.keys() & {"rows", "implied"}:
        row.setdefault("host", "gl")
    try:
        issue = _converter().structure(row, Issue)
    except UNREADABLE as error:
        raise errors.CheckError(f"row of {page}.md: {cattrs.transform_error(error)[0]}") from error
    if issue.patch and not issue.repaired:
        repaired = tuple(pair for pair in issue.rows if pair not in issue.remains)
        return replace(issue, repaired=repaired)
    return issue


@cache
def _converter() -> cattrs.Converter:
    """A converter that reads rows, whose tables give the checks of each subject."""
    converter = strict_converter({})

    def remains(entries: Sequence[dict[str, Any]]) -> dict[Row, tuple[Cause, ...]]:
        found: dict[Row, tuple[Cause, ...]] = {}
        for entry in entries:
            pairs, keys = _pairs(entry.pop("rows")), entry.pop("key", "").split("; ")
            causes = tuple(converter.structure(entry | {"key": key}, Cause) for key in keys)
            found |= {pair: (*found.get(pair, ()), *causes) for pair in pairs}
        return found

    def sizes(table: Mapping[str, Mapping[str, float]]) -> dict[Row, float]:
        return {(check, name): size for check, each in table.items() for name, size in each.items()}

    hooks: dict[object, Callable[..., object]] = {tuple[Row, ...]: _pairs}
    hooks |= {Mapping[Row, tuple[Cause, ...]]: remains, Mapping[Row, float]: sizes}
    converter.register_structure_hook_func(
        hooks.__contains__, lambda value, kind: hooks[kind](value)
    )
    return converter


def _pairs(table: Table) -> tuple[Row, ...]:
    return tuple(
        (check, subject)
        for names, each in table.items()
        for subject in names.split("; ")
        for check in each
    )


# Hosts whose closures are their own, with every library.
OWN_CLOSURES = tuple(row.name for row in hosts.HOSTS if row.way == "functions")
LEFT = 30.0  # smaller errors of the correct model have a different cause than the issue
SPREAD = 1.5  # engines, drivers and versions of MaterialX may exceed an issue's size by this factor


def issues_of(result: Result) -> tuple[Issue, ...]:
    """The known issues that explain a result."""
    return tuple(issues()[page] for page in result.pages if page in issues())


def blamed(result: Result) -> list[set[str]]:
    """Lobes that make a combination of lobes fail, a set for each page or cause; () for a lobe's own failure."""
    if _is_lobe(result.subject):
        return []
    if pages := issues_of(result):
        rows = [(*each.rows, *each.implied) for each in pages]
        return [{subject for _, subject in each if _is_lobe(subject)} for each in rows]
    causes = (each for each in result.diagnosis.causes if each.key == "throughput_of_lobes")
    return [set(each.names) for each in causes]


def _is_lobe(subject: str) -> bool:
    return subject.partition(",")[0].endswith("_bsdf")


def with_pages(result: Result, materialx: str = "") -> Result:
    """A result with the pages of the issues that explain it, if any.

    `materialx` is the folder whose `libraries` were judged instead of the installed ones: a copy of
    MaterialX's libraries has the issues of stock, except those that it repairs.
    """
    if result.verdict not in (FAILED, DIFFERS):
        return replace(result, pages=())
    library = STOCK if materialx else result.library
    found = [
        issue
        for issue in issues().values()
        if (library == issue.library or issue.unavoidable or result.host in OWN_CLOSURES)
        and result.host in issue.hosts
        and (result.check, result.subject) in (*issue.rows, *issue.implied)
        and _explains(issue, result, materialx)
    ]
    # Points that the text leaves open explain no failure by themselves.
    left_open = result.verdict == FAILED and all(issue.differs for issue in found)
    return replace(result, pages=() if left_open else tuple(issue.page for issue in found))


def _explains(issue: Issue, result: Result, materialx: str) -> bool:
    """Whether an issue explains a measurement, by its size, its diagnosis and its text."""
    row = result.check, result.subject
    # Hosts that only render pictures measure relative errors, which cannot be compared with a size
    # in another unit.
    sized = result.host == issue.host or result.quantity is not Quantity.RELATIVE
    if result.error is None and issue.sizes:  # the shader does not compile, for example
        return False
    size = issue.sizes.get(row, math.inf)
    if sized and (result.error or 0.0) > SPREAD * size:
        return False
    # If the node's own model is nearest and the defect is many times larger, it is repaired; the
    # remaining error has another cause.
    own, *others = result.diagnosis.distances.values() or (math.inf,)
    if sized and own < min(others, default=own) and (result.error or 0.0) < size / LEFT:
        return False
    gone = row in issue.mended or issue.mended.issuperset(issue.rows)
    if result.diagnosis.kind is Kind.FAULT or (gone and _is_repaired(issue, materialx)):
        return False
    first = result.host == issue.host and issue.rows[:1] == (row,)
    known = issue.cause if first and result.diagnosis.causes else None
    return not known or result.diagnosis.first.identity == known.identity


@cache
def _is_repaired(issue: Issue, materialx: str) -> bool:
    """Whether a MaterialX (by default the installed one) has the patch of an issue."""
    if not issue.patch:
        return False
    import MaterialX as mx

    name, old, new = issue.patch
    file = Path(materialx or Path(mx.__file__).parent, name)
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    return new in text and old not in text.replace(new, "")
