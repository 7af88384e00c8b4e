# SPDX-License-Identifier: Apache-2.0
"""Figures of the page on lights: whether the GLSL of a light that is a node graph compiles."""

from dataclasses import replace

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import ShaderError
from mxeon.hosts import open_host
from mxeon.shaders.generation import generate
from mxeon.shaders.generators import context_of, generator_of
from mxeon.shaders.library import load_library
from mxeon.shaders.nodes import material_text
from mxeon.shaders.scene import Scene

STOCK, TARGET = "stock", "glsl"
HEAD = "| quantity | measured | expected |\n|---|---|---|\n"
DARK = Scene("dark", size=2)
LOBE, CATEGORY = "burley_diffuse_bsdf", "glow"

# A light shader whose graph has the inputs that the generated text reads.
LIGHT = f"""  <nodedef name="ND_{CATEGORY}" node="{CATEGORY}">
    <input name="color" type="color3" value="1.0, 1.0, 1.0"/>
    <input name="position" type="vector3" value="0.0, 0.0, 0.0"/>
    <input name="direction" type="vector3" value="0.0, 0.0, 1.0"/>
    <output name="out" type="lightshader"/>
  </nodedef>
  <nodegraph name="NG_{CATEGORY}" nodedef="ND_{CATEGORY}">
    <uniform_edf name="emission" type="EDF">
      <input name="color" type="color3" interfacename="color"/>
    </uniform_edf>
    <light name="source" type="lightshader">
      <input name="edf" type="EDF" nodename="emission"/>
      <input name="intensity" type="float" value="3.0"/>
      <input name="exposure" type="float" value="2.0"/>
    </light>
    <output name="out" type="lightshader" nodename="source"/>
  </nodegraph>
"""


def light_block():
    """Whether GLSL with such a light compiles, as it is generated and with the repair of its page."""
    text = _lit_text()
    host = open_host("gl")
    try:
        figures = [_compiles(host, each) for each in (text, repaired(text))]
    finally:
        host.close()
    names = ("shaders, of 1, that compile as generated", "shaders, of 1, with the repair")
    rows = zip(names, figures, strict=True)
    return HEAD + "".join(f"| {name} | {figure} | 1 |\n" for name, figure in rows)


def repaired(text):
    """GLSL without the first closure data of the light, and without the scope of its emission."""
    start = text.index(f"void NG_{CATEGORY}(")
    head, body = text[:start], text[start:]
    first = body.index("    ClosureData closureData = ")
    body = body[:first] + body[body.index("\n", first) + 1 :]
    opened = body.index("    {\n")
    closed = body.index("    }\n", opened)
    body = body[:opened] + body[opened + 6 : closed] + body[closed + 6 :]
    return head + body


def _lit_text():
    """Pixel stage of a lobe under such a light."""
    document = mx.createDocument()
    material = material_text(LOBE, {}, CATEGORY).replace("</materialx>", LIGHT + "</materialx>")
    mx.readFromXmlString(document, material)
    document.setDataLibrary(load_library(STOCK))
    generator = generator_of(document, TARGET, STOCK, None)
    context = context_of(document, TARGET, generator, False, ())
    light = document.getNodeDef(f"ND_{CATEGORY}")
    mx_gen.HwShaderGenerator.bindLightShader(light, 1, context)
    return generator.generate("lit", document.getNode(CATEGORY), context).getSourceCode("pixel")


def _compiles(host, pixel):
    """1 if a host compiles a pixel stage, else 0."""
    [shader] = generate(material_text(LOBE), TARGET, library=STOCK)
    try:
        host.picture(replace(shader, stages={**shader.stages, "pixel": pixel}), DARK)
    except ShaderError:
        return 0
    return 1
