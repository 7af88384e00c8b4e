# SPDX-License-Identifier: Apache-2.0
"""Measure what the page on the specification shows, and its summaries.

python tools/site/specification.py [HOST ...]  judge stock and eonlib on these hosts, on all of HOSTS if none is
                                         named; write specification.json and the pages
python tools/site/specification.py --page      the pages alone, from specification.json
"""

import json
import re
import sys
from contextlib import closing
from pathlib import Path

import MaterialX as mx

from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.families import PBR_SUBJECTS
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT

FOLDER = Path(__file__).resolve().parents[2] / "docs"
DATA, PAGE = FOLDER / "specification.json", FOLDER / "specification.md"
TARGETS = FOLDER / "specification_targets.md"
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
MARKS = {PASSED: "", DIFFERS: " (differs)", FAILED: " (failed)", NOT_RUN: "not run"}
JUDGED = (*SUBJECTS, *PBR_SUBJECTS)
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
TARGETS_HEAD = """# The specification on every target

Each check of [the specification, executable](specification.md) on every host that evaluates or draws
generated shaders: the error with stock MaterialX / with eonlib. An error without a word passed; *differs*
is permitted by the text; an empty cell is a check that the host cannot be asked. `osl` is what OSL's text says;
`testrender` and `cycles` are renderers with closures of their own, whose allowed errors are their own:
[OSL](osl.md) says what each makes of them. On Cycles eonlib leaves closures to the renderer, so that there stands
stock's figure alone, and rough diffuse nodes are judged by pictures. `python tools/site/specification.py` measures them again.

"""
HEAD = "| check | mode | allowed | stock | eonlib | stock's defect |\n|---|---|---|---|---|---|\n"


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
    """The page, with the tables of its nodes from these data."""
    return BLOCK.sub(lambda found: found[1] + table(found[2], data) + found[3], text)


def table(name, data):
    """The table of a node, or the summary."""
    return summary(data) if name == "summary" else node_table(name, data)


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
    listed = ", ".join(each or "by itself" for each in modes)
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
    """The page of every target: a table of each node."""
    hosts = [host for host in HOSTS if host in data]
    parts = [
        TARGETS_HEAD,
        *(f"- `{host}`: {HOSTS[host]}, {data[host]['place']}\n" for host in hosts),
    ]
    cells = {
        (row["check"], row["subject"], host, row["library"]): row
        for host in hosts
        for row in data[host]["results"]
    }
    for node in NODES:
        rows = {key[:2]: None for key in cells if key[1].split(",")[0] == node}
        head = " | ".join(["check", "mode", "allowed on gl", *hosts])
        lines = [f"\n## {node}\n\n| {head} |\n|{'---|' * (3 + len(hosts))}\n"]
        for check, subject in rows:
            found = {
                host: [cells.get((check, subject, host, each)) for each in LIBRARIES]
                for host in hosts
            }
            lines.append(_targets_line(check, subject, found))
        parts += lines if rows else []
    return "".join(parts)


def _targets_line(check, subject, found):
    """A row of a table of every target."""
    results = [each for pair in found.values() for each in pair if each]
    allowed = next((each["allowed"] for each in results if each["allowed"]), "")
    cells = [
        "" if not any(pair) else " / ".join(_cell(each) for each in pair) for pair in found.values()
    ]
    return f"| {' | '.join([check, _mode(subject), allowed, *cells])} |\n"


def _cell(result):
    """An error with its verdict."""
    if not result:
        return "-"
    words = MARKS[result["verdict"]]
    return words if result["verdict"] == NOT_RUN else result["error"] + words


def main():
    """Write the pages, and the data that they show unless --page is given."""
    words = sys.argv[1:]
    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    for host in [] if words == ["--page"] else words or HOSTS:
        data[host] = measured(host)
        write_text(DATA, _text(data))
    for file in (PAGE, RESULTS):
        write_text(file, page(file.read_text(encoding="utf-8"), data[HOST]))
    write_text(TARGETS, targets(data))


def _text(data):
    """The data as JSON, a result in each line."""
    hosts = []
    for host, found in data.items():
        rows = ",\n".join(json.dumps(row) for row in found["results"])
        hosts.append(
            f'{json.dumps(host)}: {{"place": {json.dumps(found["place"])}, "results": [\n{rows}\n]}}'
        )
    return "{" + ",\n".join(hosts) + "}\n"


if __name__ == "__main__":
    main()
