# SPDX-License-Identifier: Apache-2.0
"""The explorer's page, and a browser for it, which ends with these tests."""

import pytest

from mxeon.explorer import page, page_data
from mxeon.io.files import write_text
from tests.explorer.browser import launched
from tests.support.availability import available


@pytest.fixture(scope="package")
def browser():
    """Chromium with its own software driver."""
    with available("webgl"), launched() as browser:
        yield browser


@pytest.fixture(scope="session")
def address(tmp_path_factory):
    """Address of the page without documents."""
    file = tmp_path_factory.mktemp("explorer") / "explorer.html"
    write_text(file, page(page_data()))
    return file.as_uri()
