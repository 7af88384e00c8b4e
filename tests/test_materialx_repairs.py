# SPDX-License-Identifier: Apache-2.0
"""The smallest repairs of MaterialX's data: with them, the checks that show the defects pass."""

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
# Slang compiles the repaired node; what is left is its fit.
OF_SLANG = ("output", "blackbody", "slang")


def hosted(row, pairs):
    return [(*pair, row.issue.get("host", "gl")) for pair in pairs]


ROWS = list(dict.fromkeys(each for row in ledger.rows() for each in hosted(row, row.repaired)))
REMAINS = {
    each: words
    for row in ledger.rows()
    for words, pairs in row.remains.items()
    for each in hosted(row, pairs)
}
# Judges rows of stock MaterialX, and prints what it found.
JUDGE = """
import json, sys
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import EVERY_NODE, SOURCE, Task
from mxeon.shaders.document.policy import DEFAULT
judge = Judge(DEFAULT)
results = {}
for check, subject, host in json.loads(sys.argv[1]):
    task = Task(check, EVERY_NODE if host == SOURCE else subject, host, "stock")
    [result] = [
        each
        for each in judge.work(task).results
        if (each.check, each.subject) == (check, subject)
    ]
    results["|".join((check, subject, host))] = result.verdict, result.diagnosis
judge.close()
print(json.dumps(results))
"""


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """Verdict and diagnosis of each row with a repaired MaterialX."""
    with available("gl"), available("slang"):
        path = [str(repairs.repaired(tmp_path_factory.mktemp("repaired"))), str(ROOT / "python")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path)}
    command = [sys.executable, "-c", JUDGE, json.dumps([*ROWS, *REMAINS, OF_SLANG])]
    run = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert run.returncode == 0, run.stderr
    return {tuple(key.split("|")): result for key, result in json.loads(run.stdout).items()}


@pytest.mark.parametrize("row", ROWS, ids=" ".join)
def test_a_repair_makes_the_checks_pass_that_show_the_defect(judged, row):
    verdict, diagnosis = judged[row]
    assert verdict == PASSED, diagnosis


@pytest.mark.parametrize("row", REMAINS, ids=" ".join)
def test_what_remains_has_another_cause(judged, row):
    verdict, diagnosis = judged[row]
    assert verdict == PASSED or diagnosis.startswith(f"{REMAINS[row]} (rms ")


def test_slang_compiles_the_black_body_that_is_repaired(judged):
    assert judged[OF_SLANG][1].startswith("nearest known model: Kang's cubic")


@pytest.mark.parametrize("change", repairs.REPAIRS, ids=lambda each: each.page)
def test_each_repair_is_of_its_file_and_on_its_page(change):
    assert change.old in (repairs.installed() / change.file).read_text("utf-8")
    page = (Path(repairs.__file__).parent / f"{change.page}.md").read_text("utf-8")
    assert Path(change.file).name in page
    added = [line.strip() for line in change.new.splitlines() if line not in change.old]
    assert [line for line in added if line not in page] == []
