# SPDX-License-Identifier: Apache-2.0
"""Blender's own nodes, without OSL, judged as one more renderer."""

import pytest

from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.results.known_issues import RENDERER_NODES
from mxeon.survey.cycles_native import NODES

CHECKS = ("value", "environment", "furnace", "black", "lambert", "inputs")


@pytest.mark.parametrize("title", [each.title for each in NODES])
def test_blender_has_one_power_of_the_color_too_many(judged, title):
    found = {key: judged(key, title, "cycles-native", RENDERER_NODES) for key in CHECKS}
    assert {key for key, each in found.items() if each.verdict == FAILED} == {
        "value",
        "environment",
    }
    assert all(each.control.caught for each in found.values())
    assert "best match: EON with rho^3" in found["value"].diagnosis
    assert found["value"].distances["EON with rho^3"] < 1e-6
    assert found["environment"].error > 100.0 * found["environment"].tolerance
    assert {found[key].verdict for key in CHECKS[2:]} == {PASSED}
