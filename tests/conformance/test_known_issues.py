# SPDX-License-Identifier: Apache-2.0
"""The rows of the ledger against the tables of what stock MaterialX fails, in the tests of its nodes."""

from dataclasses import replace

import pytest

from mxeon.conformance.results import FAILED, Result
from mxeon.conformance.results.known_issues import ISSUES, with_pages
from mxeon.conformance.results.known_issues.issue import STOCK
from tests.conformance import test_bsdfs as bsdfs
from tests.conformance import test_emission as emission
from tests.conformance import test_hair as hair
from tests.conformance import test_thin_films as films
from tests.conformance import test_transmission as transmission

# Title of a subject, and the checks that its test finds failing or differing on gl.
TABLES = {
    **{
        bsdfs.SUBJECTS[model].title: {*rows, *(bsdfs.OPEN if model in bsdfs.MICROFACETS else ())}
        for model, rows in bsdfs.STOCK.items()
    },
    **{transmission.SUBJECTS[model].title: set(rows) for model, rows in transmission.STOCK.items()},
    **{title: set(rows) for title, rows in emission.STOCK.items()},
    **{f"{node}, thin film": set(rows) for node, rows in films.STOCK.items()},
    hair.SUBJECT.title: set(hair.STOCK),
}


@pytest.mark.parametrize("title", TABLES)
def test_the_ledger_has_each_departure_of_stock_and_shows_no_other(title):
    issues = [each for each in ISSUES if each.host == "gl" and each.library == STOCK]
    shown = {check for issue in issues for check, subject in issue.rows if subject == title}
    implied = {check for issue in issues for check, subject in issue.implied if subject == title}
    assert shown <= TABLES[title] <= shown | implied


def test_a_failure_that_no_text_can_avoid_has_its_page_with_each_library():
    failed = [
        Result("inputs", "", "conductor_bsdf", "osl", library, FAILED, 1.0, "inputs", 0.0)
        for library in (STOCK, "eonlib")
    ]
    pages = ("genosl_dropped_retroreflection",)
    assert [with_pages(each).pages for each in failed] == [pages, pages]
    mode = Result("value", "", "sheen_bsdf, mode zeltner", "osl", STOCK, FAILED, 1.0, "inputs", 0.0)
    assert with_pages(mode).pages == ("genosl_dropped_mode",)
    assert with_pages(replace(mode, library="eonlib")).pages == ()
