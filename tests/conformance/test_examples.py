# SPDX-License-Identifier: Apache-2.0
"""Example documents: valid, renderable, distinct, and their textures are what the script makes."""

import MaterialX.PyMaterialXGenShader as mx_gen
import pytest

from mxeon.shaders.document.reading import read_document
from mxeon.shaders.library import examples_folder

DOCUMENTS = sorted(examples_folder().glob("*.mtlx"))

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
