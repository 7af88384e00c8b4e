# SPDX-License-Identifier: Apache-2.0
"""Example documents: valid, renderable, distinct, and their textures are what the script makes."""

import runpy

import MaterialX.PyMaterialXGenShader as mx_gen
import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.shaders.document.reading import read_document
from mxeon.shaders.library import examples_folder

DOCUMENTS = sorted(examples_folder().glob("*.mtlx"))
TEXTURES = examples_folder() / "textures"
SCRIPT = examples_folder() / "make_textures.py"

every_document = pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)


@every_document
def test_every_document_is_valid_materialx_1_39(path):
    document = read_document(path).content
    assert document.validate() == (True, "")
    assert document.getVersionString() == "1.39"
    assert document.getColorSpace() == "lin_rec709"


@every_document
def test_every_document_renders_all_its_materials_and_nothing_else(path):
    document = read_document(path).content
    found = mx_gen.findRenderableElements(document)
    assert found
    assert found == document.getMaterialNodes()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folder of freshly made textures."""
    folder = tmp_path_factory.mktemp("textures")
    runpy.run_path(str(SCRIPT))["main"](folder)
    return folder


def pixels(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.UINT8)


IMAGES = ("brick_color.png", "brick_roughness.png", "wood_color.png")


@pytest.mark.parametrize("name", IMAGES)
def test_the_script_makes_the_textures_pixel_for_pixel(made, name):
    np.testing.assert_array_equal(pixels(made / name), pixels(TEXTURES / name))
