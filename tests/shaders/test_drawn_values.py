# SPDX-License-Identifier: Apache-2.0
"""Documents that mxeon creates to render values do not change MaterialX's shared data library."""

import MaterialX as mx
import pytest

from mxeon.shaders.document.drawn_values import emission_document, value_document
from mxeon.shaders.library import load_library

COLORED = "NG_disney_principled"  # nodegraph of the library that has a color space


@pytest.mark.parametrize("make", [value_document, emission_document])
def test_no_port_of_a_librarys_graph_gets_a_color_space(make):
    library = load_library("stock")
    ports = [port for node in library.getNodeGraph(COLORED).getNodes() for port in node.getInputs()]
    before = [port.getAttributeNames() for port in ports]
    document = mx.createDocument()
    document.setDataLibrary(library)
    graph = document.addNodeGraph("own")
    graph.setColorSpace("srgb_texture")
    color = graph.addNode("constant", "color", "color3")
    color.addInput("value", "color3").setValueString("0.5, 0.5, 0.5")
    output = graph.addOutput("out", "color3")
    output.setNodeName("color")
    values = ((graph, color), "color3") if make is value_document else (output,)
    drawn, _ = make(document, *values)
    own = drawn.getNodeGraph("own").getNode("color").getInput("value")
    assert own.getColorSpace() == "srgb_texture"
    assert [port.getAttributeNames() for port in ports] == before
