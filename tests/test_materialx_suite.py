# SPDX-License-Identifier: Apache-2.0
"""The parts of tools/materialx_suite.py that need no build of MaterialX."""

import MaterialX as mx
import numpy as np

from mxeon.shaders.library import documents_folder
from tools.materialx_suite import GROUPS, change, group_of, groups_of
from tools.site.ledger import pages


def test_every_node_that_eonlib_implements_in_glsl_belongs_to_a_group_of_the_ledger():
    document = mx.createDocument()
    for path in documents_folder().rglob("*genglsl_impl.mtlx"):
        mx.readFromXmlFile(document, str(path))
    nodes = {each.getNodeDefString() for each in document.getImplementations()}
    assert len(nodes) > 20 and {group_of(node) for node in nodes} == set(GROUPS)
    assert set(GROUPS) <= set(pages.GROUPS)


def test_a_shader_names_the_groups_of_eonlibs_functions():
    stock, ours = "void mx_sheen_bsdf(ClosureData c)\n{", "void chiang_hair_bsdf(ClosureData c)\n{"
    assert groups_of(f"{stock}\n{ours}") == {"hair"}


def test_a_change_is_a_share_of_white():
    before = np.array([[[255] * 3, [0] * 3]], np.uint8)
    after = np.array([[[188] * 3, [0] * 3]], np.uint8)
    found = change(before, after)
    np.testing.assert_allclose((found.largest, found.visible), (-0.5, 0.5), atol=4e-3)
