# SPDX-License-Identifier: Apache-2.0
"""The explorer's page, and a browser that stays open during these tests."""

import pytest

from tests.explorer.browser import launched, opened
from tests.explorer.stage import written
from tests.support.availability import available


@pytest.fixture(scope="package")
def browser():
    """Chromium with its own software driver."""
    with available("webgl"), launched() as browser:
        yield browser


@pytest.fixture(scope="session")
def address(tmp_path_factory):
    """URL of the page without documents."""
    return written(tmp_path_factory.mktemp("explorer") / "explorer.html")


@pytest.fixture(scope="package")
def shared_page(browser, address):
    """The page without documents, with access to the clipboard."""
    permissions = ["clipboard-read", "clipboard-write"]
    with opened(browser, address, permissions=permissions) as page:
        yield page


@pytest.fixture
def page(shared_page):
    """The page with its first view."""
    shared_page.evaluate("mxeon.show(mxeon.fromAddress(''))")
    return shared_page


@pytest.fixture(scope="package")
def undrawn(browser, address):
    """The page without documents and without WebGL."""
    with opened(browser, address, drawn=False) as page:
        yield page


@pytest.fixture(scope="module")
def sources(stage):
    """The identifier of the first source of each model, by the model's name."""
    rows = stage.evaluate("mxeon.data.sources.filter(each => each.kind === 'model')")
    return {row["model"]: row["id"] for row in reversed(rows)}
