# SPDX-License-Identifier: Apache-2.0
"""The rough diffuse nodes and materials of one node: what is written is what MaterialX reads."""

import MaterialX as mx
import numpy as np
import pytest

from mxeon.shaders.document.values import plain
from mxeon.shaders.library import load_library
from mxeon.shaders.nodes import (
    DIFFUSE_NODES,
    FLAG,
    INPUT_TYPES,
    NODEDEFS,
    OREN_NAYAR,
    material_text,
)

INPUTS = {
    "weight": 0.1,
    "color": np.array([0.2, 0.5, 1.0]),
    "roughness": 1,
    "normal": (0.0, 0.0, 1.0),
    FLAG: True,
}


@pytest.mark.parametrize("category, nodedef", [*zip(DIFFUSE_NODES, NODEDEFS, strict=True)])
def test_the_table_has_the_inputs_of_the_nodedefs(category, nodedef):
    inputs = load_library().getNodeDef(nodedef).getInputs()
    names = [name for name in INPUT_TYPES if name != FLAG or category == OREN_NAYAR]
    assert {each.getName(): each.getType() for each in inputs} == {
        name: INPUT_TYPES[name] for name in names
    }


def test_a_material_keeps_its_values_and_connects_its_normal():
    document = mx.createDocument()
    mx.readFromXmlString(document, material_text(OREN_NAYAR, INPUTS, "clay"))
    node, normal = document.getNode("lobe"), document.getNode("lobe_normal")
    values = {name: plain(node.getInputValue(name), document) for name in INPUTS}
    assert values == {
        "weight": pytest.approx(0.1),
        "color": pytest.approx((0.2, 0.5, 1.0)),
        "roughness": 1.0,
        "normal": None,
        FLAG: True,
    }
    assert node.getInput("normal").getConnectedNode() == normal
    assert plain(normal.getInputValue("value"), document) == (0.0, 0.0, 1.0)
    assert document.getMaterialNodes()[0].getName() == "clay"


def test_an_input_that_no_node_has_is_an_error():
    with pytest.raises(KeyError, match="colour"):
        material_text(OREN_NAYAR, {"colour": 1.0})
