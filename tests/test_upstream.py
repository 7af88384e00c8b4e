# SPDX-License-Identifier: Apache-2.0
"""All defects in the ledger of upstream defects still exist, with the sizes that were measured."""

import json
from functools import cache, partial

import MaterialX as mx
import numpy as np
import pytest

from mxeon.conformance.results.known_issues import EONLIB, STOCK
from mxeon.errors import NotRun
from tests.support.availability import available
from tests.support.sharing import every_node, shared
from tests.support.tolerances import PRINTED
from tests.support.verdicts import SOURCE
from tools.site.ledger import FOLDER, measure, measured, patches, with_patches

MEASURED = measured()
OF_A_DRIVER = "genglsl_albedo_acos"  # the size of this defect depends on the graphics driver
# tests/hosts/test_browser.py measures the defects of three.js and Babylon.js.
ISSUES = [each for each in measure.CHECKED if each.host not in ("three", "babylon")]


def test_a_page_with_a_patch_says_what_it_changes():
    assert json.loads(json.dumps(with_patches(MEASURED))) == MEASURED


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """Function that returns the results for a host's defects, and the place of the measurement."""

    @cache
    def outcome(host, library):
        """Results and the place of the measurement, or the reason why the host did not run."""
        if host in ("gl", SOURCE) and library == STOCK:
            run = every_node(tmp_path_factory, "stock")
            place = f"{run.hosts[0].device}, {run.hosts[0].version}, MaterialX {mx.__version__}"
            return (run.results, place), None
        try:
            make = partial(measure.judged, host, (), library)
            return shared(tmp_path_factory, f"defects on {host}, {library}", make), None
        except NotRun as reason:
            return None, reason

    def results(host, library=STOCK):
        found, reason = outcome(host, library)
        with available(host):
            if reason:
                raise reason
        return found

    return results


@pytest.mark.whole
@pytest.mark.parametrize("issue", ISSUES)
def test_each_defect_is_still_there_and_as_its_page_says(judged, issue):
    results, place = judged(issue.host, EONLIB if issue.library == EONLIB else STOCK)
    written = MEASURED[issue.page]
    if issue.page == OF_A_DRIVER and place != written["place"]:
        pytest.skip(f"docs/upstream/{issue.page}.md is about another driver than {place}")
    passed = {(each.check, each.subject) for each in results if each.verdict == "passed"}
    repaired = passed & {*issue.rows}
    assert not repaired, f"docs/upstream/{issue.page}.md is out of date: the defect is repaired"
    same_record(measure.record(issue, results, place), written)


@pytest.mark.whole
def test_every_failure_of_stock_on_gl_has_a_page_that_explains_its_size(judged):
    results, _ = judged("gl")
    failed = [each for each in results if each.verdict == "failed" and ".mtlx" not in each.subject]
    assert {(each.check, each.subject) for each in failed if not each.pages} == set()


def same_record(found, written):
    """Assert that measurements match the measurements on a page up to the printed digits."""
    figures, others = zip(*map(_parted, (found, written)), strict=True)
    np.testing.assert_allclose(*figures, rtol=PRINTED)
    assert others[0] == others[1]


def _parted(record):
    """Split a record into figures and other fields, without the place of the measurement."""
    rows = [[check, subject, *rest] for check, subject, _, *rest in record["rows"]]
    return [float(row[2]) for row in record["rows"]], (rows, record["cause"], record.get("next"))


def test_every_picture_is_of_a_page_with_a_patch():
    assert {path.stem for path in (FOLDER / "pictures").iterdir()} <= set(patches("materialx"))
