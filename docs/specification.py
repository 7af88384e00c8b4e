# SPDX-License-Identifier: Apache-2.0
"""Measure what the page on the specification shows, and its summaries.

python docs/specification.py           judge stock and eonlib on gl, write specification.json and the pages
python docs/specification.py --page    the pages alone, from specification.json
"""

import json
import re
import sys
from contextlib import closing
from pathlib import Path

import MaterialX as mx

from mxeon.conformance.checks.families import PBR_SUBJECTS
from mxeon.conformance.checks.nodes import SUBJECTS
from mxeon.conformance.known_issues import ISSUES
from mxeon.conformance.results import PASSED
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT

FOLDER = Path(__file__).resolve().parent
DATA, PAGE = FOLDER / "specification.json", FOLDER / "specification.md"
HOST, LIBRARIES = "gl", ("stock", "eonlib")
JUDGED = (*SUBJECTS, *PBR_SUBJECTS)
NODES = (*dict.fromkeys(row.node for row in JUDGED if row.node != "eon_diffuse_bsdf"),)
BLOCK = re.compile(r"(<!-- measured (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
# Rows of the summaries of other pages, and what stock computes.
SUMMARY = (
    ("value", "sheen_bsdf, mode zeltner", "a singular frame where the viewer is along the normal"),
    ("frame", "translucent_bsdf", "light of the wrong side, seen from the back"),
    ("layer", "dielectric_bsdf, scatter_mode R", "a throughput without the tint, by a fit"),
    ("lossless", "conductor_bsdf", "energy compensation by a fit"),
    ("layering", "sheen_bsdf, mode zeltner", "a throughput without the color"),
    ("environment", "sheen_bsdf, mode conty_kulla", "a fit"),
    ("environment", "burley_diffuse_bsdf", "a fit"),
    (
        "layer",
        "generalized_schlick_bsdf, scatter_mode R",
        "one without exponent, of the mean color",
    ),
)
SHORT = 4  # rows of the summary in the README
SUMMARIES = (FOLDER.parent / "README.md", FOLDER / "results.md")
SUMMARY_HEAD = (
    "| check | eonlib | stock MaterialX 1.39.5 | what stock computes |\n|---|---|---|---|\n"
)
HEAD = "| check | mode | allowed | stock | eonlib | stock's defect |\n|---|---|---|---|---|---|\n"


def measured():
    """Results of the nodes with both libraries, as plain data, and where they were measured."""
    tasks = make_plan((), (HOST,), LIBRARIES, nodes=NODES).tasks
    chosen = [task for task in tasks if task.host == HOST and task.check != "curve"]
    with closing(Judge(DEFAULT)) as judge:
        findings = [judge.work(task) for task in chosen]
    [device] = findings[0].hosts
    results = [
        {
            "check": each.check,
            "subject": each.subject,
            "library": each.library,
            "verdict": each.verdict,
            "error": f"{each.error:.0f}" if each.unit == "values" else f"{each.error:.2g}",
            "allowed": f"{each.tolerance:.2g} {each.unit}",
        }
        for finding in findings
        for each in finding.results
    ]
    return {
        "place": f"{device.device}, {device.version}, MaterialX {mx.__version__}",
        "results": results,
    }


def page(text, data):
    """The page, with the tables of its nodes from these data."""
    return BLOCK.sub(lambda found: found[1] + table(found[2], data) + found[3], text)


def table(name, data):
    """The table of a node, the summary, or the first rows of it."""
    count = {"summary": len(SUMMARY), "short": SHORT}.get(name)
    return summary(data, count) if count else node_table(name, data)


def summary(data, count):
    """A table of what stock computes in place of the specification."""
    errors = {(r["check"], r["subject"], r["library"]): r["error"] for r in data["results"]}
    lines = []
    for check, subject, words in SUMMARY[:count]:
        stock, eonlib = (errors.get((check, subject, each), "") for each in LIBRARIES)
        name = f"`{subject.split(',')[0]}`{_mode(subject) and ', ' + _mode(subject)}, `{check}`"
        lines.append(f"| {name} | {eonlib} | {stock} | {words} |\n")
    return "\n" + SUMMARY_HEAD + "".join(lines)


def node_table(node, data):
    """What does not pass of a node with either library, and what passes with both."""
    rows = {}
    for each in data["results"]:
        if each["subject"].split(",")[0] == node:
            rows.setdefault((each["check"], each["subject"]), {})[each["library"]] = each
    lines, passed = [], {}
    for (check, subject), found in rows.items():
        if all(found[library]["verdict"] == PASSED for library in LIBRARIES):
            passed.setdefault(check, []).append(_mode(subject))
        else:
            lines.append(_line(check, subject, found))
    words = ", ".join(f"`{check}`{_modes(modes, rows)}" for check, modes in passed.items())
    return "\n" + (HEAD + "".join(lines) + "\n" if lines else "") + f"Passed with both: {words}.\n"


def _line(check, subject, found):
    """A row of a table."""
    errors = [f"{found[each]['error']}, {found[each]['verdict']}" for each in LIBRARIES]
    mode = _mode(subject) or "all"
    cells = check, mode, found[LIBRARIES[0]]["allowed"], *errors, _links(check, subject)
    return f"| {' | '.join(cells)} |\n"


def _mode(subject):
    """The mode of a subject, without its node; "" where the node has one alone."""
    return "" if "scatter_mode" in subject else subject.partition(", ")[2].removeprefix("mode ")


def _modes(modes, rows):
    """The modes that pass, where those are not all."""
    everything = {_mode(subject) for _, subject in rows}
    return "" if set(modes) == everything else f" ({', '.join(modes)})"


def _links(check, subject):
    """Links to the pages on stock's failures of a check."""
    pages = [
        issue.page
        for issue in ISSUES
        if issue.host == HOST and (check, subject) in (*issue.rows, *issue.implied)
    ]
    names = {each: each.partition("_")[2].replace("_", " ") for each in pages}
    return ", ".join(f"[{name}](upstream/{each}.md)" for each, name in names.items())


def main():
    """Write the page, and the data that it shows unless --page is given."""
    if "--page" not in sys.argv[1:]:
        write_text(DATA, json.dumps(measured(), indent=1) + "\n")
    data = json.loads(DATA.read_text(encoding="utf-8"))
    for file in (PAGE, *SUMMARIES):
        write_text(file, page(file.read_text(encoding="utf-8"), data))


if __name__ == "__main__":
    main()
