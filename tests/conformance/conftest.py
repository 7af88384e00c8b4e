# SPDX-License-Identifier: Apache-2.0
"""Runs of the common checks, made once for all tests that read them."""

import pytest

from mxeon.conformance.run import check
from mxeon.shaders.library import examples_folder
from tests.support.sharing import shared

EXAMPLES = [examples_folder() / name for name in ("plaster.mtlx", "openpbr_rough_base.mtlx")]


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """What eonlib does on gl, with two documents."""
    return shared(tmp_path_factory, "eonlib", lambda: check(EXAMPLES, ["gl"], nodes=["common"]))
