# SPDX-License-Identifier: Apache-2.0
"""Patches for upstream repositories: `python -m tools.site.upstream.patches` writes them to `patches/`.

Each comes from the changes that the tests apply (`materialx_repairs.py`, `repairs.py`) and from its page,
whose row says in `[patch]` what no other part of the page says:

    [patch]
    subject = "Fix ..."           # of the commit
    change = "Take ..."           # what it does
    needs = ["another_page"]      # pages of the patches without which its checks still fail, if any
    kind = "choice"               # "choice": a text leaves it open; "NaN": no other value changes; "compiles"
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import unified_diff
from hashlib import sha1
from io import StringIO
from pathlib import Path
from textwrap import fill

from mxeon.errors import NotRun
from mxeon.io.files import write_text
from tools.site.upstream.ledger import FOLDER, INDEX, Patch, Row, rows
from tools.site.upstream.marks import MODULES
from tools.site.upstream.materialx_repairs import REPAIRS, installed
from tools.site.upstream.repairs import (
    CYCLES_REPAIRS,
    PATHTRACER,
    PATHTRACER_REPAIRS,
    THREE,
    THREE_REPAIRS,
    Repair,
    kernel,
)

PATCHES = Path(__file__).parents[3] / "patches"
BEGIN, END = "<!-- measured -->\n", "<!-- end -->\n"
AUTHOR = "mxeon maintainers <maintainers@mxeon.invalid>"
WIDTH = 72


@dataclass(frozen=True)
class Project:
    """An upstream project that patches are for.

    Attributes
    ----------
    name : str
        Of it, and of its folder in `patches/`.
    root : callable () -> Path
        Folder of the texts that are changed, as the release has them; raises NotRun if there is none.
    changes : sequence of Repair
    path : callable (str) -> str
        Path of a file in the project's repository.
    """

    name: str
    root: Callable[[], Path]
    changes: Sequence[Repair]
    path: Callable[[str], str] = str


def _modules(package: str) -> Callable[[], Path]:
    def folder() -> Path:
        if not (MODULES / package).is_dir():
            raise NotRun(f"no folder {MODULES / package}")
        return MODULES / package

    return folder


PROJECTS = (
    Project("materialx", installed, REPAIRS),
    Project(  # whose graph of a surface is MaterialX's
        "openpbr",
        installed,
        tuple(each for each in REPAIRS if each.page.startswith("openpbr")),
        lambda file: f"reference/{Path(file).name}",
    ),
    Project("three.js", _modules(THREE), THREE_REPAIRS),
    Project("three-gpu-pathtracer", _modules(PATHTRACER), PATHTRACER_REPAIRS),
    Project("blender", kernel, CYCLES_REPAIRS, lambda file: f"intern/cycles/kernel/{file}"),
)


def topics(project: Project) -> dict[str, list[Repair]]:
    """The changes of a project, by page, in the order of the patches."""
    found: dict[str, list[Repair]] = {}
    for change in project.changes:
        found.setdefault(change.page, []).append(change)
    return found


def changed(text: str, changes: Sequence[Repair]) -> str:
    """A text with changes.

    Raises
    ------
    ValueError
        If it does not hold the old text of one.
    """
    for change in changes:
        if change.old not in text:
            raise ValueError(f"{change.file} must hold {change.old!r}")
        text = text.replace(change.old, change.new)
    return text


def patches(project: Project) -> dict[str, str]:
    """The patches of a project, each on top of those before it: texts by name of file."""
    ledger = {row.page: row for row in rows()}
    texts: dict[str, str] = {}
    made = {}
    for number, (page, changes) in enumerate(topics(project).items(), 1):
        # Change the files of this topic.
        diffs = []
        for file in dict.fromkeys(each.file for each in changes):
            old = texts.get(file) or (project.root() / file).read_bytes().decode()
            texts[file] = changed(old, [each for each in changes if each.file == file])
            diffs.append(diff(project.path(file), old, texts[file]))
        # Write it as a commit in a mailbox.
        name = f"{number:04}-{_hyphenated(_patch(ledger[page]).subject)}.patch"
        made[name] = f"{mail(ledger[page])}---\n\n{''.join(diffs)}"
    return made


def diff(path: str, old: str, new: str) -> str:
    """The change of a file as git writes it."""
    names = f"diff --git a/{path} b/{path}\nindex {_blob(old)}..{_blob(new)} 100644\n"
    lines = unified_diff(_lines(old), _lines(new), f"a/{path}", f"b/{path}")
    end = "\n\\ No newline at end of file\n"
    return names + "".join(each if each.endswith("\n") else each + end for each in lines)


def _lines(text: str) -> list[str]:
    return StringIO(text, newline="\n").readlines()


def _blob(text: str) -> str:
    """The name that git has for a text."""
    data = text.encode()
    return sha1(b"blob %d\0" % len(data) + data, usedforsecurity=False).hexdigest()


def _hyphenated(subject: str) -> str:
    return re.sub(r"[^A-Za-z0-9._]+", "-", subject)[:52].strip("-.")


def mail(row: Row) -> str:
    """A commit before its diff: the page's words on the defect, the change, the figures, the command."""
    patch = _patch(row)
    text = (FOLDER / f"{row.page}.md").read_text(encoding="utf-8")
    command, defect = plain(text.split("## Measured")[0]).split("\n", 1)[1].strip().split("\n", 1)
    parts = [defect, patch.change, _figures(text)]
    parts.append(_outcome(row, patch))
    parts.append(f"Shown by mxeon, docs/upstream/{row.page}.md:\n\n    {command.strip()}")
    body = "\n\n".join(map(wrapped, filter(None, parts)))
    return f"From {40 * '0'} Mon Sep 17 00:00:00 2001\nFrom: {AUTHOR}\nSubject: [PATCH] {patch.subject}\n\n{body}\n"


def _outcome(row: Row, patch: Patch) -> str:
    """What the checks say with the change; empty where the tests of another host have it."""
    lines = [f"- {_check(pair)}: passes" for pair in row.repaired]
    for words, pairs in row.remains.items():  # of the figures above
        lines += [f"- {_check(pair)}: {words}" for pair in pairs if pair in row.issue["rows"]]
    needed = [f'"{_patch(each).subject}"' for each in rows() if each.page in patch.needs]
    return (
        "\n".join([f"With {' and '.join(['this change', *needed])}:", "", *lines]) if lines else ""
    )


def _check(pair: tuple[str, str]) -> str:
    return f"`{pair[0]}` of {pair[1]}"


def _patch(row: Row) -> Patch:
    if row.patch is None:
        raise ValueError(f"{row.page}.md must say what its patch is, in [patch]")
    return row.patch


def plain(text: str) -> str:
    """A page's text without its marks and links."""
    return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", re.sub(r"<!--.*?-->", "", text))


def _figures(text: str) -> str:
    """The rows of the table of a page as a list."""
    lines = [
        f"- {name}: {f'{found} {unit}'.strip()}, allowed {most}"
        for name, found, most, unit in _cells(text)
    ]
    return "\n".join(["Measured:", "", *lines])


def _cells(text: str) -> list[tuple[str, str, str, str]]:
    """What is measured, its figure, what is allowed, and the unit, of the rows of a page's table."""
    table = text.split(BEGIN)[1].split(END)[0].split("\n\n")[0].splitlines()
    head, _, *cells = ([each.strip() for each in line.strip("|").split("|")] for line in table)
    if head[0] == "check":
        return [(_check((check, name)), *figures) for check, name, *figures in cells]
    return [(name, found, right, "") for name, found, right in cells]


def wrapped(text: str) -> str:
    """Paragraphs and lists within the width of a commit; tables and code as they are."""
    return "\n\n".join(map(_paragraph, text.strip("\n").split("\n\n")))


def _paragraph(text: str) -> str:
    if text[:1] in "| ":
        return text
    items = re.split(r"\n(?=- )", text)
    options = {"break_long_words": False, "break_on_hyphens": False}
    return "\n".join(
        fill(
            " ".join(each.split()), WIDTH, subsequent_indent="  " * each.startswith("- "), **options
        )
        for each in items
    )


# The sentence of `pictures.py`.
CHANGE = re.compile(
    r"which is (\S+) in the mean, of a mean radiance of (\S+), and (\S+) where it is white"
)
BLOCK = re.compile(r"<!-- patches (\S+) -->\n.*?<!-- end -->\n", re.DOTALL)


def index_text(text: str) -> str:
    """The index of the pages with the patches of each project."""
    tables = {project.name: _table(project) for project in PROJECTS}
    return BLOCK.sub(
        lambda found: f"<!-- patches {found[1]} -->\n{tables[found[1]]}<!-- end -->\n", text
    )


def _table(project: Project) -> str:
    ledger = {row.page: row for row in rows()}
    numbers = {page: number for number, page in enumerate(topics(project), 1)}
    lines = "| | patch | kind | measured | its picture changes by | needs |\n|---|---|---|---|---|---|\n"
    for page, number in numbers.items():
        row, patch = ledger[page], _patch(ledger[page])
        kind = f"in main, #{row.pull}" if row.pull else patch.kind
        needed = ", ".join(f"{numbers[each]:04}" for each in patch.needs if each in numbers)
        cells = (f"[{patch.subject}]({page}.md)", kind, _measured(row), _change(page), needed)
        lines += f"| {number:04} | {' | '.join(cells)} |\n"
    return lines


def _change(page: str) -> str:
    """By how much the repair changes the picture of a page; empty for one without a picture."""
    text = " ".join((FOLDER / f"{page}.md").read_text(encoding="utf-8").split())
    found = CHANGE.search(text)
    return f"{found[1]} in the mean, of {found[2]}; {found[3]} at most" if found else ""


def _measured(row: Row) -> str:
    """The figure of a page, of the first of its rows that the patch repairs."""
    cells = _cells((FOLDER / f"{row.page}.md").read_text(encoding="utf-8"))
    repaired = {_check(pair) for pairs in (row.repaired, *row.remains.values()) for pair in pairs}
    _, found, most, unit = next((each for each in cells if each[0] in repaired), cells[0])
    return f"{found} {unit}".strip() + f", allowed {most}"


def main() -> None:
    """Write the patches of all projects, remove those that there are no more, and write the index."""
    write_text(INDEX, index_text(INDEX.read_text(encoding="utf-8")))
    for project in PROJECTS:
        folder = PATCHES / project.name
        try:
            made = patches(project)
        except NotRun as reason:
            print(f"{project.name}: its patches stay as they are: {reason}")
            continue
        for path in set(folder.glob("*")) - {folder / name for name in made}:
            path.unlink()
        for name, text in made.items():
            folder.mkdir(parents=True, exist_ok=True)
            write_text(folder / name, text)


if __name__ == "__main__":
    main()
