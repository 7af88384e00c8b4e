# SPDX-License-Identifier: Apache-2.0
"""Figures of the page on inputs of surface shaders: which of them their graphs read."""

from mxeon.conformance.nodes.surface_shaders import SHADERS
from mxeon.shaders.library import load_library

HEAD = "| shader | input without effect in GLSL | its graph reads it |\n|---|---|---|\n"


def surface_inputs_block():
    """The inputs that change nothing in GLSL, as the check `reach` finds, and what the graph does."""
    rows = [
        f"| {shader.node} | `{name}` | {'yes' if name in read(shader) else 'no'} |\n"
        for shader in SHADERS
        for name in shader.table.without_effect
    ]
    return HEAD + "".join(rows)


def read(shader):
    """Inputs that lead to the output of a stock surface shader's graph."""
    [graph] = {
        nodedef.getImplementation().getName(): nodedef.getImplementation()
        for nodedef in load_library("stock").getMatchingNodeDefs(shader.node)
        if set(shader.inputs) <= {port.getName() for port in nodedef.getActiveInputs()}
    }.values()
    waiting, nodes = [graph.getOutputs()[0].getConnectedNode()], {}
    while waiting:
        node = waiting.pop()
        if node and node.getName() not in nodes:
            nodes[node.getName()] = node
            waiting += [port.getConnectedNode() for port in node.getInputs()]
    return {port.getInterfaceName() for node in nodes.values() for port in node.getInputs()}


OF_SURFACES = {"surface_inputs": surface_inputs_block}
