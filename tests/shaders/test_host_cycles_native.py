# SPDX-License-Identifier: Apache-2.0
"""Blender's own nodes, without OSL, judged as one more renderer."""

import pytest

from mxeon.conformance.checks import nodes
from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.run import check
from mxeon.shaders.hosts import open_host
from mxeon.shaders.library import examples_folder
from tests.support.availability import available

NATIVE = nodes.NATIVE["cycles-native"]
EXAMPLE = examples_folder() / "plaster.mtlx"


@pytest.fixture(scope="module")
def results():
    with available("cycles-native"):
        open_host("cycles-native").close()
    run = check([EXAMPLE], ["cycles-native"], ["eonlib", "stock"])
    return [each for each in run.results if each.host == "cycles-native"]


def test_every_node_is_judged_once_whatever_the_libraries(results):
    results = [each for each in results if each.check != "document"]  # read once for each library
    keys = [(each.check, each.subject) for each in results]
    assert len(keys) == len(set(keys)) and {subject for _, subject in keys} == {
        subject.title for subject in NATIVE
    }
    assert all(each.control.caught for each in results)


@pytest.mark.parametrize("subject", NATIVE, ids=lambda each: each.title)
def test_blender_has_one_power_of_the_color_too_many(results, subject):
    found = {each.check: each for each in results if each.subject == subject.title}
    assert {key for key, each in found.items() if each.verdict == FAILED} == {
        "value",
        "environment",
    }
    assert "nearest known model: EON with rho^3" in found["value"].diagnosis
    assert found["value"].distances["EON with rho^3"] < 1e-6
    assert {found[key].verdict for key in ("furnace", "black", "lambert", "inputs")} == {PASSED}
