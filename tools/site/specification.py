# SPDX-License-Identifier: Apache-2.0
"""Measure the largest errors of stock and eonlib by the specification.

python -m tools.site.specification [HOST ...]  judge both on these hosts (gl if none is named), and write
                                         out/specification.json and the table of results.md
"""

import json
import sys
from contextlib import closing

import MaterialX as mx

from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.conformance.specs import PBRLIB
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT
from tools.site import DOCS, with_block
from tools.site.ledger import SPECIFICATION, figure

PAGE = DOCS / "results.md"
HOST, LIBRARIES = "gl", ("stock", "eonlib")  # the host of the table
JUDGED = (*DIFFUSE, *PBRLIB)
NODES = (*dict.fromkeys(row.node for row in JUDGED if row.node != "eon_diffuse_bsdf"),)
# Rows of the table, and what stock computes.
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


def mode_of(subject):
    """The mode of a subject, without its node; "" where the node has one alone."""
    node, _, mode = subject.partition(", ")
    if sum(row.node == node for row in JUDGED) == 1:
        return ""
    return mode.removeprefix("scatter_").removeprefix("mode ")


def summary(results):
    """A table of what stock computes instead of the specification."""
    errors = {(r["check"], r["subject"], r["library"]): r["error"] for r in results}
    lines = []
    for check, subject, words in SUMMARY:
        stock, eonlib = (errors.get((check, subject, each), "") for each in LIBRARIES)
        mode = mode_of(subject)
        name = f"`{subject.split(',')[0]}`{mode and ', ' + mode}, `{check}`"
        lines.append(f"| {name} | {eonlib} | {stock} | {words} |\n")
    return "\n" + SUMMARY_HEAD + "".join(lines)


def main(words):
    """Write the table, and the data that the ledger takes sizes from."""
    data = json.loads(SPECIFICATION.read_text(encoding="utf-8")) if SPECIFICATION.exists() else {}
    for host in words or (HOST,):
        data[host] = measured(host)
    SPECIFICATION.parent.mkdir(exist_ok=True)
    write_text(SPECIFICATION, json.dumps(data))
    if HOST in data:
        table = summary(data[HOST]["results"])
        write_text(PAGE, with_block(PAGE.read_text(encoding="utf-8"), "measured summary", table))


if __name__ == "__main__":
    main(sys.argv[1:])
