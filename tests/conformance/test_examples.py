# SPDX-License-Identifier: Apache-2.0
"""Example documents: valid, renderable, distinct, and their textures are what the script makes."""

import functools
import operator
import runpy
from collections import Counter

import MaterialX.PyMaterialXGenShader as mx_gen
import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.shaders.document.reading import read_document
from mxeon.shaders.generation import generate
from mxeon.shaders.library import examples_folder

DOCUMENTS = sorted(examples_folder().glob("*.mtlx"))
TEXTURES = examples_folder() / "textures"
SCRIPT = examples_folder() / "make_textures.py"

every_document = pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)


def categories(document):
    """How often each kind of node stands in a document."""
    return Counter(node.getCategory() for node in document.getNodes())


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


@every_document
@pytest.mark.parametrize("target", ["glsl", "osl"])
def test_every_material_becomes_a_shader(path, target):
    materials = read_document(path).content.getMaterialNodes()
    assert len(generate(path, target)) == len(materials)


def test_materials_have_names_of_their_own():
    materials = functools.reduce(
        operator.iadd, (read_document(path).content.getMaterialNodes() for path in DOCUMENTS), []
    )
    assert len({node.getName() for node in materials}) == len(materials) == 36


def test_the_examples_use_every_node_that_leads_to_rough_diffuse_reflection():
    used = sum((categories(read_document(path).content) for path in DOCUMENTS), Counter())
    lobes = {"oren_nayar_diffuse_bsdf", "eon_diffuse_bsdf", "LamaDiffuse"}
    shaders = {"open_pbr_surface", "standard_surface"}
    assert lobes | shaders | {"mix", "add", "multiply", "image"} <= set(used)


def test_the_examples_use_every_other_lobe_of_pbrlib_that_is_judged():
    used = sum((categories(read_document(path).content) for path in DOCUMENTS), Counter())
    lobes = {"sheen_bsdf", "dielectric_bsdf", "conductor_bsdf", "generalized_schlick_bsdf"}
    assert lobes | {"layer"} <= set(used)


def test_everything_in_the_layered_furnace_is_white():
    document = read_document(examples_folder() / "layered_white_furnace.mtlx").content
    colors = [
        tuple(port.getValue())
        for node in document.getNodes()
        for port in node.getInputs()
        if port.getType() == "color3"
    ]
    assert colors == [(1.0, 1.0, 1.0)]


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


def test_no_other_texture_is_bundled_and_none_is_large(made):
    assert {path.name for path in TEXTURES.iterdir()} == {path.name for path in made.iterdir()}
    assert all(path.stat().st_size < 200_000 for path in TEXTURES.iterdir())


@pytest.mark.parametrize("name", IMAGES)
@pytest.mark.parametrize("axis", [0, 1])
def test_textures_tile_without_a_seam(name, axis):
    image = pixels(TEXTURES / name).astype(float)
    across = tuple(other for other in range(3) if other != axis)
    steps = np.abs(image - np.roll(image, 1, axis=axis)).mean(axis=across)
    assert steps[0] <= steps[1:].max()


def test_the_brick_reads_its_colour_as_srgb_and_its_roughness_as_numbers():
    images = read_document(examples_folder() / "brick.mtlx").content.getNodes("image")
    spaces = {node.getName(): node.getInput("file").getColorSpace() for node in images}
    assert spaces == {"brick_color": "srgb_texture", "brick_roughness": ""}
