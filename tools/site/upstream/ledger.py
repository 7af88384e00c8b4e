# SPDX-License-Identifier: Apache-2.0
"""The rows of the ledger: each page says at its end, in a comment, what shows its defect.

    <!-- ledger
    group = "sheen_bsdf"                    # of the index, README.md
    host = "gl"                             # that shows it; no host if no check does
    also = ["webgl", "vulkan"]              # other hosts that show it
    library = "stock"                       # that has it; "its own nodes" of a renderer
    unavoidable = true                      # where each library has it, since none of ours repairs it
    differs = true                          # where the text leaves the choice
    pull = 2961                             # pull request that repairs it after the release
    [rows]                                  # check = subjects: the results of the page's table, if it
                                            # is one of checks; all of them fail
    value = ["sheen_bsdf, mode zeltner"]
    [implied]                               # other results that fail for it, or may
    [repaired]                              # results that pass with the repairs of materialx_repairs.py
    [remains."DIAGNOSIS"]                   # results that pass with them, or are diagnosed so: for
                                            # another cause
    [patch]                                 # for the upstream repository: patches.py tells its keys
    -->

From these come the index, the navigation of the site, and `results/known_issues/issues.json` of the suite.
"""

import json
import re
import tomllib
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from textwrap import fill

from tools.site.upstream.marks import kinds
from tools.site.upstream.materialx_repairs import REPAIRS

FOLDER = Path(__file__).parents[3] / "docs" / "upstream"
INDEX, NAVIGATION = FOLDER / "README.md", FOLDER.parents[1] / "mkdocs.yml"
ISSUES = FOLDER.parents[1] / "python/mxeon/conformance/results/known_issues/issues.json"
# Errors that were measured, by host: tools/site/specification.py writes them.
SPECIFICATION = FOLDER.parent / "specification.json"
TABLE_ROW = re.compile(
    r"^\| (\w+) \| ([^|]+) \| (inf|[-+.e\d]+) \| [^|]+ \| [^|]+ \|$", re.MULTILINE
)
SAYS = re.compile(r"^The suite says: (.*)\.$", re.MULTILINE)
ROW = re.compile(r"<!-- ledger\n(.*?)-->\n", re.DOTALL)
GROUP = re.compile(r"<!-- pages (\w+) -->\n.*?<!-- end -->\n", re.DOTALL)
PAGES = re.compile(r"(?: {10}- upstream/\w+\.md\n)+")
KEYS = {
    "group",
    "host",
    "also",
    "library",
    "unavoidable",
    "differs",
    "rows",
    "implied",
    "repaired",
    "remains",
    "patch",
    "pull",
}


@dataclass(frozen=True)
class Patch:
    """What the patch of a page has beside the page's text: `patches.py` tells the fields."""

    subject: str
    change: str
    needs: list[str] = field(default_factory=list)
    kind: str = ""


@dataclass(frozen=True)
class Row:
    """The row of a page.

    Attributes
    ----------
    page, title : str
        Its name without suffix, and its heading.
    group : str
        Part of the index.
    differs : bool
        Whether the verdict is *differs*.
    issue : dict
        The fields of `mxeon.conformance.results.known_issues.issue.Issue`; empty if no check shows it.
    repaired : list of (str, str)
        Results that pass with the repairs.
    remains : dict of str to list of (str, str)
        Results that pass with them, or whose diagnosis begins so.
    patch : Patch or None
    pull : int
        Pull request of the upstream that repairs it after the release; 0 for none.
    """

    page: str
    title: str
    group: str
    differs: bool
    issue: dict[str, object]
    repaired: list[tuple[str, str]]
    remains: dict[str, list[tuple[str, str]]]
    patch: Patch | None = None
    pull: int = 0


def rows(folder=FOLDER):
    """The rows of all pages of a folder, by name of page.

    Raises
    ------
    ValueError
        If a page has no row, or a key of it is unknown.
    """
    return [_row(path) for path in sorted(folder.glob("*.md")) if path.name != INDEX.name]


def _row(path):
    text = path.read_text(encoding="utf-8")
    found = ROW.search(text)
    if not found:
        raise ValueError(f"{path.name} must have a comment <!-- ledger with its row")
    table = tomllib.loads(found[1])
    if unknown := table.keys() - KEYS:
        raise ValueError(
            f"keys of {path.name} must be some of {sorted(KEYS)}; got {sorted(unknown)}"
        )
    title = text.split("\n", 1)[0].removeprefix("# ")
    issue = {}
    if "host" in table:
        issue = {
            "page": path.stem,
            "title": title,
            "host": table["host"],
            "rows": _pairs(table.get("rows", {})),
            "also": table.get("also", []),
            "implied": _pairs(table.get("implied", {})),
            "library": table.get("library", "stock"),
            "unavoidable": table.get("unavoidable", False),
            "says": (SAYS.findall(text) or [""])[0],
            "patch": _text_of_patch(path.stem),
            "repaired": [
                pair
                for each in (table.get("repaired", {}), *table.get("remains", {}).values())
                for pair in _pairs(each)
            ],
        }
        issue["sizes"] = _sizes(issue, text)
    return Row(
        path.stem,
        title,
        table["group"],
        table.get("differs", False),
        issue,
        _pairs(table.get("repaired", {})),
        {words: _pairs(each) for words, each in table.get("remains", {}).items()},
        Patch(**table["patch"]) if "patch" in table else None,
        table.get("pull", 0),
    )


def _pairs(table):
    return [(check, subject) for check, subjects in table.items() for subject in subjects]


def _text_of_patch(page):
    """The shortest change by the patch of a page: file, and text before and after; () for no patch."""
    changes = [
        (each.file, each.old, each.new) for each in REPAIRS if each.page == page and each.new
    ]
    return min(changes, key=lambda change: sum(map(len, change)), default=())


def _sizes(issue, text):
    """The largest error measured of each result of an issue, in its order; None where there is none."""
    sizes = {}
    found = [(check, subject, float(error)) for check, subject, error in TABLE_ROW.findall(text)]
    for host in (issue["host"], *issue["also"]):
        for each in _specification().get(host, ()):
            found.append((each["check"], each["subject"], float(each["error"])))
    for *row, size in found:
        sizes[tuple(row)] = max(size, sizes.get(tuple(row), 0.0))
    return [sizes.get(row) for row in (*issue["rows"], *issue["implied"])]


@cache
def _specification():
    """Results of stock MaterialX that have an error, by host."""
    hosts = json.loads(SPECIFICATION.read_text(encoding="utf-8"))
    return {
        host: [each for each in found["results"] if each["library"] == "stock" and each["error"]]
        for host, found in hosts.items()
    }


def issues_text(ledger):
    """The text of issues.json, a line for each issue."""
    lines = ",\n".join(json.dumps(row.issue) for row in ledger if row.issue)
    return f"[\n{lines}\n]\n"


def index_text(text, ledger):
    """The index with the pages of each group.

    Raises
    ------
    ValueError
        If a page's group is none of the index; lists those.
    """
    groups = GROUP.findall(text)
    for row in ledger:
        if row.group not in groups:
            raise ValueError(
                f"group of {row.page} must be one of {', '.join(groups)}; got {row.group}"
            )

    def filled(found):
        lines = [
            f"- [{row.title}]({row.page}.md){' (*differs*)' if row.differs else ''}\n"
            for row in ledger
            if row.group == found[1]
        ]
        return f"<!-- pages {found[1]} -->\n{''.join(lines)}<!-- end -->\n"

    return GROUP.sub(filled, text)


def counts_text(text, texts):
    """The index with the number of marks of each kind on the pages with these texts."""
    count = sum((kinds(each) for each in texts), Counter())
    words = (
        f"{count['measured']} are figures that a function measures, {count['row']} those of a page's table, "
        f"{count['at']} lines that are found by their text, {count['command']} printed by a named command; "
        f"{count['recorded']} are records; {count['text'] + count['source']} stand in printed texts and "
        f"sources, and {count['given']} are chosen."
    )
    begin, end = "<!-- marks -->\n", "<!-- end -->\n"
    head, rest = text.split(begin)
    return (
        f"{head}{begin}Of the numbers with a mark\n{fill(words, 110)}\n{end}{rest.split(end, 1)[1]}"
    )


def navigation_text(text, index):
    """The site's navigation with the pages in the order of the index."""
    pages = ["README", *re.findall(r"^- \[.*\]\((\w+)\.md\)", index, re.MULTILINE)]
    return PAGES.sub("".join(f"{10 * ' '}- upstream/{page}.md\n" for page in pages), text)


def generated(folder=FOLDER, index=INDEX, navigation=NAVIGATION, issues=ISSUES):
    """The text of each file that comes from the rows, by path."""
    ledger = rows(folder)
    texts = [(folder / f"{row.page}.md").read_text(encoding="utf-8") for row in ledger]
    listed = counts_text(index_text(index.read_text(encoding="utf-8"), ledger), texts)
    text = navigation_text(navigation.read_text(encoding="utf-8"), listed)
    return {index: listed, navigation: text, issues: issues_text(ledger)}
