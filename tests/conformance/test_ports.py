# SPDX-License-Identifier: Apache-2.0
"""Inputs of the nodes that are judged: what is drawn of them, and that each change is of one."""

import numpy as np
import pytest

from mxeon.conformance.nodes.rows import draw_edges
from mxeon.conformance.nodes.surface_shaders import SHADERS
from mxeon.conformance.probes.families import PBR_SUBJECTS

DRAWN = {each.title: each.drawn for each in PBR_SUBJECTS if hasattr(each, "drawn")}
DRAWN |= {
    each.title: each.ports
    for each in PBR_SUBJECTS
    if each.title not in DRAWN and hasattr(each, "ports")
}
DRAWN |= {each.title: (*each.table.judged, *each.table.others) for each in SHADERS}


@pytest.mark.parametrize("title", DRAWN)
def test_special_values_are_half_on_the_edges_of_ports_that_have_some(title):
    values = draw_edges(np.random.default_rng(1), 1 << 10, DRAWN[title])
    for port in DRAWN[title]:
        share = np.isin(values[port.name], np.float32(port.edges)).mean()
        assert share > 0.4 or not port.edges, port.name


@pytest.mark.parametrize("subject", PBR_SUBJECTS, ids=lambda each: each.title)
def test_a_change_is_of_one_input(subject):
    for before, after in getattr(subject, "changes", {}).values():
        changed = [name for name in after if not np.array_equal(before.get(name), after[name])]
        assert len(changed) == 1 and set(before) <= set(after)
