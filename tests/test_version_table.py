# SPDX-License-Identifier: Apache-2.0
"""The record of versions of MaterialX, and what upstream pages say of them."""

import json

import pytest

from tests.support.wheels import MAIN
from tools.site import versions
from tools.site.ledger import entries, measure

KNOWN = json.loads(versions.RECORD.read_text())
LAST = versions.VERSIONS[-2:]  # the release, and main
OURS = {page: each for page, each in entries().items() if page in KNOWN["pages"]}


def test_the_record_has_every_page_and_version():
    issues = [each for each in measure.CHECKED if each.library == "stock"]
    assert set(KNOWN["pages"]) == {each.page for each in issues if each.host in ("gl", "source")}
    assert all(tuple(each) == versions.VERSIONS for each in KNOWN["pages"].values())


def test_the_record_is_of_the_main_of_the_tests():
    first = (MAIN.parent / "commits.txt").read_text().split(" ", 2)
    assert KNOWN["commit"] == first[:2]


def test_eonlib_passes_with_the_release_and_with_main():
    assert [KNOWN["open"][name] for name in LAST] == [{}, {}]


@pytest.mark.parametrize("page", OURS)
def test_a_page_whose_checks_pass_in_main_names_what_repaired_it(page):
    assert not KNOWN["pages"][page]["main"]["passed"] or OURS[page].pull
