# SPDX-License-Identifier: Apache-2.0
"""UTF-8 documents are read. An error message has one line with the place, rule and value."""

import re

import MaterialX as mx
import pytest

from mxeon.errors import DocumentError
from mxeon.shaders.document.notes import MissingFileWarning
from mxeon.shaders.document.reading import DocumentWarning, read_document
from mxeon.shaders.document.values import INTEROP, LEGACY
from mxeon.shaders.generation import generate
from tests.support.documents import connected, image, including, lobe, material, refusal, written

DEFINED = '<nodedef name="ND_{0}" node="{0}"><output name="out" type="BSDF"/></nodedef>'
INNER = '<{} name="inner" type="BSDF"/><output name="out" type="BSDF" nodename="inner"/>'
INSIDE = '<nodegraph name="NG_{}" nodedef="ND_{}">' + INNER + "</nodegraph>"
CYCLE = (
    '<add name="a" type="color3"><input name="in1" type="color3" nodename="b"/></add>'
    '<add name="b" type="color3"><input name="in1" type="color3" nodename="a"/></add>'
)
A, DEEP = '<a name="lobe" type="BSDF"/>', material("<a>" * 1000 + "</a>" * 1000)

# Contents of invalid files, each with part of the expected error message.
FILES = {
    "empty": ("", "must be a MaterialX document; XML parse error"),
    "prose": ("hello\n", "must be a MaterialX document; XML parse error"),
    "binary": ("".join(map(chr, range(256))), "must be a MaterialX document in UTF-8; invalid"),
    "cut short": (material(lobe())[:150], "must be a MaterialX document; XML parse error"),
    "too deep": (DEEP, "must have at most 64 nested elements; got 65"),
    "future": ('<materialx version="1.99"/>', "MaterialX upgrades to 1.39; got '1.99'"),
    "no version": ('<materialx version="x"/>', "MaterialX upgrades to 1.39; got 'x'"),
    "no include": (including("none.mtlx"), "none.mtlx"),
    "nothing": ('<materialx version="1.39"/>', "or an output; there is none"),
    "no material": (
        '<materialx version="1.39"><standard_surface name="wood" type="surfaceshader"/></materialx>',
        "got standard_surface 'wood': connect it to the input surfaceshader of a surfacematerial",
    ),
    "look alone": (
        '<materialx version="1.39"><surfacematerial name="look" type="material"/></materialx>',
        "or an output; got surfacematerial 'look'",
    ),
}

# Malformed input values, each with part of the expected error message.
VALUES = (
    ({"color": "nan, 1, 1"}, 'input "lobe/color" must be a valid color3 of finite numbers; got n'),
    ({"color": "red"}, 'input "lobe/color" must be a valid color3 of finite numbers; got red'),
    ({"color": "1, 1"}, 'input "lobe/color" must be a valid color3 of finite numbers; got 1, 1'),
    ({"roughness": "inf"}, 'input "lobe/roughness" must be a valid float of finite numbers; got'),
    ({"energy_compensation": "x"}, 'Invalid value: <input name="energy_compensation"'),
)

# Input values that MaterialX accepts outside the model's domain, each with part of a warning.
MODEL = "where its model is defined; got"
OUTSIDE = (
    ({"color": "0.5, -0.1, 0.5"}, f'input "lobe/color" must lie in [0, 1], {MODEL} 0.5, -0.1, 0.5'),
    ({"color": "0,&#10;2,&#10;0"}, f'input "lobe/color" must lie in [0, 1], {MODEL} 0, 2, 0'),
    ({"weight": "-1"}, f'input "lobe/weight" must lie in [0, 1], {MODEL} -1'),
    ({"roughness": "1.6"}, f'input "lobe/roughness" must lie in [0, pi/2], {MODEL} 1.6'),
    (
        {"roughness": "1.2", "energy_compensation": True},
        f'input "lobe/roughness" must lie in [0, 1], {MODEL} 1.2',
    ),
    (
        {"roughness": "1.2"},
        'input "lobe/roughness" must lie in [0.0, 1.0], the range of its node; got 1.2',
    ),
)

# Malformed numbers as text, and the number that MaterialX reads from each text.
READ = {"0.5f": 0.5, "0x10": 0, "1d5": 1, "1/2": 1, "50%": 50, "0.5;0.5": 0.5, "0.5.0": 0.5}
READ |= {"1.#INF": 1, "1_0": 1, "0.5, 0.6": 0.5, "1e5f": 100000, "0 5": 0}
CONSTANT = (
    '<constant name="c" type="float"><input name="value" type="float" value="{}"/></constant>'
)

# Invalid nodes, each with part of the expected error message.
NODES = {
    "unknown node": (
        '<nosuch_bsdf name="lobe" type="BSDF"/>',
        'node "lobe" must have a definition; got nosuch_bsdf of type BSDF: load further definitions',
    ),
    "no implementation": (DEFINED.format("a") + A, "Could not find a matching implementation"),
    "circle": (CYCLE + connected(color='nodename="a"'), 'node "a" must not be upstream of itself'),
    "circle of inheritance": (
        DEFINED.format("a").replace("node=", 'inherit="ND_a" node=') + A,
        'definition "ND_a" must not inherit itself',
    ),
    "own part": (
        DEFINED.format("a") + INSIDE.format("a", "a", "a") + A,
        'nodedef "ND_a" must not contain itself',
    ),
    "folder for a texture": (
        image("/") + connected(color='nodename="image"'),
        'input "image/file" must name a file in ',
    ),
    "unconnected node": (
        connected(color='nodename="none"'),
        "input \"lobe/color\" is connected to 'none', which does not exist",
    ),
    "another type": (
        '<constant name="a" type="float"/>' + connected(color='nodename="a"'),
        'Mismatched types in port connection: <input name="color"',
    ),
    "unknown input": (
        connected(color="").replace('name="color"', 'name="colour"'),
        "must be an input of oren_nayar_diffuse_bsdf; got 'colour': did you mean color?",
    ),
    "odd name": (
        lobe(name="l o;b"),
        "'name' must be a name of letters, digits, _ and :; got 'l o;b'",
    ),
}


@pytest.mark.parametrize("content, rule", FILES.values(), ids=FILES)
def test_a_bad_file_is_refused_by_its_name(tmp_path, content, rule):
    path = written(tmp_path, content.encode("latin-1"))
    message = refusal(path)
    assert message.startswith(f"{path}: ")
    assert rule in message


@pytest.mark.parametrize("name", ["", "none.mtlx", ".", "/dev/null", "n" * 5000, "n\0n"])
def test_what_is_no_file_is_refused(name):
    assert refusal(name).startswith("document must be a readable file; got ")


@pytest.mark.parametrize("inputs, rule", VALUES)
def test_a_bad_value_is_refused_with_its_place_and_its_range(inputs, rule):
    assert rule in refusal(material(lobe(**inputs)))


@pytest.mark.parametrize("nodes, rule", NODES.values(), ids=NODES)
def test_bad_nodes_are_refused_with_their_names(nodes, rule):
    assert rule in refusal(material(nodes))


def warned(text, **options):
    """Generate the shaders of a document, and return the only warning."""
    with pytest.warns(DocumentWarning) as caught:
        assert generate(text, "glsl", **options)
    [message] = [str(each.message) for each in caught]
    return message


@pytest.mark.parametrize("inputs, rule", OUTSIDE)
def test_a_value_outside_its_model_is_written_with_a_warning(inputs, rule):
    assert rule in warned(material(lobe(**inputs)))


@pytest.mark.parametrize("text, read", READ.items())
def test_a_number_of_which_a_part_is_read_is_named(text, read):
    said = f"must be a valid float; got {text}, which MaterialX reads as {read:g}"
    message = warned(material(CONSTANT.format(text) + lobe()))
    assert message == f'document text: input "c/value" {said}'


def test_a_color_space_without_a_transform_is_named():
    text = material(lobe(color="1, 1, 1")).replace('value="1', 'colorspace="srgb_txt" value="1')
    said = "must have a color space with a transform to lin_rec709; got srgb_txt, which MaterialX"
    assert said in warned(text.replace("<materialx", '<materialx colorspace="lin_rec709"'))


@pytest.mark.parametrize("space", [*LEGACY, *INTEROP])
def test_a_color_space_of_another_name_is_transformed(space):
    text = material(lobe(color="0.5, 0.5, 0.5")).replace(
        'value="0', f'colorspace="{space}" value="0'
    )
    [shader] = generate(text.replace("<materialx", '<materialx colorspace="lin_rec709"'), "glsl")
    known = (LEGACY | INTEROP)[space]
    assert (f"{known}_to_lin_rec709" in shader.stages["pixel"]) == (known != "lin_rec709")


def test_a_nodegraph_that_is_connected_as_a_node_is_named():
    graph = '<nodegraph name="ng"><constant name="c" type="color3"/>'
    graph += '<output name="out" type="color3" nodename="c"/></nodegraph>'
    said = "must be connected to a node; got nodename 'ng', which MaterialX ignores"
    assert said in warned(material(graph + connected(color='nodename="ng"')))


@pytest.mark.parametrize("name", ["none.png", "n" * 5000, "[token].png", "&lt;a>&lt;a>.png"])
def test_a_missing_texture_is_named_and_the_shader_written(name):
    nodes = image(name) + connected(color='nodename="image"')
    with pytest.warns(MissingFileWarning, match='input "image/file" must name a file that exists'):
        assert generate(material(nodes), "glsl")


def test_all_faults_of_a_document_are_told_together(tmp_path):
    nodes = image("none.png") + image("nor.exr", "other")
    inputs = '<input name="in1" type="color3" nodename="image"/>'
    inputs += '<input name="in2" type="color3" nodename="other"/><input name="inn" type="float"/>'
    nodes += f'<add name="a" type="color3">{inputs}</add><nosuch name="n" type="float"/>'
    more = '<input name="rougness" type="float" value="nan"/>'
    more += '<input name="wight" type="float" nodename="n"/></'
    text = connected(color='nodename="a"').replace("</", more, 1)
    path = written(tmp_path, material(nodes + text))
    with pytest.raises(DocumentError) as refused:
        read_document(path)
    assert [line.removeprefix(f"{path}: ").split("; got")[0] for line in refused.value.args] == [
        'input "lobe/rougness" must be a valid float of finite numbers',
        'input "a/inn" must be an input of add',
        'input "lobe/rougness" must be an input of oren_nayar_diffuse_bsdf',
        'input "lobe/wight" must be an input of oren_nayar_diffuse_bsdf',
        'node "n" must have a definition',
        'input "image/file" must name a file that exists',
        'input "other/file" must name a file that exists',
    ]
    assert "did you mean roughness?" in str(refused.value)


@pytest.mark.parametrize("version", ["2.0", "abc", "", "0.5"])
def test_an_included_document_follows_the_rule_of_its_version(tmp_path, version):
    part, look = tmp_path / "part.mtlx", tmp_path / "look.mtlx"
    part.write_text(f'<materialx version="{version}">{lobe()}</materialx>')
    look.write_text(including("part.mtlx"))
    rule = f"version must be one that MaterialX upgrades to 1.39; got {version!r}"
    assert refusal(look) == f"{part}: {rule}"


def test_an_older_document_is_read_as_todays():
    older = material(lobe()).replace('version="1.39"', 'version="1.37"')
    assert read_document(older).content.getVersionString() == "1.39"


def test_relative_names_start_at_the_file(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "albedo.png").touch()
    nodes = image("maps/albedo.png") + connected(color='nodename="image"')
    (tmp_path / "nodes.mtlx").write_text(material(nodes))
    file = written(tmp_path, including("nodes.mtlx"))
    monkeypatch.chdir(tmp_path / "maps")
    port = read_document(file).content.getDescendant("image/file")
    assert port.getValueString() == str(tmp_path / "maps" / "albedo.png")


# --- encodings ---------------------------------------------------------------------------------

TEXT = material(lobe()).split("\n", 1)[1].replace("<surface ", '<surface doc="{}" ')
WORDS = "löök \N{GREEK SMALL LETTER RHO}"
DECLARED = '<?xml version="1.0" encoding="{}"?>\n'
ENCODED = {
    "UTF-8": ("UTF-8", "utf-8", WORDS),
    "UTF-8 with its mark": ("utf-8", "utf-8-sig", WORDS),
    "Windows, but ASCII": ("windows-1252", "ascii", "look"),
    "ASCII": ("us-ascii", "ascii", "look"),
    "ASCII by another name": ("UTF-16", "ascii", "look"),
}


@pytest.mark.parametrize("name, encoding, words", ENCODED.values(), ids=ENCODED)
def test_an_encoding_is_read_as_materialx_reads_it(tmp_path, name, encoding, words):
    text = DECLARED.format(name) + TEXT.format(words)
    path = written(tmp_path, text.encode(encoding))
    document, stock = read_document(path).content, mx.createDocument()
    mx.readFromXmlFile(stock, str(path))
    assert document.getNode("shading").getDocString() == words
    assert mx.writeToXmlString(document) == mx.writeToXmlString(stock)


@pytest.mark.parametrize("encoding", ("utf-16", "utf-16-le", "utf-32", "utf-32-be", "latin-1"))
def test_other_encodings_are_refused_in_one_line(tmp_path, encoding):
    text = DECLARED.format(encoding) + TEXT.format("löök")
    for data in (text.encode(encoding), text.encode()):
        message = refusal(written(tmp_path, data))
        assert re.search("must be (a MaterialX document )?in UTF-8; |XML parse error", message)


def test_utf_16_is_named(tmp_path):
    message = refusal(written(tmp_path, TEXT.format("look").encode("utf-16")))
    assert message.endswith("this is UTF-16: save it as UTF-8")


def test_bytes_that_are_no_text_are_refused_with_their_place(tmp_path):
    message = refusal(written(tmp_path, TEXT.format("löök").encode() + b"\xff\xff\xff"))
    assert re.search(r"must be a MaterialX document in UTF-8.*byte \d", message)


@pytest.mark.parametrize("end", ["<!-- open", '<a name="<', "<![CDATA[", "<?open", "<a <b>/>", "&"])
def test_what_materialx_does_not_read_is_refused(tmp_path, end):
    path = written(tmp_path, TEXT.format("look").replace("</materialx>", end).encode())
    assert "must be a MaterialX document; XML parse error" in refusal(path)


def test_lines_keep_their_numbers(tmp_path):
    assert "line 5" in refusal(written(tmp_path, b"<!-- a\nb -->\n<materialx>\n\n<a"))
