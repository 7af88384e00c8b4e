# SPDX-License-Identifier: Apache-2.0
"""Write the pages of the ledger and their index from its entries."""

import json
from pathlib import Path
from textwrap import fill
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.words import counted
from mxeon.io.files import write_text
from tools.site.ledger import (
    FOLDER,
    PATCHES,
    ROOT,
    Entry,
    completed,
    entries,
    measured,
    pairs,
    patches,
    patches_of,
    write_measured,
)

VERSIONS = Path(__file__).with_name("versions.json")
INDEX = FOLDER / "README.md"
WHOLE = 20  # a diff of fewer lines is shown whole
SHOWN = 8  # lines of a longer diff on a page, unless its first change is longer
TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent),
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
    undefined=StrictUndefined,
)
# The parts of the index: what stands above the pages of each.
GROUPS = {
    "rough_diffuse": "`oren_nayar_diffuse_bsdf`",
    "diffuse": "`burley_diffuse_bsdf`, `subsurface_bsdf`, `translucent_bsdf`",
    "sheen": "`sheen_bsdf`",
    "combinations": "`multiply`, `add`",
    "microfacets": "`dielectric_bsdf`, `conductor_bsdf`, `generalized_schlick_bsdf`",
    "emission": "`conical_edf`, `measured_edf`, `absorption_vdf`, `anisotropic_vdf`, `surface`, `light`",
    "hair": "`chiang_hair_bsdf`",
    "utilities": "Utility nodes",
    "surfaces": "Surface shaders",
    "documents": "Documents and generation",
    "blender": "Blender",
    "storm": "OpenUSD's Hydra Storm",
    "three": "three.js",
    "babylon": "Babylon.js",
    "pathtracer": "three-gpu-pathtracer",
    "luxcore": "LuxCoreRender",
    "testrender": "OSL's testrender",
    "printed": "Printed specifications",
}


def pages(known: dict[str, Entry] | None = None) -> dict[Path, str]:
    """The text of each page and of the index, by path.

    Raises
    ------
    ValueError
        If the group of an entry is none of the index.
    """
    known, found = known or entries(), measured()
    groups: dict[str, list[Entry]] = {name: [] for name in GROUPS}
    for name, entry in known.items():
        if entry.group not in groups:
            raise ValueError(
                f"group of {name} must be one of {', '.join(GROUPS)}; got {entry.group}"
            )
        groups[entry.group].append(entry)
    versions = json.loads(VERSIONS.read_text(encoding="utf-8"))
    page, index = TEMPLATES.get_template("page.md.jinja"), TEMPLATES.get_template("index.md.jinja")
    numbers = {name: path.name[:4] for name, path in patches("materialx").items()}
    texts = {
        FOLDER / f"{name}.md": page.render(
            entry=entry,
            measured=found.get(name, {}),
            patches=_joined([f"`{path.relative_to(ROOT)}`" for path in patches_of(name)]),
            outcome=outcome(entry, numbers),
            diff=short_diff(entry)[0],
            more=short_diff(entry)[1],
            versions=seen(entry, versions),
        )
        for name, entry in known.items()
    }
    projects = [path.name for path in PATCHES.iterdir() if path.is_dir()]
    text = index.render(
        groups={GROUPS[name]: each for name, each in groups.items()},
        tables={each: table(each, known, found) for each in projects},
    )
    return texts | {INDEX: text}


def short_diff(entry: Entry) -> tuple[str, int]:
    """A short repair, the first changes of a long one, or its shortest one, and how many lines that leaves out.

    The repair is the entry's first patch, or its own diff.
    """
    files = patches_of(entry.page)
    text = files[0].read_text(encoding="utf-8").split("\n---\n", 1)[1] if files else entry.diff
    changes: list[tuple[str, list[str]]] = []  # file and lines
    name, inside = "", False
    for line in text.splitlines():
        changed = line[:1] in ("+", "-") and line[:4] not in ("--- ", "+++ ")
        if line.startswith("--- "):
            name = line[4:].split("/", 1)[1]
        if changed and not inside:
            changes.append((name, []))
        if changed:
            changes[-1][1].append(line)
        inside = changed
    shown: list[str] = []
    left = 0
    whole = sum(len(lines) for _, lines in changes) < WHOLE
    if not whole and len(changes[0][1]) >= SHOWN:  # then a short one comes first
        changes.sort(key=lambda change: len(change[1]))
    for number, (file, lines) in enumerate(changes):
        head = f"--- {file}" if f"--- {file}" not in shown else "@@"
        if whole or number == 0 or len(shown) + len(lines) < SHOWN:
            shown += [head, *lines]
        else:
            left += len(lines)
    return "\n".join(shown), left


def outcome(entry: Entry, numbers: dict[str, str]) -> str:
    """What the checks say with the patch of an entry, and with those that it needs."""
    subjects: dict[tuple[str, str], list[str]] = {}
    for words, rows in {"": entry.repaired, **entry.remains}.items():
        for check, subject in pairs(rows):
            if words and subject not in entry.rows.get(check, ()):
                continue  # for another cause, which its own page has
            subjects.setdefault((subject, words), []).append(f"`{check}`")
    if not subjects:
        return ""
    parts = [
        f"{_joined(checks)} of {subject} "
        + (f'still fail{s}, with the diagnosis "{words}"' if words else f"pass{'e' * bool(s)}{s}")
        for (subject, words), checks in subjects.items()
        for s in ["" if checks[1:] else "s"]
    ]
    needs = _joined(["this patch", *(f"[{numbers[each]}]({each}.md)" for each in entry.needs)])
    return fill(f"With {needs}: {'; '.join(parts)}.", 110, break_on_hyphens=False)


def seen(entry: Entry, versions: dict[str, Any]) -> str:
    """The line on the versions of MaterialX that have a defect; empty where no check of them shows it."""
    if entry.page not in versions["pages"]:
        return ""
    shown = versions["pages"][entry.page]
    names = {name: f"main of {versions['commit'][1]}" if name == "main" else name for name in shown}
    gone = [name for name in shown if shown[name]["passed"] or (entry.pull and name == "main")]
    there = [names[name] for name in shown if name not in gone]
    text = f"Seen in MaterialX {there[0]} to {there[-1]}"
    text += f"; gone in {_joined([names[name] for name in gone])}" if gone else ""
    return f"{text}, by pull request {entry.pull}." if entry.pull else f"{text}."


def _joined(names: list[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)


def table(project: str, known: dict[str, Entry], found: dict[str, Any]) -> list[tuple[str, ...]]:
    """Rows of the table of a project's patches in the index."""
    files = patches(project)
    rows: list[tuple[str, ...]] = []
    for page, path in files.items():
        entry = known[page]
        text = " ".join(path.read_text(encoding="utf-8").split("\n\n", 1)[0].split())
        picture = found.get(page, {}).get("picture")
        # The figure of the first row that the patch repairs.
        repaired = [entry.repaired, *entry.remains.values()]
        measures = found.get(page, {}).get("rows", [])
        chosen = [row for row in measures if any(row[1] in e.get(row[0], []) for e in repaired)]
        figures = [
            counted(int(figure), quantity.unit.removesuffix("s"))
            if quantity.counted
            else f"{figure} {quantity.unit}, tolerance {tolerance}"
            for _, _, figure, tolerance, key in (*chosen, *measures)
            for quantity in [Quantity(key)]
        ]
        needs = ", ".join(sorted(files[each].name[:4] for each in entry.needs if each in files))
        rows.append(
            (
                path.name[:4],
                f"[{text.split('[PATCH] ')[1]}]({page}.md)",
                f"in main, #{entry.pull}" if entry.pull else entry.kind,
                figures[0] if figures else "",
                f"{picture['mean']} of {picture['of']}; {picture['most']} at most"
                if picture
                else "",
                needs,
            )
        )
    return rows


def main() -> None:
    """Complete what was measured, write the pages, and remove those without an entry."""
    write_measured(completed(measured(), entries()))
    texts = pages()
    for path in set(FOLDER.glob("*.md")) - set(texts):
        path.unlink()
    for path, text in texts.items():
        write_text(path, text)
