# SPDX-License-Identifier: Apache-2.0
"""Measurements and patches for the ledger of defects in MaterialX and renderers.

Each defect has a page in `docs/upstream`, with the latest results in `measured.json`. The folder
`patches/` has a patch for each repair. The commit message of a patch names the page.

    python -m tools.site.ledger.measure [HOST ...]  repeats the measurements
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
    """The stored measurements by page, with rows of the table, host, versions and diagnosis."""
    return dict(json.loads(MEASURED.read_text(encoding="utf-8")))


def write_measured(found: dict[str, Any]) -> None:
    """Write measurements, and the shortest change in each patch, to `measured.json`."""
    write_text(MEASURED, dumped(dict(sorted(with_patches(found).items())), 1) + "\n")


def dumped(found: Any, depth: int) -> str:
    """JSON text with a line for each entry in the outer `depth` levels."""
    if depth == 0 or not isinstance(found, dict):
        return json.dumps(found)
    lines = (f"{json.dumps(name)}: {dumped(each, depth - 1)}" for name, each in found.items())
    return "{\n" + ",\n".join(lines) + "\n}"


def with_patches(found: dict[str, Any]) -> dict[str, Any]:
    """Add each patch's shortest change to the measurements, to recognize patched MaterialX."""
    return found | {
        page: found[page] | {"patch": _shortest_change(path.read_bytes().decode())}
        for page, path in patches("materialx").items()
    }


def _shortest_change(patch: str) -> tuple[str, str, str]:
    """File, old text and new text of the shortest change in a patch."""
    changes, whole_file = [], r"^--- a/(\S+)\n\+\+\+ .*\n((?:[ @+-].*\n)+)"
    for file, part in re.findall(whole_file, patch, re.MULTILINE):
        for run in re.findall(r"^(?: .*\n)?(?:[+-].*\n)+(?: .*\n)?", part, re.MULTILINE):
            lines = run.splitlines(keepends=True)
            if {line[0] for line in lines} >= {"+", "-"}:
                lines = [line for line in lines if line[0] != " "]
            old, new = ("".join(line[1:] for line in lines if line[0] != sign) for sign in "+-")
            changes.append((file, old, new))
    return min(changes, key=lambda change: len(change[1] + change[2]))


def figure(result: Result) -> str:
    return f"{result.error:.0f}" if result.quantity is Quantity.VALUES else f"{result.error:.2g}"


# --- patches ------------------------------------------------------------------------------------


@cache
def patches(project: str) -> dict[str, Path]:
    """Paths of a project's patches by page, ordered by number."""
    found = {}
    for path in sorted((PATCHES / project).glob("*.patch")):
        [page] = re.findall(r"docs/upstream/(\w+)\.md", path.read_text(encoding="utf-8"))
        found[page] = path
    return found


def patches_of(page: str) -> list[Path]:
    projects = sorted(path.name for path in PATCHES.iterdir() if path.is_dir())
    return [found[page] for each in projects if page in (found := patches(each))]


def own_diff(page: str) -> str:
    """The diff in the text of a page, or "" if the page has no diff."""
    return "".join(re.findall(r"(?ms)^```diff\n(.*?)^```", issues()[page].text))


def needed(page: str) -> set[str]:
    """A page, and all pages whose patches must be applied before the page's patch."""
    found = {page}
    while more := {each for name in found for each in issues()[name].needs} - found:
        found |= more
    return found


def linked(source: Path, target: Path) -> Path:
    """Make the folder `target` with links to the files in `source`."""
    ignored = shutil.ignore_patterns("__pycache__", "*.d.ts", "*.map")
    shutil.copytree(source, target, copy_function=os.symlink, ignore=ignored)
    return target


def apply(folder: Path, *diffs: Path | str, strip: int = 1) -> Path:
    """Apply patches, given as paths or as diffs, to a folder, and return the folder.

    Patched copies replace links. `strip` is the number of leading path components that are dropped.
    """
    # Make git ignore the machine's configuration and any repository around the folder.
    alone = {"GIT_CEILING_DIRECTORIES": str(folder.resolve().parent), "GIT_CONFIG_NOSYSTEM": "1"}
    env = os.environ | alone
    command = ["git", "-c", "core.autocrlf=false", "apply", "--unidiff-zero", f"-p{strip}", "-"]
    for each in diffs:
        diff = each.encode() if isinstance(each, str) else each.read_bytes()
        for name in re.findall(r"^--- (\S+)$", diff.decode(), re.MULTILINE):
            path = folder.joinpath(*name.split("/")[strip:])
            data = path.read_bytes()
            path.unlink()
            path.write_bytes(data)
        subprocess.run(command, cwd=folder, input=diff, env=env, check=True, capture_output=True)
    return folder
