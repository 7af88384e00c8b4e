# SPDX-License-Identifier: Apache-2.0
"""The smallest repairs of MaterialX's GLSL: with them, the checks that show the defects pass."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from docs.upstream import ledger
from docs.upstream import materialx_repairs as repairs
from mxeon.conformance.results import PASSED
from tests.support.availability import available

ROOT = Path(__file__).resolve().parents[1]
# With the color, what is left is an error of the fit.
OF_FIT = ("transmission", "sheen_bsdf, mode conty_kulla")
# What is left are roundings of the driver's arc tangent.
OF_DRIVER = tuple(
    (check, "chiang_hair_bsdf")
    for check in ("value", "narrow_lobes", "tilted_lobes", "wide_lobes", "each_lobe")
)
ROWS = [pair for row in ledger.rows() for pair in row.repaired]
ROUNDING = (
    1.5  # tolerances of the value of a sharp Zeltner lobe in float32, from aInv w.x + bInv w.z
)
# Judges rows of stock MaterialX on gl, and prints what it found.
JUDGE = """
import json, sys
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import Task
from mxeon.shaders.document.policy import DEFAULT
judge = Judge(DEFAULT)
results = {}
for row in json.loads(sys.argv[1]):
    [result] = judge.work(Task(*row, "gl", "stock")).results
    results["|".join(row)] = result.verdict, result.diagnosis
judge.close()
print(json.dumps(results))
"""


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """Verdict and diagnosis of each row with a repaired MaterialX."""
    with available("gl"):
        path = [str(repairs.repaired(tmp_path_factory.mktemp("repaired"))), str(ROOT / "python")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path)}
    command = [sys.executable, "-c", JUDGE, json.dumps(ROWS)]
    run = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert run.returncode == 0, run.stderr
    return {tuple(key.split("|")): result for key, result in json.loads(run.stdout).items()}


@pytest.mark.parametrize(
    "row", [row for row in ROWS if row not in (OF_FIT, *OF_DRIVER)], ids=" ".join
)
def test_a_repair_makes_the_checks_pass_that_show_the_defect(judged, row):
    verdict, diagnosis = judged[row]
    assert verdict == PASSED, diagnosis


def test_the_sheen_that_is_repaired_has_no_defect_but_its_fit(judged):
    diagnosis = judged[OF_FIT][1]
    assert diagnosis.startswith("nearest known model: MaterialX's fit of its albedo (rms ")


@pytest.mark.parametrize("row", OF_DRIVER, ids=" ".join)
def test_the_hair_that_is_repaired_is_right_but_for_the_arc_tangent_of_the_driver(judged, row):
    verdict, diagnosis = judged[row]
    assert verdict == PASSED or diagnosis.startswith("the model is right, Chiang hair (rms ")


@pytest.mark.parametrize("change", repairs.REPAIRS, ids=lambda each: each.page)
def test_each_repair_is_of_its_file_and_on_its_page(change):
    assert change.old in (repairs.installed() / change.file).read_text("utf-8")
    page = (Path(repairs.__file__).parent / f"{change.page}.md").read_text("utf-8")
    assert Path(change.file).name in page
    added = [line.strip() for line in change.new.splitlines() if line not in change.old]
    assert [line for line in added if line not in page] == []
