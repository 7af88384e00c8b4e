# SPDX-License-Identifier: Apache-2.0
"""Mitsuba, for the tests of its plugins."""

import pytest

from mxeon import mitsuba as plugins
from tests.support.availability import available, package


@pytest.fixture
def mi():
    """Mitsuba in an LLVM variant, with the plugins."""
    mitsuba = package("mitsuba")
    mitsuba.set_variant("llvm_ad_rgb")
    with available("mitsuba"):
        plugins.register()
    return mitsuba
