# SPDX-License-Identifier: Apache-2.0
"""Results of each library on gl."""

import pytest

from tests.support.sharing import every_node


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """Results of eonlib."""
    return every_node(tmp_path_factory, "eonlib")


@pytest.fixture(scope="session")
def stock(tmp_path_factory):
    """Results of stock MaterialX."""
    return every_node(tmp_path_factory, "stock")
