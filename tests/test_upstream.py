# SPDX-License-Identifier: Apache-2.0
"""The ledger says what is so: each defect is still there, where its page has it, and as large."""

from functools import lru_cache

import pytest
from availability import available

from upstream import ledger

PAGES = [defect.page for defect in ledger.DEFECTS] + list(ledger.OF_QUANTITIES)
HEADINGS = ("Measured", "Cause", "Smallest repair", "Why common tests miss it")

of_each_defect = pytest.mark.parametrize("defect", ledger.DEFECTS, ids=lambda each: each.page)


@lru_cache(maxsize=None)
def judged(host):
    with available(host):
        return ledger.judged(host)


def test_every_page_is_in_the_ledger():
    pages = {path.stem for path in ledger.FOLDER.glob("*.md")} - {"README"}
    assert pages == set(PAGES)


@pytest.mark.parametrize("page", PAGES)
def test_every_page_has_all_parts_and_is_listed(page):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    assert [heading for heading in HEADINGS if f"\n## {heading}\n" not in text] == []
    assert f"({page}.md)" in (ledger.FOLDER / "README.md").read_text()


@of_each_defect
def test_no_defect_has_been_repaired_upstream(defect):
    repaired = [
        each for each in ledger.shown(defect, judged(defect.host)) if each.verdict == "passed"
    ]
    assert not repaired, f"upstream/{defect.page}.md is out of date: the defect is repaired"


@of_each_defect
def test_the_figures_of_each_page_are_those_of_the_suite(defect):
    assert ledger.written(defect.page) == ledger.block(ledger.shown(defect, judged(defect.host)))


@pytest.mark.parametrize("page, made", ledger.OF_QUANTITIES.items())
def test_the_quantities_of_each_page_are_those_computed(page, made):
    assert ledger.written(page) == made()


@pytest.mark.parametrize("cause", ledger.CAUSES.values(), ids=lambda cause: cause.file)
def test_each_cause_is_at_its_line(cause):
    text = ledger.stock_path(cause).read_text().splitlines()
    assert cause.word in text[cause.line - 1]
    pages = [path.read_text() for path in ledger.FOLDER.glob("*.md")]
    assert any(f"{cause.file}:{cause.line}`" in page for page in pages)
