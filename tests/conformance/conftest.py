# SPDX-License-Identifier: Apache-2.0
"""Runs of the checks, made once for all tests that read them."""

from functools import partial

import pytest

from mxeon.conformance.run import check
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep_diffuse
from tests.support.sharing import shared

EXAMPLES = [examples_folder() / name for name in ("plaster.mtlx", "openpbr_rough_base.mtlx")]


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """What eonlib does on gl, with two documents."""
    return shared(tmp_path_factory, "eonlib", lambda: check(EXAMPLES, ["gl"], nodes=["common"]))


@pytest.fixture(scope="session")
def stock(tmp_path_factory):
    """What MaterialX does by itself on gl with one document, without the other nodes of pbrlib."""
    with pytest.MonkeyPatch.context() as patch:
        keep_diffuse(patch)
        make = partial(check, EXAMPLES[:1], ["gl"], ["stock"], nodes=["common"])
        return shared(tmp_path_factory, "stock", make)
