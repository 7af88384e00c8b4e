# SPDX-License-Identifier: Apache-2.0
"""Known defects from the pages of docs/upstream, and the results that show these defects."""

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
from mxeon.conformance.results import DIFFERS, FAILED, Cause, Kind, Quantity, Result, node_of
from mxeon.io.records import UNREADABLE, strict_converter
from mxeon.shaders.library import data_folder

STOCK, EONLIB = "stock", "eonlib"
RENDERER_NODES = "its own nodes"  # replaces the library in results of a renderer's own nodes
Row = tuple[str, str]  # key of a check, and title of the subject
Table = Mapping[str, Sequence[str]]  # checks by subject
# Hosts that run generated shaders, which MaterialX makes of the same GLSL as for "gl".
GENERATED_GLSL = tuple(row.name for row in hosts.HOSTS if row.way == "pairs" and row.name != "gl")
# A page begins with an optional comment that contains a row of TOML, followed by a title.
PAGE = re.compile(r"(?:<!--\n(?P<row>.*?)\n-->\n)?(?P<text># (?P<title>[^\n]*)\n.*)", re.DOTALL)


@dataclass(frozen=True)
class Issue:
    """A known defect.

    The fields are read from the row of TOML at the beginning of the defect's page, and from
    `measured.json`. In the row, `rows`, `implied` and `repaired` are tables whose keys are
    subjects, separated by `; `, and whose values are lists of checks. The key of a cause in
    `remains` may consist of several keys, separated by `; `.
    """

    page: str  # file name without suffix
    title: str  # heading of the page, which states the defect
    text: str = field(repr=False)  # the page without the row of TOML
    # Section of the index, by default the first word of the page's name; see
    # tools/site/ledger/pages.py.
    group: str
    # Host that shows the defect, by default "gl". Defects of generated shader code have the host
    # "source". Defects that no check shows have the host "".
    host: str = ""
    also: tuple[str, ...] = ()  # other hosts with the defect; "gl" implies all of GENERATED_GLSL
    # Library whose results show the defect: EONLIB for a defect of graphs, because graphs need
    # correct lobes, and RENDERER_NODES for a defect of a renderer's own nodes.
    library: str = STOCK
    unavoidable: bool = False  # whether every library has the defect, which no library can repair
    differs: bool = False  # whether the specification permits the behavior
    rows: tuple[Row, ...] = ()  # results that all fail and that the page's table lists
    # Other results that may fail or differ due to the defect, on hosts with the defect.
    implied: tuple[Row, ...] = ()
    # Results that pass with the patch, by default all of `rows` that are not in `remains`.
    repaired: tuple[Row, ...] = ()
    # Results that, with the patch, either pass or still fail for one of the listed causes.
    remains: Mapping[Row, tuple[Cause, ...]] = field(default_factory=dict, hash=False)
    needs: tuple[str, ...] = ()  # other pages whose patches must also be applied
    kind: str = ""  # kind of patch: "choice", "NaN", "compiles" or "in main after DATE, #PULL"
    pull: int = 0  # number of the pull request that repairs the defect after the release
    cause: Cause | None = None  # first cause in the diagnosis of the first row
    # A file of MaterialX, the text that the patch replaces in the file, and the new text.
    patch: tuple[str, ...] = ()
    # The largest measured error of each result.
    sizes: Mapping[Row, float] = field(default_factory=dict, hash=False)

    @property
    def hosts(self) -> tuple[str, ...]:
        return (self.host, *self.also, *(GENERATED_GLSL if self.host == "gl" else ()))

    @property
    def mended(self) -> set[Row]:
        """Results that the defect does not explain after the patch is applied."""
        return {*self.repaired, *self.remains}


def folder() -> Path:
    """The folder of the pages, either in the installed package or in the checkout."""
    installed = data_folder() / "upstream"
    return installed if installed.is_dir() else data_folder() / "docs" / "upstream"


@cache
def issues() -> Mapping[str, Issue]:
    """All defects by page. The pages are read when a check first fails."""
    measured = json.loads((folder() / "measured.json").read_text("utf-8"))
    pages = sorted(path for path in folder().glob("*.md") if path.stem != "README")
    names = {path.stem: path.read_text("utf-8") for path in pages}
    return {name: read_issue(name, text, measured.get(name, {})) for name, text in names.items()}


def read_issue(page: str, text: str, measured: Mapping[str, object]) -> Issue:
    """The defect of a page, with the page's measurements.

    Raises CheckError if the page does not begin with a row of TOML or a title, or if the row has an
    unknown key.
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
        return replace(issue, repaired=tuple(row for row in issue.rows if row not in issue.remains))
    return issue


@cache
def _converter() -> cattrs.Converter:
    """A converter for the rows of TOML in pages, including tables of checks by subject."""
    converter = strict_converter({})

    def remains(entries: Sequence[dict[str, Any]]) -> dict[Row, tuple[Cause, ...]]:
        causes_of: dict[Row, tuple[Cause, ...]] = {}
        for entry in entries:
            rows, keys = _rows(entry.pop("rows")), entry.pop("key", "").split("; ")
            causes = tuple(converter.structure(entry | {"key": key}, Cause) for key in keys)
            causes_of |= {row: (*causes_of.get(row, ()), *causes) for row in rows}
        return causes_of

    def sizes(table: Mapping[str, Mapping[str, float]]) -> dict[Row, float]:
        return {(check, name): size for check, each in table.items() for name, size in each.items()}

    hooks: dict[object, Callable[..., object]] = {tuple[Row, ...]: _rows}
    hooks |= {Mapping[Row, tuple[Cause, ...]]: remains, Mapping[Row, float]: sizes}
    converter.register_structure_hook_func(
        hooks.__contains__, lambda value, kind: hooks[kind](value)
    )
    return converter


def _rows(table: Table) -> tuple[Row, ...]:
    return tuple(
        (check, subject)
        for names, each in table.items()
        for subject in names.split("; ")
        for check in each
    )


# Hosts that use their own closures with every library.
OWN_CLOSURES = tuple(row.name for row in hosts.HOSTS if row.way == "functions")
REPAIRED = 30.0  # an issue does not explain an error that is this many times smaller
SPREAD = 1.5  # largest ratio of an error to the error that another system measured for the issue


def issues_of(result: Result) -> tuple[Issue, ...]:
    return tuple(issues()[page] for page in result.pages if page in issues())


def blamed(result: Result) -> list[set[str]]:
    """Lobes that make a combination fail, one set per page or cause; [] if a lobe itself fails."""
    if not result.document and _is_lobe(result.subject):
        return []
    if found := issues_of(result):
        rows = [(*each.rows, *each.implied) for each in found]
        return [{subject for _, subject in each if _is_lobe(subject)} for each in rows]
    causes = (each for each in result.diagnosis.causes if each.key == "throughput_of_lobes")
    return [set(each.names) for each in causes]


def _is_lobe(subject: str) -> bool:
    return node_of(subject).endswith("_bsdf")


def with_pages(result: Result, materialx: str = "") -> Result:
    """Returns the result with `pages`, the pages of all known issues that explain the result.

    `materialx` is the folder of the judged MaterialX, or "" for the installed MaterialX. A folder
    has all issues of the library "stock" that the folder's files do not repair.
    """
    if result.verdict not in (FAILED, DIFFERS):
        return replace(result, pages=())
    library = STOCK if materialx else result.library
    explaining = [
        issue
        for issue in issues().values()
        if (library == issue.library or issue.unavoidable or result.host in OWN_CLOSURES)
        and result.host in issue.hosts
        and (result.check, result.subject) in (*issue.rows, *issue.implied)
        and _explains(issue, result, materialx)
    ]
    # Issues on points that the specification leaves open cannot explain a failure on their own.
    if result.verdict == FAILED and all(issue.differs for issue in explaining):
        explaining = []
    return replace(result, pages=tuple(issue.page for issue in explaining))


def _explains(issue: Issue, result: Result, materialx: str) -> bool:
    """Whether an issue explains the error, the diagnosis and the shader code of a result."""
    row = result.check, result.subject
    # An issue with measured errors does not explain a shader that fails to compile.
    if result.error is None and issue.sizes:
        return False
    # Hosts that only render pictures measure relative errors. Relative errors cannot be compared
    # with the sizes of errors in other units.
    if result.host == issue.host or result.quantity is not Quantity.RELATIVE:
        error, size = result.error or 0.0, issue.sizes.get(row, math.inf)
        if error > SPREAD * size:
            return False
        # If the node's own model is nearest and the issue's error is many times larger than the
        # result's, the issue is repaired, and the remaining error has another cause.
        own, *others = result.diagnosis.distances.values() or (math.inf,)
        if own < min(others, default=own) and error < size / REPAIRED:
            return False
    mended = row in issue.mended or issue.mended.issuperset(issue.rows)
    if result.diagnosis.kind is Kind.FAULT or (mended and _is_repaired(issue, materialx)):
        return False
    first = result.host == issue.host and issue.rows[:1] == (row,)
    known = issue.cause if first and result.diagnosis.causes else None
    return not known or result.diagnosis.first.identity == known.identity


@cache
def _is_repaired(issue: Issue, materialx: str) -> bool:
    """Whether MaterialX in a folder, by default the installed MaterialX, has an issue's patch."""
    if not issue.patch:
        return False
    import MaterialX as mx

    name, old, new = issue.patch
    file = Path(materialx or Path(mx.__file__).parent, name)
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    return new in text and old not in text.replace(new, "")
