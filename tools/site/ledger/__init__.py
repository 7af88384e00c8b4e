# SPDX-License-Identifier: Apache-2.0
"""The ledger of upstream defects: its entries, what was measured of them, and the patches.

`known_issues.toml` of the package has an entry for each defect, `measured.json` beside it what the suite
said of it last, and `patches/` the repairs as commits. A patch names its page in its message.

    python -m tools.site.ledger                     writes the pages docs/upstream/*.md from them
    python -m tools.site.ledger.measure [HOST ...]  measures the tables anew, then writes the pages
    python -m tools.site.ledger.pictures            draws the pictures anew, then writes the pages
"""

import json
import os
import re
import shutil
import subprocess
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mxeon.conformance.results import Result, known_issues
from mxeon.conformance.results.quantities import Quantity
from tools.site import DOCS, ROOT

FOLDER, PATCHES = DOCS / "upstream", ROOT / "patches"
ENTRIES = Path(known_issues.__file__).with_name("known_issues.toml")
MEASURED = ENTRIES.with_name("measured.json")
SPECIFICATION = ROOT / "out" / "specification.json"  # errors as measured here last, by host

Subjects = dict[str, list[str]]  # by check


@dataclass(frozen=True)
class Entry:
    """An entry of `known_issues.toml`, which says what each field is."""

    page: str
    title: str
    group: str
    defect: str
    cause: str
    repair: str
    why_missed: str
    host: str = ""
    also: list[str] = field(default_factory=list)
    library: str = "stock"
    unavoidable: bool = False
    differs: bool = False
    rows: Subjects = field(default_factory=dict)
    implied: Subjects = field(default_factory=dict)
    repaired: Subjects = field(default_factory=dict)
    remains: dict[str, Subjects] = field(default_factory=dict)
    needs: list[str] = field(default_factory=list)
    kind: str = ""
    pull: int = 0
    command: str = ""
    quantities: str = ""
    diff: str = ""


def entries(text: str | None = None) -> dict[str, Entry]:
    """The entries by their pages; of the package's file, or of another text.

    Raises
    ------
    ValueError
        If an entry has an unknown key, or lacks one.
    """
    tables = tomllib.loads(text or ENTRIES.read_text(encoding="utf-8"))
    found = {}
    for page, table in tables.items():
        try:
            found[page] = Entry(page, **table)
        except TypeError as error:  # which names the key
            raise ValueError(f"entry {page} of {ENTRIES.name}: {error}") from error
    return found


def measured() -> dict[str, Any]:
    """What was measured, by page: its rows of checks, place and diagnosis, and its picture."""
    return dict(json.loads(MEASURED.read_text(encoding="utf-8")))


def write_measured(found: dict[str, Any]) -> None:
    """Write what was measured, a line for each page."""
    MEASURED.write_text(dumped(dict(sorted(found.items())), 1) + "\n", encoding="utf-8")


def dumped(found: Any, depth: int) -> str:
    """JSON with a line for each entry down to a depth."""
    if depth == 0 or not isinstance(found, dict):
        return json.dumps(found)
    lines = (f"{json.dumps(name)}: {dumped(each, depth - 1)}" for name, each in found.items())
    return "{\n" + ",\n".join(lines) + "\n}"


def completed(found: dict[str, Any], known: dict[str, Entry]) -> dict[str, Any]:
    """What was measured, with what the package wants of it to know what an entry explains.

    That is the largest error of each result, `sizes`, and the shortest change of MaterialX by its patch. Where
    tools/site/specification.py has not measured errors here, those known before stay.
    """
    files = patches("materialx")
    hosts = json.loads(SPECIFICATION.read_text(encoding="utf-8")) if SPECIFICATION.exists() else {}
    done = {page: dict(each) for page, each in found.items()}
    for page, entry in known.items():
        explained = {*pairs(entry.rows), *pairs(entry.implied)}
        old: dict[str, dict[str, float]] = {} if hosts else found.get(page, {}).get("sizes", {})
        sizes = {
            check: {each: size for each, size in known.items() if (check, each) in explained}
            for check, known in old.items()
        }
        errors = [(row[0], row[1], row[2]) for row in found.get(page, {}).get("rows", ())]
        for host in (entry.host, *entry.also):
            errors += [
                (each["check"], each["subject"], each["error"])
                for each in hosts.get(host, {"results": ()})["results"]
                if each["library"] == "stock" and each["error"]
            ]
        for check, subject, error in errors:
            if (check, subject) in explained:
                shown = sizes.setdefault(check, {})
                shown[subject] = max(float(error), shown.get(subject, 0.0))
        if entry.host:
            done.setdefault(page, {})["sizes"] = sizes
            if page in files:
                done[page]["patch"] = _shortest_change(files[page].read_bytes().decode())
    return done


def _shortest_change(patch: str) -> tuple[str, str, str]:
    """The shortest change of a patch: its file, and the text before and after."""
    changes = []
    for file, part in re.findall(
        r"^--- a/(\S+)\n\+\+\+ .*\n((?:[ @+-].*\n)+)", patch, re.MULTILINE
    ):
        for run in re.findall(r"^(?: .*\n)?(?:[+-].*\n)+(?: .*\n)?", part, re.MULTILINE):
            lines = run.splitlines(keepends=True)
            if {line[0] for line in lines} >= {"+", "-"}:  # else the lines around are needed
                lines = [line for line in lines if line[0] != " "]
            old, new = ("".join(line[1:] for line in lines if line[0] != sign) for sign in "+-")
            changes.append((file, old, new))
    return min(changes, key=lambda change: len(change[1] + change[2]))


def figure(result: Result) -> str:
    """The error of a result in print."""
    return f"{result.error:.0f}" if result.quantity is Quantity.VALUES else f"{result.error:.2g}"


def pairs(subjects: Subjects) -> list[tuple[str, str]]:
    """Check and subject of each result."""
    return [(check, subject) for check, each in subjects.items() for subject in each]


# --- patches ------------------------------------------------------------------------------------


def patches(project: str) -> dict[str, Path]:
    """The patches of a project in their order, by the page that each is from."""
    found = {}
    for path in sorted((PATCHES / project).glob("*.patch")):
        [page] = re.findall(r"docs/upstream/(\w+)\.md", path.read_text(encoding="utf-8"))
        found[page] = path
    return found


def patches_of(page: str) -> list[Path]:
    """The patches from a page: MaterialX's before those of copies."""
    projects = sorted(path.name for path in PATCHES.iterdir() if path.is_dir())
    return [found[page] for each in projects if page in (found := patches(each))]


def needed(page: str, known: dict[str, Entry]) -> set[str]:
    """The page, and those whose patches its own needs, and theirs."""
    found = {page}
    while more := {each for name in found for each in known[name].needs} - found:
        found |= more
    return found


def linked(source: Path, target: Path) -> Path:
    """A tree of links to the files of an installed package."""
    ignored = shutil.ignore_patterns("__pycache__", "*.d.ts", "*.map")
    shutil.copytree(source, target, copy_function=os.symlink, ignore=ignored)
    return target


def apply(folder: Path, *diffs: Path | str, strip: int = 1) -> Path:
    """Apply patches, or texts of diffs, to a tree of files or of links; the tree.

    `strip` is how many parts of their paths lie above the tree.
    """
    alone = {"GIT_CEILING_DIRECTORIES": str(folder.resolve().parent), "GIT_CONFIG_NOSYSTEM": "1"}
    command = ["git", "-c", "core.autocrlf=false", "apply", "--unidiff-zero", f"-p{strip}", "-"]
    for each in diffs:
        text = each if isinstance(each, str) else each.read_bytes().decode()
        for name in re.findall(r"^--- (\S+)$", text, re.MULTILINE):
            path = folder.joinpath(*name.split("/")[strip:])
            data = path.read_bytes()
            path.unlink()  # perhaps a link
            path.write_bytes(data)
        subprocess.run(
            command,
            cwd=folder,
            input=text.encode(),
            check=True,
            env=os.environ | alone,
            capture_output=True,
        )
    return folder
