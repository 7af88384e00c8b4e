# SPDX-License-Identifier: Apache-2.0
"""What each library does on gl."""

import pytest

from tests.support.sharing import every_node


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """What eonlib does."""
    return every_node(tmp_path_factory, "eonlib")


@pytest.fixture(scope="session")
def stock(tmp_path_factory):
    """What MaterialX does by itself."""
    return every_node(tmp_path_factory, "stock")
