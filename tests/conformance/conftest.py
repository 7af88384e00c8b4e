# SPDX-License-Identifier: Apache-2.0
"""Every node and two documents on gl with each library, judged once for all tests that read the results."""

import pytest

import mxeon
from mxeon.shaders.library import examples_folder
from tests.support.sharing import shared

EXAMPLES = [examples_folder() / name for name in ("plaster.mtlx", "openpbr_rough_base.mtlx")]


def every_node(factory, library):
    return shared(factory, library, lambda: mxeon.check(EXAMPLES, ["gl"], [library], nodes=["all"]))


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """What eonlib does."""
    return every_node(tmp_path_factory, "eonlib")


@pytest.fixture(scope="session")
def stock(tmp_path_factory):
    """What MaterialX does by itself."""
    return every_node(tmp_path_factory, "stock")
