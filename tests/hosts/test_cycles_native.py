# SPDX-License-Identifier: Apache-2.0
"""Blender's own nodes, without OSL, judged as one more renderer."""

from dataclasses import replace
from functools import partial

import pytest

from mxeon.conformance.backends import CYCLES_NOISE, PICTURE_SIZE, mean_noise, own_nodes
from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.run import check
from mxeon.hosts import open_engine
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import sphere
from mxeon.survey.backends import Native
from tests.support.availability import available
from tests.support.plans import keep_host
from tests.support.sharing import shared

NATIVE = own_nodes("cycles-native")
EXAMPLE = examples_folder() / "plaster.mtlx"
SIZE = PICTURE_SIZE // 2  # the bound of so few pixels is twice as wide; the defect is off by 0.1


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    with available("cycles-native"):
        open_engine("cycles-native").close()
    libraries = ["eonlib", "stock"]
    small = replace(CYCLES_NOISE, terms=(mean_noise(int(sphere(SIZE).mask.sum())),))
    with pytest.MonkeyPatch.context() as patch:
        keep_host(patch, "cycles-native")
        patch.setattr(Native, "size", SIZE)
        patch.setattr(Native, "errors", Native.errors | {"albedo": small})
        make = partial(check, [EXAMPLE], ["cycles-native"], libraries, nodes=["common"])
        return shared(tmp_path_factory, "native", make).results


@pytest.mark.parametrize("subject", NATIVE, ids=lambda each: each.title)
def test_blender_has_one_power_of_the_color_too_many(results, subject):
    found = {each.check: each for each in results if each.subject == subject.title}
    failed = {key for key, each in found.items() if each.verdict == FAILED}
    assert failed == {"value", "environment"}
    assert all(each.control.caught for each in found.values())
    assert "best match: EON with rho^3" in found["value"].diagnosis
    assert found["value"].distances["EON with rho^3"] < 1e-6
    assert found["environment"].error > 100.0 * found["environment"].tolerance
    assert {found[key].verdict for key in ("furnace", "black", "lambert", "inputs")} == {PASSED}
