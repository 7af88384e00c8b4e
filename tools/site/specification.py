# SPDX-License-Identifier: Apache-2.0
"""Measure what the page on the specification shows, and its summaries.

python -m tools.site.specification [HOST ...]  judge stock and eonlib on these hosts, on all of HOSTS if none is
                                         named; write out/specification.json and the pages
python -m tools.site.specification --page      the pages alone, from out/specification.json
"""

import json
import re
import sys
import textwrap
from collections import Counter
from contextlib import closing

import MaterialX as mx

from mxeon.conformance.results import DIFFERS, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.conformance.specs import PBRLIB
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT
from tools.site import DOCS
from tools.site.ledger import SPECIFICATION, figure

PAGE, RESULTS = DOCS / "specification.md", DOCS / "results.md"
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
    ("value", "generalized_schlick_bsdf, thin film", "half of the substrate's reflectance"),
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
        "a throughput without the exponent, of the mean color",
    ),
    ("output", "blackbody", "a fit beyond its range"),
)
SUMMARY_HEAD = (
    "| check | eonlib | stock MaterialX 1.39.5 | what stock computes |\n|---|---|---|---|\n"
)
HEAD = "| check | mode | tolerance | stock | eonlib | stock's defect |\n|---|---|---|---|---|---|\n"


def measured(host):
    """Where a host ran, and its results of the nodes with both libraries, as rows of text."""
    plans = [make_plan((), (host,), (library,), nodes=NODES) for library in LIBRARIES]
    tasks = [task for plan in plans for task in plan.tasks]
    with closing(Judge(DEFAULT)) as judge:
        findings = [
            judge.work(t) for t in tasks if t.host == host and t.check not in ("curve", "host")
        ]
    [device] = findings[0].hosts
    results = [
        {
            "check": each.check,
            "subject": each.subject,
            "library": each.library,
            "verdict": each.verdict,
            "error": "" if each.error is None else figure(each),
            "allowed": "" if each.tolerance is None else f"{each.tolerance:.2g} {each.unit}",
        }
        for finding in findings
        for each in finding.results
    ]
    place = f"{device.device}, {device.version}, MaterialX {mx.__version__}"
    return {"place": place, "results": results}


def page(text, data):
    """The page, with its tables from the data of all hosts."""

    def table(name):
        if name == "targets":
            return targets(data)
        results = data[HOST]["results"]
        return summary(results) if name == "summary" else node_table(name, results)

    return BLOCK.sub(lambda found: found[1] + table(found[2]) + found[3], text)


def mode_of(subject):
    """The mode of a subject, without its node; "" where the node has one alone."""
    node, _, mode = subject.partition(", ")
    if sum(row.node == node for row in JUDGED) == 1:
        return ""
    return mode.removeprefix("scatter_").removeprefix("mode ")


def summary(results):
    """A table of what stock computes in place of the specification."""
    errors = {(r["check"], r["subject"], r["library"]): r["error"] for r in results}
    lines = []
    for check, subject, words in SUMMARY:
        stock, eonlib = (errors.get((check, subject, each), "") for each in LIBRARIES)
        mode = mode_of(subject)
        name = f"`{subject.split(',')[0]}`{mode and ', ' + mode}, `{check}`"
        lines.append(f"| {name} | {eonlib} | {stock} | {words} |\n")
    return "\n" + SUMMARY_HEAD + "".join(lines)


def node_table(node, results):
    """What does not pass of a node with either library, with links to stock's defects, and what passes with both."""
    rows = {}
    for each in results:
        if each["subject"].split(",")[0] == node:
            rows.setdefault((each["check"], each["subject"]), {})[each["library"]] = each
    lines, passed = [], {}
    for (check, subject), found in rows.items():
        both = [found.get(each) for each in LIBRARIES]
        if all(each and each["verdict"] == PASSED for each in both):
            passed.setdefault(check, []).append(mode_of(subject))
            continue
        # An error and its verdict; a dash where the check was not asked.
        errors = [
            ", ".join(filter(None, (each["error"], each["verdict"]))) if each else "-"
            for each in both
        ]
        allowed = next((each["allowed"] for each in both if each and each["allowed"]), "")
        pages = dict.fromkeys(
            issue.page
            for issue in ISSUES
            if issue.host == HOST and (check, subject) in (*issue.rows, *issue.implied)
        )
        links = (
            f"[{each.partition('_')[2].replace('_', ' ')}](upstream/{each}.md)" for each in pages
        )
        only = "all" if len({subject for _, subject in rows}) == 1 else "alone"
        cells = check, mode_of(subject) or only, allowed, *errors, ", ".join(links)
        lines.append(f"| {' | '.join(cells)} |\n")
    # The modes that pass, where those are not all.
    everything = {mode_of(subject) for _, subject in rows}
    words = ", ".join(
        f"`{check}`"
        + (set(modes) != everything) * f" ({'; '.join(each or 'alone' for each in modes)})"
        for check, modes in passed.items()
    )
    parts = [HEAD + "".join(lines)] if lines else []
    parts += [textwrap.fill(f"Passed with both: {words}.", 120) + "\n"] if words else []
    return "\n" + "\n".join(parts)


def targets(data):
    """How many checks of each node pass, or differ where the text permits it, on each host, with stock / eonlib."""
    hosts = [host for host in HOSTS if host in data]
    lines = [f"- `{host}`: {HOSTS[host]}, {data[host]['place']}\n" for host in hosts]
    lines.append(f"\n| node | {' | '.join(hosts)} |\n|{'---|' * (1 + len(hosts))}\n")
    for node in NODES:
        cells = []
        for host in hosts:
            shares = []
            for library in LIBRARIES:
                counts = Counter(
                    each["verdict"]
                    for each in data[host]["results"]
                    if each["library"] == library and each["subject"].split(",")[0] == node
                )
                asked, right = counts.total() - counts[NOT_RUN], counts[PASSED] + counts[DIFFERS]
                words = "all" if right == asked else f"{right} of {asked}"
                shares.append(words if asked else "-")
            cells.append("" if shares == ["-", "-"] else " / ".join(shares))
        lines.append(f"| {node} | {' | '.join(cells)} |\n")
    return "\n" + "".join(lines)


def main(words):
    """Write the pages, and the data that they show unless --page is given."""
    data = json.loads(SPECIFICATION.read_text(encoding="utf-8")) if SPECIFICATION.exists() else {}
    for host in [] if words == ["--page"] else words or HOSTS:
        data[host] = measured(host)
        SPECIFICATION.parent.mkdir(exist_ok=True)
        write_text(SPECIFICATION, json.dumps(data))
    for file in (PAGE, RESULTS):
        write_text(file, page(file.read_text(encoding="utf-8"), data))


if __name__ == "__main__":
    main(sys.argv[1:])
