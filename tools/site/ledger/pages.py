# SPDX-License-Identifier: Apache-2.0
"""Adds measurements, patches, versions and a list of pages to the ledger on the site."""

import json
import re
from collections import defaultdict
from pathlib import Path
from textwrap import fill

from mxeon.conformance import words
from mxeon.conformance.results import Diagnosis
from mxeon.conformance.results.known_issues import EONLIB, Issue, issues
from mxeon.conformance.results.quantities import Quantity
from tools.site.ledger import ROOT, measured, patches, patches_of

VERSIONS = Path(__file__).with_name("versions.json")
PLACEHOLDER = re.compile(r"<!-- patches (\S+) -->")  # replaced by a table of patches
LINES = 20  # maximum number of changed lines in a diff
# Headings in the index, by group of pages.
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
        differs = " (*differs*)" if issue.differs else ""
        lines[issue.group] += f"- [{issue.title}]({issue.page}.md){differs}\n"
    return "\n".join(f"### {GROUPS[name]} {{#{name}}}\n\n{each}" for name, each in lines.items())


def filled(name: str, text: str) -> str:
    """Markdown of a ledger page or of the index, README, with tables in place of placeholders."""
    if name == "README":
        text = text.replace("<!-- entries -->", entries())
        return PLACEHOLDER.sub(lambda found: patch_table(found[1]), text)
    issue = issues()[name]
    text = issue.text.replace("\n**Cause.**", f"\n{table(issue)}**Cause.**")
    text, heading, last = text.partition("\n**Why tests miss it.**")
    parts = [text, "", heading + last, outcome(issue), affected_versions(issue)]
    if files := patches_of(name):
        diff, more = short_diff(files[0])
        parts[1] = f"```diff\n{diff}\n```"
        omitted = f"; the diff above leaves out {more} of its lines" if more else ""
        names = _joined([f"`{path.relative_to(ROOT)}`" for path in files])
        parts.append(f"Patch: {names}{omitted}.")
    return "\n\n".join(part.strip("\n") for part in parts if part) + "\n"


def table(issue: Issue) -> str:
    """Markdown with a table of a page's measurements and the diagnosis of the first row."""
    if not issue.rows or not issue.cause:
        return ""
    found = measured()[issue.page]
    diagnosis = words.diagnosis(Diagnosis((issue.cause,)))
    if "next" in found:  # the model with the second smallest difference
        diagnosis += f", then {found['next']}"
    first = " (first row)" if issue.rows[1:] else ""
    lobes = ", and the lobes of eonlib" if issue.library == EONLIB else ""
    lines = [
        *(["Among other checks:", ""] if issue.implied else []),
        "| check | subject | measured | tolerance | unit |",
        "|---|---|---|---|---|",
        *(f"| {' | '.join(row)} | {Quantity(key).unit} |" for *row, key in found["rows"]),
        "",
        f"Diagnosis{first}: {diagnosis}. Measured with {found['place']}{lobes}.",
    ]
    return "\n".join(lines) + "\n\n"


def short_diff(patch: Path) -> tuple[str, int]:
    """The first LINES changed lines of a patch, and the number of omitted changed lines."""
    lines: list[str] = []
    count, follows = 0, False
    for line in patch.read_text(encoding="utf-8").split("\n---\n", 1)[1].splitlines():
        changed = line[:1] in ("+", "-") and line[:4] not in ("--- ", "+++ ")
        count += changed
        if line.startswith("--- "):
            head = f"--- {line[4:].split('/', 1)[1]}"
        elif changed and count <= LINES:
            if not follows:
                lines.append(head)
            lines.append(line)
            head = "@@"
        follows = changed
    return "\n".join(lines), max(count - LINES, 0)


def outcome(issue: Issue) -> str:
    """Sentence about the checks that pass, or still fail, after a page's patch is applied."""
    checks: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for check, subject in issue.repaired:
        checks[subject, "passes", "pass"].append(f"`{check}`")
    for check, subject in issue.remains:
        if (check, subject) in issue.rows:
            checks[subject, "shows another cause", "show another cause"].append(f"`{check}`")
    parts = [
        f"{_joined(names)} of {subject} {plural if names[1:] else singular}"
        for (subject, singular, plural), names in checks.items()
    ]
    if not parts:
        return ""
    files = patches("materialx")
    needs = [f"[{files[each].name[:4]}]({each}.md)" for each in issue.needs]
    text = f"With {_joined(['this patch', *needs])}: {'; '.join(parts)}."
    return fill(text, 110, break_on_hyphens=False)


def affected_versions(issue: Issue) -> str:
    """Sentence about the MaterialX versions that have a defect, or "" if no version was checked."""
    versions = json.loads(VERSIONS.read_text(encoding="utf-8"))
    if issue.page not in versions["pages"]:
        return ""
    found = versions["pages"][issue.page]
    names = {name: f"main of {versions['commit'][1]}" if name == "main" else name for name in found}
    gone = [name for name in found if found[name]["passed"] or (issue.pull and name == "main")]
    there = [names[name] for name in found if name not in gone]
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
        rows = found.get(page, {}).get("rows", [])
        repaired = [row for row in rows if (row[0], row[1]) in issue.mended]
        measure = ""
        for _, _, figure, tolerance, key in (*repaired, *rows)[:1]:
            unit, counted = Quantity(key).unit, Quantity(key).counted
            measure = f"{figure} {unit}, tolerance {tolerance}"
            if counted:
                measure = words.counted(int(figure), unit.removesuffix("s"))
        needs = ", ".join(sorted(files[each].name[:4] for each in issue.needs if each in files))
        cells = (
            path.name[:4],
            f"[{text.split('[PATCH] ')[1]}]({page}.md)",
            f"in main, #{issue.pull}" if issue.pull else issue.kind,
            measure,
            needs,
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)
