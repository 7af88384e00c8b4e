# SPDX-License-Identifier: Apache-2.0
"""The choice of processors under which the tests of numbers run."""

import itertools
import re
from pathlib import Path

from tests.reliability import documents, processors
from tests.support.documents import lobe, material

REPORT = """<testsuites><testsuite>
  <testcase name="a"/><testcase name="b"><failure/></testcase>
  <testcase name="c"><skipped/></testcase><testcase name="d"><error/></testcase>
</testsuite></testsuites>"""


def test_every_choice_leaves_out_one_level_more_than_the_last():
    simd = [set(value.split()) for name, value in processors.choices() if name == processors.SIMD]
    assert simd[0] == set()
    assert all(len(more - less) == 1 and less < more for less, more in itertools.pairwise(simd))


def test_every_file_of_tests_with_a_tolerance_is_run_or_left_out_by_name():
    files = [path for path in Path(__file__).parent.rglob("test_*.py") if path != Path(__file__)]
    pattern = re.compile("^from tests.support(.tolerances)? import", re.MULTILINE)
    rest = {path.stem for path in files if pattern.search(path.read_text())}
    assert rest <= {f"test_{name}" for name in processors.FILES + processors.COARSE}


def test_a_report_is_counted():
    assert processors.counts(REPORT) == {"passed": 1, "failed": ["b", "d"], "skipped": 1}


def test_a_document_is_generated_by_materialx_and_by_mxeon_or_the_reason_is_told(tmp_path):
    texts = {
        "right": material(lobe()),
        "infinite": material(lobe(roughness=0.5)).replace('"0.5"', '"inf"'),
        "empty": '<materialx version="1.39"/>',
    }
    for name, text in texts.items():
        (tmp_path / f"{name}.mtlx").write_text(text)
    reasons = {name: documents.attempt((str(tmp_path / f"{name}.mtlx"), "msl")) for name in texts}
    assert reasons["right"] == ("", "", "")
    plain, stock, eonlib = reasons["infinite"]
    assert plain == "" and "finite numbers" in stock == eonlib
    assert all(reasons["empty"])
