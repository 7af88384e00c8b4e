# SPDX-License-Identifier: Apache-2.0
"""Fixtures with the results of all checks of eonlib and of stock MaterialX on the OpenGL host."""

import pytest

from tests.support.sharing import every_node


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """Results of all checks of eonlib on the OpenGL host."""
    return every_node(tmp_path_factory, "eonlib")


@pytest.fixture(scope="session")
def stock(tmp_path_factory):
    """Results of all checks of stock MaterialX on the OpenGL host."""
    return every_node(tmp_path_factory, "stock")
