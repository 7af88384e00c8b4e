# SPDX-License-Identifier: Apache-2.0
"""Measures the largest deviations of stock MaterialX and eonlib from the specification.

`python -m tools.site.specification` measures the table in results.md on gl, in a few seconds.
"""

from contextlib import closing

from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.io.files import write_text
from mxeon.shaders.document.policy import DEFAULT
from tools.site import DOCS, with_block
from tools.site.ledger import figure

PAGE = DOCS / "results.md"
HOST, LIBRARIES = "gl", ("stock", "eonlib")
# Each row has a check, a subject, and a description of what stock MaterialX computes.
SUMMARY = (
    ("value", "sheen_bsdf, mode zeltner", "a singular frame where the viewer is along the normal"),
    ("transmitted", "dielectric_bsdf, scatter_mode RT", "a division by the masking G1"),
    ("each_lobe", "chiang_hair_bsdf", "a last lobe that is pi^2 too bright"),
    ("value", "generalized_schlick_bsdf, thin film", "half of the substrate's reflectance"),
    ("layer", "dielectric_bsdf, scatter_mode R", "a fitted throughput"),
    ("lobes_energy", "gltf_pbr, every lobe", "layers that create light"),
    ("frame", "translucent_bsdf", "light from the wrong side, seen from behind"),
    ("lossless", "conductor_bsdf", "fitted energy compensation"),
    ("transmission", "sheen_bsdf, mode zeltner", "a throughput of 1 for light through the base"),
    ("environment", "sheen_bsdf, mode conty_kulla", "a fit"),
    ("environment", "burley_diffuse_bsdf", "a fit"),
    (
        "layer",
        "generalized_schlick_bsdf, scatter_mode R",
        "a throughput of the mean color, without the exponent",
    ),
    ("output", "blackbody", "a fit beyond its range"),
)
SUMMARY_HEAD = (
    "| check | eonlib | stock MaterialX 1.39.5 | what stock computes |\n|---|---|---|---|\n"
)


def measured():
    """Results of all checks in the table, with stock MaterialX and with eonlib."""
    rows = {row[:2] for row in SUMMARY}
    nodes = sorted({subject.split(",")[0] for _, subject in rows})
    tasks = make_plan((), (HOST,), LIBRARIES, nodes=nodes).tasks
    chosen = [task for task in tasks if task.host == HOST and (task.check, task.subject) in rows]
    with closing(Judge(DEFAULT)) as judge:
        return [result for task in chosen for result in judge.work(task).results]


def summary(results):
    """Markdown table of errors of both libraries relative to the specification."""
    errors = {
        (each.check, each.subject, each.library): "" if each.error is None else figure(each)
        for each in results
    }
    lines = []
    for check, subject, form in SUMMARY:
        stock, eonlib = (errors.get((check, subject, each), "") for each in LIBRARIES)
        lines.append(f"| `{check}` of {subject} | {eonlib} | {stock} | {form} |\n")
    return "\n" + SUMMARY_HEAD + "".join(lines)


if __name__ == "__main__":
    table = summary(measured())
    write_text(PAGE, with_block(PAGE.read_text(encoding="utf-8"), "measured summary", table))
