# SPDX-License-Identifier: Apache-2.0
"""The report page works in a browser without a network, and without scripts."""

from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from mxeon import check
from mxeon.report import write
from mxeon.shaders.library import examples_folder
from tests.explorer.browser import launched, watched
from tests.support.availability import available
from tests.support.plans import keep_checks

EXAMPLE = examples_folder() / "plaster.mtlx"


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    with pytest.MonkeyPatch.context() as patch:
        keep_checks(patch, "host", "source", "value", "environment", "picture")
        run = check([EXAMPLE], ["gl", "msl"], ["eonlib", "stock"], nodes=["common"])
    return write(run, folder).as_uri()


@pytest.fixture(scope="module")
def browser():
    """Headless Chromium, which stays open during these tests."""
    with available("webgl"), launched() as browser:
        yield browser


@contextmanager
def opened(browser, address, **options):
    """Open the report page. Network requests and console messages fail the test."""
    page = browser.new_page(**options)
    with watched(page, address):
        yield page
        page.close()


def visible(page, selector):
    return page.locator(f"{selector} >> visible=true").count()


def test_a_cell_of_the_matrix_leads_to_its_evidence(browser, address):
    with opened(browser, address) as page:
        page.locator("summary", has_text="Overview by host").click()
        cell = page.locator(".matrix a").first
        target = cell.get_attribute("href")
        cell.click()
        page.wait_for_selector(f"details{target}[open]")
        assert page.locator(f"{target} > summary").is_visible()  # the click unfolds the details


def test_a_failure_leads_to_the_page_on_its_defect(browser, address):
    with opened(browser, address) as page:
        found = page.locator(".figures a[href^='upstream/']").first.get_attribute("href")
    file = Path(urlsplit(address).path).parent / found
    assert file.read_text(encoding="utf-8").startswith("# ")


def test_without_a_script_all_tables_are_there(browser, address):
    with opened(browser, address, java_script_enabled=False) as page:
        assert visible(page, "input") == 0
        for summary in page.locator("details:not([open]) > summary").all()[::-1]:
            summary.evaluate("each => each.parentElement.open = true")
        checks = page.locator("details[id^=check-]").count()
        assert visible(page, ".matrix td a") == checks > 5
        assert page.locator("details[id^=audit-]").count() > 0
        assert visible(page, ".figures tbody tr") > checks
