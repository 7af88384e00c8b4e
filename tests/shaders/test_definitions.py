# SPDX-License-Identifier: Apache-2.0
"""A studio's own definitions, loaded in addition to the library."""

import OpenImageIO as oiio
import pytest

from mxeon.cli import main
from mxeon.errors import InputError
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import generate
from mxeon.shaders.library import load_library
from mxeon.shaders.nodes import document_text
from tests.support.command import one_line

# A surface shader with eonlib's lobe, and a color with its own shader code.
DEFINITIONS = """<materialx version="1.39">
  <nodedef name="ND_studio_cloth" node="studio_cloth">
    <input name="dye" type="color3" value="0.3, 0.1, 0.1" />
    <output name="out" type="surfaceshader" />
  </nodedef>
  <nodegraph name="NG_studio_cloth" nodedef="ND_studio_cloth">
    <studio_fade name="fade" type="color3">
      <input name="in" type="color3" interfacename="dye" />
    </studio_fade>
    <oren_nayar_diffuse_bsdf name="lobe" type="BSDF">
      <input name="color" type="color3" nodename="fade" />
      <input name="energy_compensation" type="boolean" value="true" />
    </oren_nayar_diffuse_bsdf>
    <surface name="shading" type="surfaceshader">
      <input name="bsdf" type="BSDF" nodename="lobe" />
    </surface>
    <output name="out" type="surfaceshader" nodename="shading" />
  </nodegraph>
  <nodedef name="ND_studio_fade" node="studio_fade">
    <input name="in" type="color3" value="1.0, 1.0, 1.0" />
    <output name="out" type="color3" />
  </nodedef>
  <implementation name="IM_studio_fade_glsl" nodedef="ND_studio_fade" target="genglsl"
                  file="studio_fade.glsl" function="studio_fade" />
</materialx>
"""
FADE = "void studio_fade(vec3 color, out vec3 result)\n{\n    result = 0.5 * color;\n}\n"
COAT = document_text('<studio_cloth name="shading" type="surfaceshader" />')


@pytest.fixture
def studio(tmp_path):
    """A folder of definitions, one of them in a subfolder, and a document."""
    folder = tmp_path / "studio" / "nodes"
    folder.mkdir(parents=True)
    (folder / "cloth.mtlx").write_text(DEFINITIONS)
    (folder / "studio_fade.glsl").write_text(FADE)
    document = tmp_path / "coat.mtlx"
    document.write_text(COAT)
    return folder.parent, document


def test_a_document_with_nodes_of_a_studio_has_eonlibs_lobes(studio):
    folder, document = studio
    (shader,) = generate(document, "glsl", policy=Policy(definitions=(str(folder),)))
    assert "studio_fade" in shader.stages["pixel"]
    assert "eon_brdf" in shader.stages["pixel"]  # eonlib's own function


def test_definitions_need_no_permission_of_the_document(studio, tmp_path, capsys):
    folder, document = studio
    render = ["render", str(document), "--workers", "0"]
    options = ["--definitions", str(folder), "--output", str(tmp_path / "coat.png")]
    assert main([*render, *options, "--size", "32"]) == 0
    image = oiio.ImageBuf(str(tmp_path / "coat.png"))
    assert image.spec().get_string_attribute("mxeon:definitions") == str(folder)
    assert main([*render, "--output", str(tmp_path / "no.png")]) == 2
    assert "load further definitions by --definitions FOLDER" in one_line(capsys.readouterr().err)


def test_code_in_a_document_still_needs_its_permission(studio, tmp_path, capsys):
    folder, document = studio
    code = '<implementation name="mine" nodedef="ND_studio_fade" sourcecode="1" target="genglsl"/>'
    document.write_text(COAT.replace("</materialx>", f"{code}</materialx>"))
    options = ["--definitions", str(folder), "--output", str(tmp_path / "coat.png")]
    assert main(["render", str(document), *options, "--workers", "0"]) == 2
    assert "pass --allowCode" in one_line(capsys.readouterr().err)


@pytest.mark.parametrize(
    "text",
    [
        '<nodedef name="ND_eon_diffuse_bsdf" node="mine"><output name="out" type="BSDF"/></nodedef>',
        '<nodedef name="ND_surface" node="mine"><output name="out" type="BSDF"/></nodedef>',
        '<implementation name="mine" nodedef="ND_oren_nayar_diffuse_bsdf" target="genglsl" '
        'file="mine.glsl" function="mine"/>',
    ],
    ids=["eonlib's", "MaterialX's", "implementation"],
)
def test_definitions_replace_nothing_of_the_library(text, tmp_path):
    (tmp_path / "mine.glsl").write_text("")
    (tmp_path / "mine.mtlx").write_text(f'<materialx version="1.39">{text}</materialx>')
    with pytest.raises(InputError, match=r"mine.mtlx: \w+ must not redefine a name of the library"):
        load_library("eonlib", None, (str(tmp_path),))
