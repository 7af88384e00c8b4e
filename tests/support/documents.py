# SPDX-License-Identifier: Apache-2.0
"""Small material documents as XML, for the tests of reading, generation and rendering."""

import pytest

from mxeon.errors import DocumentError
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.generation import generate
from mxeon.shaders.library import load_library
from mxeon.shaders.nodes import (
    INPUT_TYPES,
    OREN_NAYAR,
    SURFACE,
    document_text,
    input_text,
    lobe_text,
    node_text,
)


def material(nodes):
    """XML of a document with a material whose BSDF is the node named `lobe`."""
    return document_text(nodes + SURFACE)


def lobe(category=OREN_NAYAR, name="lobe", **inputs):
    """XML of a lobe, rough diffuse by default, with the given input values."""
    return lobe_text(category, inputs, name)


def surface(category, **inputs):
    """XML of a document with a surface shader and the given input values."""
    definitions = load_library("stock").getMatchingNodeDefs(category)
    ports = "".join(
        input_text(name, definitions[0].getActiveInput(name).getType(), value)
        for name, value in inputs.items()
    )
    return document_text(node_text(category, "surfaceshader", "shading", ports))


def connected(name="lobe", **inputs):
    """XML of a rough diffuse node whose inputs have the given XML attributes."""
    ports = "".join(
        f'<input name="{each}" type="{INPUT_TYPES[each]}" {attributes}/>'
        for each, attributes in inputs.items()
    )
    return f'<{OREN_NAYAR} name="{name}" type="BSDF">{ports}</{OREN_NAYAR}>'


def written(folder, text):
    path = folder / "look.mtlx"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def including(file):
    """XML of a document that includes another document by XInclude."""
    include = f'<xi:include href="{file}"/>'
    space = "http://www.w3.org/2001/XInclude"
    return f'<materialx version="1.39" xmlns:xi="{space}">{include}</materialx>'


def refusal(source, policy=DEFAULT):
    """Assert that a document is refused with a one-line message, and return the message."""
    with pytest.raises(DocumentError) as refused:
        generate(source, "glsl", policy=policy)
    message = str(refused.value)
    assert message and message.isprintable()
    return message


def image(file, name="image"):
    return f'<image name="{name}" type="color3"><input name="file" type="filename" value="{file}"/></image>'


def textured(files):
    """XML of a document whose material has the sum of several images as its color."""
    add = (
        '<add name="s{0}" type="color3"><input name="in1" type="color3" nodename="{1}"/>'
        '<input name="in2" type="color3" nodename="i{0}"/></add>'
    )
    nodes = [image(file, f"i{number}") for number, file in enumerate(files)]
    names = ["i0", *(f"s{number}" for number in range(1, len(files)))]
    nodes += [add.format(number, names[number - 1]) for number in range(1, len(files))]
    return material("".join(nodes) + connected(color=f'nodename="{names[-1]}"'))


# Definition of a rough diffuse node. A studio's own shader code scales the color.
STUDIO = """<materialx version="1.39">
  <nodedef name="ND_studio_rough" node="studio_rough">
    <input name="color" type="color3" value="0.3, 0.1, 0.1"/>
    <input name="roughness" type="float" value="0.0"/>
    <output name="out" type="BSDF"/>
  </nodedef>
  <nodegraph name="NG_studio_rough" nodedef="ND_studio_rough">
    <studio_fade name="fade" type="color3">
      <input name="in" type="color3" interfacename="color"/>
    </studio_fade>
    <eon_diffuse_bsdf name="lobe" type="BSDF">
      <input name="color" type="color3" nodename="fade"/>
      <input name="roughness" type="float" interfacename="roughness"/>
    </eon_diffuse_bsdf>
    <output name="out" type="BSDF" nodename="lobe"/>
  </nodegraph>
  <nodedef name="ND_studio_fade" node="studio_fade">
    <input name="in" type="color3" value="1.0, 1.0, 1.0"/>
    <output name="out" type="color3"/>
  </nodedef>
  <implementation name="IM_studio_fade_glsl" nodedef="ND_studio_fade" target="genglsl"
                  file="studio_fade.glsl" function="studio_fade"/>
</materialx>"""
FADE = "void studio_fade(vec3 color, out vec3 result)\n{\n    result = 0.5 * color;\n}\n"


def studio(folder):
    """Write a studio's own definitions to folder/studio/nodes, and return folder/studio."""
    nodes = folder / "studio" / "nodes"
    nodes.mkdir(parents=True)
    (nodes / "rough.mtlx").write_text(STUDIO)
    (nodes / "studio_fade.glsl").write_text(FADE)
    return nodes.parent
