# SPDX-License-Identifier: Apache-2.0
"""mxeon loads the definitions of a studio's own nodes in addition to the library."""

import OpenImageIO as oiio
import pytest

from mxeon.cli import main
from mxeon.errors import InputError
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import generate
from mxeon.shaders.library import load_library
from tests.support.command import one_line
from tests.support.documents import material, studio, written

CLOTH = material('<studio_rough name="lobe" type="BSDF"/>')


@pytest.fixture
def given(tmp_path):
    """Folder of a studio's node definitions, and path of a document that uses the nodes."""
    return studio(tmp_path), written(tmp_path, CLOTH)


def test_a_document_with_nodes_of_a_studio_has_eonlibs_lobes(given):
    folder, document = given
    (shader,) = generate(document, "glsl", policy=Policy(definitions=(str(folder),)))
    assert "studio_fade" in shader.stages["pixel"]
    assert "eon_brdf" in shader.stages["pixel"]  # a function of eonlib


def test_definitions_need_no_permission_of_the_document(given, tmp_path, capsys):
    folder, document = given
    render = ["render", str(document), "--workers", "0"]
    options = ["--definitions", str(folder), "--output", str(tmp_path / "coat.png")]
    assert main([*render, *options, "--size", "32"]) == 0
    image = oiio.ImageBuf(str(tmp_path / "coat.png"))
    assert image.spec().get_string_attribute("mxeon:definitions") == str(folder)
    assert main([*render, "--output", str(tmp_path / "no.png")]) == 2
    assert "load further definitions by --definitions FOLDER" in one_line(capsys.readouterr().err)


def test_code_in_a_document_still_needs_its_permission(given, tmp_path, capsys):
    folder, document = given
    code = '<implementation name="mine" nodedef="ND_studio_fade" sourcecode="1" target="genglsl"/>'
    document.write_text(CLOTH.replace("</materialx>", f"{code}</materialx>"))
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
