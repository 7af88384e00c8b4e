# SPDX-License-Identifier: Apache-2.0
"""The rows of the ledger: each page says at its end, in a comment, what shows its defect.

    <!-- ledger
    group = "sheen_bsdf"                    # of the index, README.md
    host = "gl"                             # that shows it; no host if no check does
    also = ["webgl", "vulkan"]              # other hosts that show it
    library = "stock"                       # that has it; "its own nodes" of a renderer
    differs = true                          # where the text leaves the choice
    [rows]                                  # check = subjects: the results of the page's table, if it
                                            # is one of checks; all of them fail
    value = ["sheen_bsdf, mode zeltner"]
    [implied]                               # other results that fail for it, or may
    [repaired]                              # results that pass with the repairs of materialx_repairs.py
    -->

From these come the index, the navigation of the site, and `known_issues/issues.json` of the package.
"""

import json
import re
import tomllib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill

from docs.upstream.marks import kinds

FOLDER = Path(__file__).parent
INDEX, NAVIGATION = FOLDER / "README.md", FOLDER.parents[1] / "mkdocs.yml"
ISSUES = FOLDER.parents[1] / "python/mxeon/conformance/known_issues/issues.json"
ROW = re.compile(r"<!-- ledger\n(.*?)-->\n", re.DOTALL)
GROUP = re.compile(r"<!-- pages (\w+) -->\n.*?<!-- end -->\n", re.DOTALL)
PAGES = re.compile(r"(?: {10}- upstream/\w+\.md\n)+")
KEYS = {"group", "host", "also", "library", "differs", "rows", "implied", "repaired"}


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
        The fields of `mxeon.conformance.known_issues.issue.Issue`; empty if no check shows it.
    repaired : list of (str, str)
        Results that pass with the repairs.
    """

    page: str
    title: str
    group: str
    differs: bool
    issue: dict[str, object]
    repaired: list[tuple[str, str]]


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
        }
    repaired = _pairs(table.get("repaired", {}))
    return Row(path.stem, title, table["group"], table.get("differs", False), issue, repaired)


def _pairs(table):
    return [(check, subject) for check, subjects in table.items() for subject in subjects]


def issues_text(ledger):
    """The text of issues.json."""
    return json.dumps([row.issue for row in ledger if row.issue], indent=1) + "\n"


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
