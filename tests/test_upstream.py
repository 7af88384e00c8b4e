# SPDX-License-Identifier: Apache-2.0
"""The pages on defects of MaterialX: each is still there, at its place, and as large."""

import re
from functools import cache

import numpy as np
import pytest

from docs.upstream import update as ledger
from mxeon.models.ggx_albedo import ggx_albedo_dir
from mxeon.models.microfacet_defects import fitted_albedo
from tests.support.availability import available
from tests.support.tolerances import PRINTED

PAGES = [defect.page for defect in ledger.ISSUES] + list(ledger.OF_QUANTITIES)
HEADINGS = ("Measured", "Cause", "Smallest repair", "Why common tests miss it")

# Those of three.js and Babylon.js are measured in tests/shaders/test_host_browser.py.
DEFECTS = [defect for defect in ledger.ISSUES if defect.host not in ("three", "babylon")]
of_each_defect = pytest.mark.parametrize("defect", DEFECTS, ids=lambda each: each.page)


@cache
def judged(host):
    with available(host):
        return ledger.judged(host)


@pytest.mark.parametrize("page", PAGES)
def test_files_and_functions_that_a_page_names_exist(page):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    root = ledger.FOLDER.parents[1]
    for file, function in re.findall(
        r"`((?:docs|genglsl|genosl|python|tests)/[^`:]*)`(?:, `(\w+)`)?", text
    ):
        assert (root / file).is_file(), file
        assert not function or f" {function}(" in (root / file).read_text(), function


def test_every_page_is_in_the_ledger():
    pages = {path.stem for path in ledger.FOLDER.glob("*.md")} - {"README"}
    assert pages == set(PAGES)


@pytest.mark.parametrize("page", PAGES)
def test_every_page_has_all_parts_and_is_listed(page):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    assert [heading for heading in HEADINGS if f"\n## {heading}\n" not in text] == []
    assert f"({page}.md)" in (ledger.FOLDER / "README.md").read_text()


def measured(defect):
    """The block of a page as it is measured here."""
    results, place = judged(defect.host)
    return ledger.block(ledger.shown(defect, results), place)


def of_this_driver(defect):
    """Skip the test of a page about a driver that is not the one here."""
    place = judged(defect.host)[1]
    if defect.page in ledger.OF_DRIVERS and place not in ledger.written(defect.page):
        pytest.skip(f"docs/upstream/{defect.page}.md is about another driver than {place}")


@of_each_defect
def test_no_defect_has_been_repaired_upstream(defect):
    of_this_driver(defect)
    results = ledger.shown(defect, judged(defect.host)[0])
    repaired = [each for each in results if each.verdict == "passed"]
    assert not repaired, f"docs/upstream/{defect.page}.md is out of date: the defect is repaired"


@of_each_defect
def test_the_figures_of_each_page_are_those_of_the_suite(defect):
    of_this_driver(defect)
    written = ledger.figures(ledger.written(defect.page))
    np.testing.assert_allclose(ledger.figures(measured(defect)), written, rtol=PRINTED)


@of_each_defect
def test_the_bounds_and_names_of_each_page_are_those_of_the_suite(defect):
    of_this_driver(defect)
    written = ledger.without_figures(ledger.written(defect.page))
    assert written == ledger.without_figures(measured(defect))


@of_each_defect
def test_each_page_names_device_and_version(defect):
    assert "\nMeasured with " in ledger.written(defect.page)


def test_a_figure_twice_as_large_is_seen():
    text = ledger.written("genglsl_clamped_dot")
    assert ledger.figures(text)[0] == 0.37
    assert ledger.figures(text.replace("0.37", "0.74"))[0] > (1.0 + PRINTED) * 0.37


@pytest.mark.parametrize("page, measure", ledger.OF_QUANTITIES.items())
@pytest.mark.filterwarnings("ignore:.*brings code of its own")
def test_the_quantities_of_each_page_are_those_computed(page, measure):
    with available("cycles" if page.startswith("cycles") else "gl"):
        assert ledger.written(page) == measure()


def test_the_fit_of_ggx_is_as_far_off_as_its_page_says():
    mu, alpha = (v.ravel() for v in np.meshgrid(*2 * [np.geomspace(1e-3, 1.0, 40)]))
    error = abs(fitted_albedo(mu, alpha, 1.0, 1.0) - ggx_albedo_dir(mu, alpha)).max()
    text = (ledger.FOLDER / "genglsl_ggx_fit.md").read_text()
    assert f"Its errors reach {error:.2f}, at low alpha near grazing" in text


@pytest.mark.parametrize("cause", ledger.CAUSES.values(), ids=lambda cause: cause.file)
def test_each_cause_is_at_its_line(cause):
    text = ledger.stock_path(cause).read_text().splitlines()
    assert cause.word in text[cause.line - 1]
    pages = [path.read_text() for path in ledger.FOLDER.glob("*.md")]
    assert any(f"{cause.file}:{cause.line}`" in page for page in pages)
