# SPDX-License-Identifier: Apache-2.0
"""Strings of a document that reach generated source code must consist of plain words."""

from functools import lru_cache

import MaterialX as mx
import pytest

from mxeon.shaders import generation
from mxeon.shaders.document.reading import read_document
from tests.fuzz import reach
from tests.support.documents import lobe, material, refusal, written
from tests.support.sharing import shared

SOME = ("glsl", "osl", "mdl")  # one target per family of shader generators
CLASSES = (*SOME, "msl", "slang")  # one target per generator class
IMAGE = '<image name="image" type="color3"><input name="{}" type="{}" value="{}"/></image>'
KINDS = [kind for kind in vars(mx).values() if hasattr(kind, "CATEGORY")]


@pytest.fixture(scope="module", autouse=True)
def furnished(tmp_path_factory):
    """Enter a folder with the files that the documents name.

    Each document is read once for all targets. Input values are not collected, because input values
    are not source text.
    """
    folder = tmp_path_factory.mktemp("reach")
    reach.furnish(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(generation, "_inputs", lambda *_: ())
        patch.setattr(generation, "read_document", lru_cache(maxsize=1)(read_document))
        patch.chdir(folder)
        yield


@pytest.fixture(scope="module")
def materials(furnished, tmp_path_factory):
    """Root of the document with materials, and the attributes whose text reaches shader source."""
    root = reach.documents()["materials"]
    groups = reach.present(root)
    return root, shared(tmp_path_factory, "reach", lambda: reach.reached(root, groups, CLASSES))


def test_the_document_has_every_kind_of_element():
    there = {each.tag for each in reach.documents()["materials"].iter()}
    assert {kind.CATEGORY for kind in KINDS} - {"node"} <= there


def test_text_that_reaches_source_in_materials_is_words(materials):
    assert reach.unjudged(*materials, CLASSES) == []


def test_text_that_reaches_source_in_outputs_is_words():
    root = reach.documents()["outputs"]
    groups = reach.present(root)  # the test of materials covers names, types and values
    texts = [each for each in groups if each[0].attribute not in ("name", "type", "value")]
    found = reach.reached(root, texts, SOME)
    assert any(place.number == 0 and place.attribute == "namespace" for place in found)
    assert reach.unjudged(root, found, SOME) == []


def test_text_that_reaches_source_where_it_does_not_belong_is_words(materials):
    root, _ = materials
    found = reach.reached(root, reach.absent(root), SOME)
    assert reach.unjudged(root, found, SOME) == []


REFUSED = {
    "index": (
        '<geompropdef name="a" type="vector2" index="0&#10;;"/>',
        "geompropdef \"a\": 'index'",
    ),
    "space": ('<geompropdef name="a" type="vector3" space="x&quot;"/>', "'space' must be a name"),
    "namespace": ('<nodegraph name="a" namespace="x y"/>', "'namespace' must be a name of letters"),
    "color space": ('<nodegraph name="a" colorspace="a\\"/>', "must be without quotes"),
    "comment": (IMAGE.format("layer", "string", "a//b"), "without //; got 'a//b'"),
    "choice": (IMAGE.format("uaddressmode", "string", "a, b"), "'value' must be one word"),
    "member": (
        '<typedef name="p"><member name="t" type="string" value="w&quot;"/></typedef>',
        "member \"p/t\": 'value' must be words",
    ),
    "structure": (
        '<nodegraph name="a"><input name="b" type="p" value="{1;w&quot;}"/></nodegraph>',
        "input \"a/b\": 'value' must be words",
    ),
}


@pytest.mark.parametrize("nodes, reason", REFUSED.values(), ids=REFUSED)
def test_more_than_words_is_refused_in_one_line(nodes, reason):
    message = refusal(material(nodes + lobe()))
    assert message.startswith("document text: ") and reason in message


ACCEPTED = {
    "prose": '<nodegraph name="a" doc="see http://x/y: &quot;*/\\&quot;&#10;;" uiname="a // b" uifolder="a/b"/>',
    "an application's own": '<nodegraph name="a" app="{&quot;x&quot;: 1} // y"/>',
    "a namespace": '<nodegraph name="n:a" namespace="n"/>',
    "a color space of OCIO": '<nodegraph name="a" colorspace="Linear Rec.709 (sRGB)"/>',
    "geometry": '<collection name="c" includegeom="/a/*, /b (c)/d"/>',
    "a structure": '<typedef name="p"><member name="t" type="string" value="w"/></typedef>'
    '<nodegraph name="a"><input name="b" type="p" value="{w}"/></nodegraph>',
    "a layer": IMAGE.format("layer", "string", "left eye.R-1"),
}


@pytest.mark.parametrize("nodes", ACCEPTED.values(), ids=ACCEPTED)
def test_legitimate_text_is_accepted(nodes):
    assert read_document(material(nodes + lobe()))


@pytest.mark.parametrize("name", ["a b (1) #2 &amp; ü.png", "it's, 100%.png"])
def test_names_of_files_are_free_but_for_what_ends_a_string(tmp_path, name):
    (tmp_path / name.replace("&amp;", "&")).touch()
    path = written(tmp_path, material(IMAGE.format("file", "filename", name) + lobe()))
    assert read_document(path)
