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


CLAMPED = "best match: EON with clamped dot(wo, wi) (rms 0.001), then Lambert (0.2)"
FIT = "best match: MaterialX's fit of its albedo (rms 9e-09), then Conty-Kulla sheen (0.01)"
EON, SHEEN = "oren_nayar_diffuse_bsdf, energy_compensation true", "sheen_bsdf, mode conty_kulla"


@pytest.mark.parametrize(
    "check, subject, error, diagnosis, pages",
    [
        ("value", EON, 0.369, CLAMPED, ("genglsl_clamped_dot",)),
        ("value", EON, 3.69, CLAMPED, ()),
        ("value", EON, 0.3, "best match: Lambert (rms 0.001), then EON (0.2)", ()),
        ("value", EON, 0.3, "fault: the cosine of the light is missing (rms 1e-08)", ()),
        ("environment", SHEEN, 0.0889, FIT, ("genglsl_conty_kulla_fit",)),
        ("environment", SHEEN, 1e7, FIT, ()),
        (
            "environment",
            SHEEN,
            0.05,
            "no known model matches, the closest is Conty-Kulla sheen (rms",
            (),
        ),
    ],
)
def test_a_page_explains_an_error_of_its_size_and_its_model(
    check, subject, error, diagnosis, pages
):
    result = Result(check, "", subject, "gl", STOCK, FAILED, error, "", 1e-6, diagnosis=diagnosis)
    assert with_pages(result).pages == pages


def test_no_page_on_a_value_explains_a_shader_that_does_not_compile():
    broken = Result("output", "", "blackbody", "slang", STOCK, FAILED, diagnosis="slang: refused")
    assert with_pages(broken).pages == ("genslang_blackbody_constant",)
