# SPDX-License-Identifier: Apache-2.0
"""A program that uses an eonlib folder with MaterialX alone, without mxeon.

    python -m tests.support.client FOLDER OUTPUT [DATA]

The program writes the GLSL of each node that FOLDER implements to OUTPUT/<implementation>.frag.
Definitions come from MaterialX, or from DATA/libraries if DATA is given.
"""

import sys
from pathlib import Path

import MaterialX as mx
import MaterialX.PyMaterialXGenGlsl as mx_glsl
import MaterialX.PyMaterialXGenShader as mx_gen

SURFACE = {"BSDF": "bsdf", "EDF": "edf"}  # inputs of the surface node, by type of the lobe
# Nodes that fill the operands of a combination, by the operand's type.
FILLED = {"BSDF": "conductor_bsdf", "VDF": "absorption_vdf"}


def main(folder, output, data=None):
    path = mx.FileSearchPath(data) if data else mx.getDefaultDataSearchPath()
    library, ours = mx.createDocument(), mx.createDocument()
    mx.loadLibraries([folder, "libraries"], path, library)
    mx.loadLibraries([folder], mx.FileSearchPath(), ours)
    for row in ours.getImplementations():
        if row.getTarget() == "genglsl":
            text = shader(library, row, path)
            Path(output, f"{row.getName()}.frag").write_text(text, encoding="utf-8")


def shader(library, row, path):
    """GLSL of a document with one node. Asserts that the node uses the implementation `row`."""
    document = mx.createDocument()
    document.setDataLibrary(library)
    element = rendered(document, document.getNodeDef(row.getNodeDefString()))
    generator = mx_glsl.GlslShaderGenerator.create()
    found = document.getNodeDef(row.getNodeDefString()).getImplementation("genglsl")
    assert found.getActiveSourceUri() == row.getActiveSourceUri()
    generator.registerTypeDefs(library)
    context = mx_gen.GenContext(generator)
    context.registerSourceCodeSearchPath(path)
    return generator.generate("node", element, context).getSourceCode("pixel")


def rendered(document, definition):
    """Add a node and its operands, and return the node, or a surface if the node is a closure."""
    # Add the node, and operands if the node combines lobes.
    kind = definition.getType()
    node = document.addNode(definition.getNodeString(), "node", kind)
    node.setNodeDefString(definition.getName())
    for port in definition.getInputs():
        if port.getType() in FILLED:
            connect(document, node, port.getName(), port.getType(), FILLED[port.getType()])
    # Put a medium below a dielectric, and connect a lobe to a surface.
    if kind == "VDF":
        medium, node, kind = node, document.addNode("layer", "layered", "BSDF"), "BSDF"
        connect(document, node, "top", "BSDF", "dielectric_bsdf")
        node.addInput("base", "VDF").setConnectedNode(medium)
    if kind not in SURFACE:
        return node
    surface = document.addNode("surface", "surface", "surfaceshader")
    surface.addInput(SURFACE[kind], kind).setConnectedNode(node)
    return surface


def connect(document, node, name, kind, category):
    node.addInput(name, kind).setConnectedNode(document.addNode(category, f"node_{name}", kind))


if __name__ == "__main__":
    main(*sys.argv[1:])
