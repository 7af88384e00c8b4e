# SPDX-License-Identifier: Apache-2.0
"""Measure what the page on the specification shows, and its summaries.

python -m tools.site.specification [HOST ...]  judge stock and eonlib on these hosts, on all of HOSTS if none is
                                         named; write out/specification.json and the pages
python -m tools.site.specification --page      the pages alone, from out/specification.json
"""

import json
import re
import sys
from contextlib import closing
from pathlib import Path

import MaterialX as mx

from mxeon.conformance.results import DIFFERS, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.conformance.specs import PBRLIB
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT

FOLDER = Path(__file__).resolve().parents[2] / "docs"
DATA, PAGE = FOLDER.parent / "out" / "specification.json", FOLDER / "specification.md"
# By host: the shader that it runs.
HOSTS = {
    "gl": "GLSL",
    "webgl": "ESSL",
    "vulkan": "Vulkan GLSL",
    "wgsl": "WGSL's GLSL",
    "slang": "Slang",
    "osl": "OSL, its closures by the models",
    "testrender": "OSL's own renderer, its closures",
    "cycles": "Blender's Cycles, its closures",
}
HOST, LIBRARIES = "gl", ("stock", "eonlib")  # the host of the page and its summaries
JUDGED = (*DIFFUSE, *PBRLIB)
NODES = (*dict.fromkeys(row.node for row in JUDGED if row.node != "eon_diffuse_bsdf"),)
BLOCK = re.compile(r"(<!-- measured (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
# Rows of the summaries of other pages, and what stock computes.
SUMMARY = (
    ("value", "sheen_bsdf, mode zeltner", "a singular frame where the viewer is along the normal"),
    ("transmitted", "dielectric_bsdf, scatter_mode RT", "a division by the masking G1"),
    ("each_lobe", "chiang_hair_bsdf", "a last lobe that is pi^2 too bright"),
    ("film", "generalized_schlick_bsdf, thin film", "half of the substrate's reflectance"),
    ("layer", "dielectric_bsdf, scatter_mode R", "a throughput without the tint, by a fit"),
    ("lobes_energy", "gltf_pbr, every lobe", "light made by layers"),
    ("frame", "translucent_bsdf", "light of the wrong side, seen from the back"),
    ("lossless", "conductor_bsdf", "energy compensation by a fit"),
    ("layering", "sheen_bsdf, mode zeltner", "a throughput without the color"),
    ("environment", "sheen_bsdf, mode conty_kulla", "a fit"),
    ("environment", "burley_diffuse_bsdf", "a fit"),
    (
        "layer",
        "generalized_schlick_bsdf, scatter_mode R",
        "one without exponent, of the mean color",
    ),
    ("output", "blackbody", "a fit beyond its range"),
)
RESULTS = FOLDER / "results.md"
SUMMARY_HEAD = (
    "| check | eonlib | stock MaterialX 1.39.5 | what stock computes |\n|---|---|---|---|\n"
)
HEAD = "| check | mode | tolerance | stock | eonlib | stock's defect |\n|---|---|---|---|---|---|\n"


def measured(host):
    """Where a host ran, and its results of the nodes with both libraries, as rows of text."""
    tasks = make_plan((), (host,), LIBRARIES, nodes=NODES).tasks
    chosen = [task for task in tasks if task.host == host and task.check != "curve"]
    with closing(Judge(DEFAULT)) as judge:
        findings = [judge.work(task) for task in chosen]
    [device] = findings[0].hosts
    results = [
        {
            "check": each.check,
            "subject": each.subject,
            "library": each.library,
            "verdict": each.verdict,
            "error": _figure(each),
            "allowed": "" if each.tolerance is None else f"{each.tolerance:.2g} {each.unit}",
        }
        for finding in findings
        for each in finding.results
    ]
    place = f"{device.device}, {device.version}, MaterialX {mx.__version__}"
    return {"place": place, "results": results}


def _figure(result):
    """The error of a result in print; "" where nothing ran."""
    if result.error is None:
        return ""
    return f"{result.error:.0f}" if result.unit == "values" else f"{result.error:.2g}"


def page(text, data):
    """The page, with its tables from the data of all hosts."""
    return BLOCK.sub(lambda found: found[1] + table(found[2], data) + found[3], text)


def table(name, data):
    """The table of a node, the summary, or the table of every target."""
    if name == "targets":
        return targets(data)
    return summary(data[HOST]) if name == "summary" else node_table(name, data[HOST])


def summary(data):
    """A table of what stock computes in place of the specification."""
    errors = {(r["check"], r["subject"], r["library"]): r["error"] for r in data["results"]}
    lines = []
    for check, subject, words in SUMMARY:
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
        if all(found.get(library, {}).get("verdict") == PASSED for library in LIBRARIES):
            passed.setdefault(check, []).append(_mode(subject))
        else:
            lines.append(_line(check, subject, found))
    words = ", ".join(f"`{check}`{_modes(modes, rows)}" for check, modes in passed.items())
    parts = [HEAD + "".join(lines)] if lines else []
    parts += [f"Passed with both: {words}.\n"] if words else []
    return "\n" + "\n".join(parts)


def _line(check, subject, found):
    """A row of a table."""
    results = [found.get(each) for each in LIBRARIES]
    errors = [_words(each) for each in results]
    allowed = next((each["allowed"] for each in results if each and each["allowed"]), "")
    cells = check, _mode(subject) or "all", allowed, *errors, _links(check, subject)
    return f"| {' | '.join(cells)} |\n"


def _words(result):
    """An error and its verdict; a dash where the check was not asked."""
    if not result:
        return "-"
    return ", ".join(filter(None, (result["error"], result["verdict"])))


def _mode(subject):
    """The mode of a subject, without its node; "" where the node has one alone."""
    if sum(row.node == subject.split(",")[0] for row in JUDGED) == 1:
        return ""
    return subject.partition(", ")[2].removeprefix("scatter_").removeprefix("mode ")


def _modes(modes, rows):
    """The modes that pass, where those are not all."""
    everything = {_mode(subject) for _, subject in rows}
    listed = ", ".join(each or "alone" for each in modes)
    return "" if set(modes) == everything else f" ({listed})"


def _links(check, subject):
    """Links to the pages on stock's failures of a check."""
    pages = [
        issue.page
        for issue in ISSUES
        if issue.host == HOST and (check, subject) in (*issue.rows, *issue.implied)
    ]
    names = {each: each.partition("_")[2].replace("_", " ") for each in pages}
    return ", ".join(f"[{name}](upstream/{each}.md)" for each, name in names.items())


def targets(data):
    """How many checks of each node pass on each host, with stock MaterialX / with eonlib, of all."""
    hosts = [host for host in HOSTS if host in data]
    lines = [f"- `{host}`: {HOSTS[host]}, {data[host]['place']}\n" for host in hosts]
    lines.append(f"\n| node | {' | '.join(hosts)} |\n|{'---|' * (1 + len(hosts))}\n")
    for node in NODES:
        rows = {
            host: [each for each in data[host]["results"] if each["subject"].split(",")[0] == node]
            for host in hosts
        }
        lines.append(f"| {node} | {' | '.join(map(_passing, rows.values()))} |\n")
    return "\n" + "".join(lines)


def _passing(results):
    """How many results of a node pass or differ where the text permits it; "" if none was asked."""
    cells = []
    for library in LIBRARIES:
        verdicts = [each["verdict"] for each in results if each["library"] == library]
        asked = len(verdicts) - verdicts.count(NOT_RUN)
        right = verdicts.count(PASSED) + verdicts.count(DIFFERS)
        cells.append("all" if asked and right == asked else f"{right} of {asked}" if asked else "-")
    return "" if cells == ["-", "-"] else " / ".join(cells)


def main():
    """Write the pages, and the data that they show unless --page is given."""
    words = sys.argv[1:]
    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    for host in [] if words == ["--page"] else words or HOSTS:
        data[host] = measured(host)
        DATA.parent.mkdir(exist_ok=True)
        write_text(DATA, json.dumps(data))
    for file in (PAGE, RESULTS):
        write_text(file, page(file.read_text(encoding="utf-8"), data))


if __name__ == "__main__":
    main()
