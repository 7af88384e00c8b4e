# SPDX-License-Identifier: Apache-2.0
"""Adds the list of pages, figures, diffs of patches and versions to the ledger on the site."""

import json
import re
from pathlib import Path
from textwrap import fill
from typing import Any

from mxeon.conformance import words
from mxeon.conformance.results import Diagnosis
from mxeon.conformance.results.known_issues import EONLIB, Issue, issues
from mxeon.conformance.results.quantities import Quantity
from tools.site.ledger import ROOT, measured, patches, patches_of

VERSIONS = Path(__file__).with_name("versions.json")
PLACE = re.compile(r"<!-- patches (\S+) -->")  # placeholder for a project's table in the index
SHOWN = 20  # maximum lines of a diff on a page
# Headings of the index's groups, by name.
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
    "cycles": "Blender",
    "storm": "OpenUSD's Hydra Storm",
    "three": "three.js",
    "babylon": "Babylon.js",
    "pathtracer": "three-gpu-pathtracer",
    "luxcore": "LuxCoreRender",
    "shadewire": "shadewire",
    "testrender": "OSL's testrender",
    "pbrlib": "Printed specifications",
}


def entries() -> str:
    """Markdown list of all pages by group.

    Raises KeyError if a page's group is not one of `GROUPS`.
    """
    lines = dict.fromkeys(GROUPS, "")
    for issue in issues().values():
        differs = " (*differs*)" * issue.differs
        lines[issue.group] += f"- [{issue.title}]({issue.page}.md){differs}\n"
    return "\n".join(f"### {GROUPS[name]} {{#{name}}}\n\n{each}" for name, each in lines.items())


def filled(name: str, text: str) -> str:
    """Markdown of a ledger page, or of the index README, with the site's additions."""
    if name == "README":
        text = text.replace("<!-- entries -->", entries())
        return PLACE.sub(lambda found: patch_table(found[1]), text)
    issue = issues()[name]
    diff, more = short_diff(name)
    shown = f"```diff\n{diff}\n```" if diff else ""
    numbers = {page: path.name[:4] for page, path in patches("materialx").items()}
    files = _joined([f"`{path.relative_to(ROOT)}`" for path in patches_of(name)])
    left = f"; the diff above leaves out {more} of its lines" if more else ""
    versions = json.loads(VERSIONS.read_text(encoding="utf-8"))
    ends = (outcome(issue, numbers), seen(issue, versions), files and f"Patch: {files}{left}.")
    text = issue.text.replace("\n**Cause.**", f"\n{table(issue)}**Cause.**")
    text, why, missed = text.partition("\n**Why tests miss it.**")
    return (
        "\n\n".join(each.strip("\n") for each in (text, shown, why + missed, *ends) if each) + "\n"
    )


def table(issue: Issue) -> str:
    """Markdown table of a page's measurements, and the first row's diagnosis; "" without rows."""
    found = measured().get(issue.page, {})
    if not issue.rows or not issue.cause:
        return ""
    lobes = ", and the lobes of eonlib" * (issue.library == EONLIB)
    lines = [
        *(["Among other checks:", ""] if issue.implied else []),
        "| check | subject | measured | tolerance | unit |",
        "|---|---|---|---|---|",
        *(f"| {' | '.join(row)} | {Quantity(key).unit} |" for *row, key in found["rows"]),
        "",
        f"Diagnosis{' (first row)' * bool(issue.rows[1:])}: {said(issue, found)}. Measured with {found['place']}{lobes}.",
    ]
    return "\n".join(lines) + "\n\n"


def said(issue: Issue, found: dict[str, Any]) -> str:
    """The diagnosis in words: the cause, and the second-best model if the cause is a model."""
    cause = words.diagnosis(Diagnosis((issue.cause,) if issue.cause else ()))
    return f"{cause}, then {found['next']}" if "next" in found else cause


def short_diff(page: str) -> tuple[str, int]:
    """The first SHOWN changed lines of a page's first patch, and the number of omitted ones.

    Returns "" and 0 for a page without a patch.
    """
    files = patches_of(page)
    if not files:
        return "", 0
    shown: list[str] = []
    count, inside = 0, False
    for line in files[0].read_text(encoding="utf-8").split("\n---\n", 1)[1].splitlines():
        changed = line[:1] in ("+", "-") and line[:4] not in ("--- ", "+++ ")
        count += changed
        if line.startswith("--- "):
            head = f"--- {line[4:].split('/', 1)[1]}"
        elif changed and count <= SHOWN:
            shown += [] if inside else [head]
            shown.append(line)
            head = "@@"
        inside = changed
    return "\n".join(shown), max(count - SHOWN, 0)


def outcome(issue: Issue, numbers: dict[str, str]) -> str:
    """Sentence about checks that pass, or still fail, with a page's patch and those it needs."""
    subjects: dict[tuple[str, bool], list[str]] = {}
    for check, subject in issue.repaired:
        subjects.setdefault((subject, True), []).append(f"`{check}`")
    for check, subject in issue.remains:
        if (check, subject) in issue.rows:
            subjects.setdefault((subject, False), []).append(f"`{check}`")
    parts = [
        f"{_joined(checks)} of {subject} "
        + (
            f"pass{'es' * (not checks[1:])}"
            if passes
            else f"show{'s' * (not checks[1:])} another cause"
        )
        for (subject, passes), checks in subjects.items()
    ]
    if not parts:
        return ""
    needs = _joined(["this patch", *(f"[{numbers[each]}]({each}.md)" for each in issue.needs)])
    return fill(f"With {needs}: {'; '.join(parts)}.", 110, break_on_hyphens=False)


def seen(issue: Issue, versions: dict[str, Any]) -> str:
    """Sentence about the MaterialX versions with a defect; "" if they were not checked for it."""
    if issue.page not in versions["pages"]:
        return ""
    shown = versions["pages"][issue.page]
    names = {name: f"main of {versions['commit'][1]}" if name == "main" else name for name in shown}
    gone = [name for name in shown if shown[name]["passed"] or (issue.pull and name == "main")]
    there = [names[name] for name in shown if name not in gone]
    text = f"Seen in MaterialX {there[0]} to {there[-1]}"
    text += f"; gone in {_joined([names[name] for name in gone])}" if gone else ""
    return f"{text}, by pull request {issue.pull}." if issue.pull else f"{text}."


def _joined(names: list[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)


def patch_table(project: str) -> str:
    """Markdown table of a project's patches for the index."""
    files, found = patches(project), measured()
    lines = ["| | patch | kind | measured | needs |", "|---|---|---|---|---|"]
    for page, path in files.items():
        issue = issues()[page]
        text = " ".join(path.read_text(encoding="utf-8").split("\n\n", 1)[0].split())
        # Prefer the figure of a row that the patch repairs.
        measures = found.get(page, {}).get("rows", [])
        chosen = [row for row in measures if (row[0], row[1]) in issue.mended]
        figures = [
            words.counted(int(figure), quantity.unit.removesuffix("s"))
            if quantity.counted
            else f"{figure} {quantity.unit}, tolerance {tolerance}"
            for _, _, figure, tolerance, key in (*chosen, *measures)
            for quantity in [Quantity(key)]
        ]
        needs = ", ".join(sorted(files[each].name[:4] for each in issue.needs if each in files))
        cells = (
            path.name[:4],
            f"[{text.split('[PATCH] ')[1]}]({page}.md)",
            f"in main, #{issue.pull}" if issue.pull else issue.kind,
            figures[0] if figures else "",
            needs,
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)
