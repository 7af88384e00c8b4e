# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/materialx_suite.py that need no build of MaterialX."""

import numpy as np

from tools.materialx_suite import change


def test_a_change_is_a_share_of_white():
    before = np.array([[[255] * 3, [0] * 3]], np.uint8)
    after = np.array([[[188] * 3, [0] * 3]], np.uint8)
    np.testing.assert_allclose(change(before, after), (-0.5, 0.5), atol=4e-3)
