# SPDX-License-Identifier: Apache-2.0
"""Fixtures with the explorer's page, in a browser that stays open during this folder's tests."""

import pytest

from tests.explorer.browser import launched, opened
from tests.explorer.stage import written
from tests.support.availability import available


@pytest.fixture(scope="package")
def browser():
    with available("webgl"), launched() as browser:
        yield browser


@pytest.fixture(scope="session")
def address(tmp_path_factory):
    """URL of an explorer page without documents."""
    return written(tmp_path_factory.mktemp("explorer") / "explorer.html")


@pytest.fixture(scope="package")
def shared_page(browser, address):
    """Explorer page without documents, with access to the clipboard."""
    permissions = ["clipboard-read", "clipboard-write"]
    with opened(browser, address, permissions=permissions) as page:
        yield page


@pytest.fixture
def page(shared_page):
    """The shared explorer page, reset to the initial view."""
    shared_page.evaluate("mxeon.show(mxeon.fromAddress(''))")
    return shared_page


@pytest.fixture(scope="package")
def undrawn(browser, address):
    """Explorer page without documents and without WebGL."""
    with opened(browser, address, drawn=False) as page:
        yield page


@pytest.fixture(scope="module")
def sources(stage):
    """Identifier of the first source of each model, by the model's name."""
    rows = stage.evaluate("mxeon.data.sources.filter(each => each.kind === 'model')")
    return {row["model"]: row["id"] for row in reversed(rows)}
