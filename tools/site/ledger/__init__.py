# SPDX-License-Identifier: Apache-2.0
"""The ledger of upstream defects: the measurements of its pages, and the patches.

`docs/upstream` has a page for each defect, the suite's latest results in `measured.json`, and the repairs
as commits in `patches/`. A patch names its page in its message. The site fills in the figures.

    python -m tools.site.ledger.measure [HOST ...]  measures the tables anew
    python -m tools.site.ledger.pictures            draws the pages' pictures
"""

import json
import os
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

from mxeon.conformance.results import Result
from mxeon.conformance.results.known_issues import issues
from mxeon.conformance.results.quantities import Quantity
from mxeon.io.files import write_text
from tools.site import DOCS, ROOT

FOLDER, PATCHES = DOCS / "upstream", ROOT / "patches"
MEASURED = FOLDER / "measured.json"


def measured() -> dict[str, Any]:
    """The measurements by page: rows of checks, place and diagnosis."""
    return dict(json.loads(MEASURED.read_text(encoding="utf-8")))


def write_measured(found: dict[str, Any]) -> None:
    """Write the measurements and the changes by patches, one line per page."""
    write_text(MEASURED, dumped(dict(sorted(with_patches(found).items())), 1) + "\n")


def dumped(found: Any, depth: int) -> str:
    """JSON with a line for each entry down to a depth."""
    if depth == 0 or not isinstance(found, dict):
        return json.dumps(found)
    lines = (f"{json.dumps(name)}: {dumped(each, depth - 1)}" for name, each in found.items())
    return "{\n" + ",\n".join(lines) + "\n}"


def with_patches(found: dict[str, Any]) -> dict[str, Any]:
    """The measurements, with the shortest change by each page's patch, which identifies patched copies."""
    files = patches("materialx")
    return found | {
        page: found[page] | {"patch": _shortest_change(path.read_bytes().decode())}
        for page, path in files.items()
    }


def _shortest_change(patch: str) -> tuple[str, str, str]:
    """The shortest change of a patch: its file, and the text before and after."""
    changes = []
    for file, part in re.findall(
        r"^--- a/(\S+)\n\+\+\+ .*\n((?:[ @+-].*\n)+)", patch, re.MULTILINE
    ):
        for run in re.findall(r"^(?: .*\n)?(?:[+-].*\n)+(?: .*\n)?", part, re.MULTILINE):
            lines = run.splitlines(keepends=True)
            if {line[0] for line in lines} >= {"+", "-"}:  # otherwise context lines are needed
                lines = [line for line in lines if line[0] != " "]
            old, new = ("".join(line[1:] for line in lines if line[0] != sign) for sign in "+-")
            changes.append((file, old, new))
    return min(changes, key=lambda change: len(change[1] + change[2]))


def figure(result: Result) -> str:
    """The error of a result in print."""
    return f"{result.error:.0f}" if result.quantity is Quantity.VALUES else f"{result.error:.2g}"


# --- patches ------------------------------------------------------------------------------------


@cache
def patches(project: str) -> dict[str, Path]:
    """The patches of a project in order, by page."""
    found = {}
    for path in sorted((PATCHES / project).glob("*.patch")):
        [page] = re.findall(r"docs/upstream/(\w+)\.md", path.read_text(encoding="utf-8"))
        found[page] = path
    return found


def patches_of(page: str) -> list[Path]:
    """The patches of a page, those for MaterialX before those for copies."""
    projects = sorted(path.name for path in PATCHES.iterdir() if path.is_dir())
    return [found[page] for each in projects if page in (found := patches(each))]


def own_diff(page: str) -> str:
    """The diff in a page's own text; "" if its repair is a patch."""
    return "".join(
        re.findall(r"^```diff\n(.*?)^```", issues()[page].text, re.DOTALL | re.MULTILINE)
    )


def needed(page: str) -> set[str]:
    """The page, and all pages whose patches its own requires, recursively."""
    found = {page}
    while more := {each for name in found for each in issues()[name].needs} - found:
        found |= more
    return found


def linked(source: Path, target: Path) -> Path:
    """A tree of links to the files of an installed package."""
    ignored = shutil.ignore_patterns("__pycache__", "*.d.ts", "*.map")
    shutil.copytree(source, target, copy_function=os.symlink, ignore=ignored)
    return target


def apply(folder: Path, *diffs: Path | str, strip: int = 1) -> Path:
    """Apply patches, or texts of diffs, to a tree of files or links, and return the tree.

    `strip` is the number of path components to drop.
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
