# SPDX-License-Identifier: Apache-2.0
"""Malformed documents: words that often make programs fail, and mutations of valid documents."""

from copy import deepcopy
from functools import cache
from xml.etree import ElementTree

from mxeon.shaders.library import examples_folder

# Generated shaders may contain this call only if a document's own, permitted code has the call.
POISON = "poison()"
# Files outside the document's folder have this content. No output may contain the content.
CANARY = "canary-5f1e"

VALUES = (
    "", " ", "0", "-1", "1", "2", "1.5707964", "nan", "inf", "-inf", "1e999", "1e-400", "0x10",
    "0,0,0", "1, 1, 1", "0.5,0.5", "1,2,3,4,5", "true", "false", "none", "default", "%s%n", "{}",
    "{1;2}", "$HOME", "`id`", "99999999999999999999", "-0", "1_0", "١", "０.5", "0.5;1", "[tok]",
    "0.5f", "50%", "0.5.0", "1 1,1", "0.5 0.5",
    "a" * 300, "a" * 70_000, "\u202ereverse", "naïve", "\U0001f600", "\x7f", "\x85", "a\tb", "a\nb",
    '"', "'", "\\", 'x"; ' + POISON + '; "', ");" + POISON + ";(", "x;" + POISON, "*/" + POISON,
    "<script>" + POISON + "</script>", "&amp;", "]]>", "--", "//", "/*",
)  # fmt: skip

PATHS = (
    "../secret.glsl", "../secret.mtlx", "../../etc/passwd", "/etc/passwd", "/dev/zero", "/dev/null",
    "/dev/stdin", "/proc/self/mem", ".", "..", "/", "~", "~/x", "file:///etc/passwd", "//x/y",
    "link/secret.glsl", "link/secret.mtlx", "link/<UDIM>.png", "../<UDIM>.png", "<UDIM>", "<>",
    "tile.<UVTILE>.png", "[*].png", "base.mtlx", "textures", "textures/brick_color.png",
    "C:\\x.png", "a" * 300 + ".png", "./././textures/../textures/brick_color.png", "con", "-",
    "\x00",
)  # fmt: skip

ATTRIBUTES = (
    "name", "type", "value", "nodename", "nodegraph", "output", "interfacename", "inherit", "file",
    "sourcecode", "function", "target", "version", "fileprefix", "geomprefix", "colorspace", "unit",
    "unittype", "namespace", "href", "nodedef", "node", "implname", "defaultgeomprop", "geomprop",
    "index", "space",
    "enum", "enumvalues", "uniform", "channels", "xpos", "hint", "isdefaultversion", "semantic",
    "collection", "material", "look", "geom", "variant", "variantset", "uiname", "doc", "member",
    "includecollection", "members", "bsdf", "cms", "colormanagementconfig", "nodecategory",
)  # fmt: skip

CATEGORIES = (
    "input", "output", "token", "node", "nodegraph", "nodedef", "implementation", "typedef", "member",
    "look", "material", "materialassign", "collection", "geominfo", "geompropdef", "variant",
    "variantset", "unitdef", "unittypedef", "targetdef", "backdrop", "comment", "xi:include",
    "image", "tiledimage", "constant", "add", "multiply", "mix", "layer", "surface", "swizzle",
    "displacement", "surfacematerial", "volumematerial", "oren_nayar_diffuse_bsdf", "texcoord",
    "eon_diffuse_bsdf", "dielectric_bsdf", "conductor_bsdf", "standard_surface", "open_pbr_surface",
    "UsdPreviewSurface", "gltf_pbr", "LamaDiffuse", "geompropvalue", "switch", "dot", "separate3",
    "uniform_edf", "position", "normalmap", "artistic_ior", "shaderref", "bindinput", "parameter",
    "geomattr", "compare", "curveadjust", "convert", "combine2", "materialx", "propertyset",
)  # fmt: skip

ENCODINGS = (
    "utf-8", "utf-16", "iso-8859-1", "us-ascii", "ebcdic", "hex", "zlib", "rot13", "idna", "shift_jis",
    "unicode_escape", "mbcs", "", "a" * 300,
)  # fmt: skip

TYPES = (
    "float", "color3", "color4", "vector2", "vector3", "vector4", "integer", "boolean", "string",
    "filename", "matrix33", "matrix44", "BSDF", "EDF", "VDF", "surfaceshader", "displacementshader",
    "volumeshader", "lightshader", "material", "none", "multioutput", "floatarray", "stringarray",
    "geomname", "stranger",
)  # fmt: skip

NODEDEF = '<nodedef name="ND_x" node="x"><output name="out" type="BSDF"/></nodedef>'
SNIPPETS = (
    '<xi:include href="base.mtlx"/>',
    '<xi:include href="../secret.mtlx"/>',
    '<xi:include href="link/secret.mtlx"/>',
    '<xi:include href="part.mtlx"/>',
    NODEDEF + '<implementation name="IM_x" nodedef="ND_x" file="../secret.glsl" function="x"/>',
    NODEDEF + '<implementation name="IM_x" nodedef="ND_x" file="own.glsl" function="x"/>',
    NODEDEF + f'<implementation name="IM_x" nodedef="ND_x" sourcecode="{POISON}"/>',
    NODEDEF + '<nodegraph name="NG_x" nodedef="ND_x"><x name="x" type="BSDF"/>'
    '<output name="out" type="BSDF" nodename="x"/></nodegraph>',
    '<image name="stray" type="color3"><input name="file" type="filename" value="../secret.png"/>'
    "</image>",
    '<token name="tok" type="string" value="../secret"/>',
    '<typedef name="stranger"><member name="a" type="float" value="1"/></typedef>',
    '<typedef name="float"><member name="a" type="float"/></typedef>',
    '<typedef name="stranger"><member name="a" type="stranger"/></typedef>',
    '<geompropdef name="own" type="vector3" geomprop="UV0" index="9"/>',
    '<look name="l" inherit="l"><materialassign name="m" material="look" geom="*"/></look>',
    '<collection name="c" includecollection="c" includegeom="/a"/>',
    '<variantset name="v"><variant name="w"><input name="a" type="float" value="1"/></variant>'
    "</variantset>",
    '<material name="old"><shaderref name="s" node="standard_surface"><bindinput name="base" '
    'type="float" value="1"/></shaderref></material>',
    '<nodegraph name="ng"><input name="i" type="color3" interfacename="i"/>'
    '<output name="out" type="color3" interfacename="i"/></nodegraph>',
)

XI = 'xmlns:xi="http://www.w3.org/2001/XInclude"'
BOMB = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;">]>'
EXTERNAL = '<!DOCTYPE x [<!ENTITY a SYSTEM "../secret.mtlx">]>'
GRAPH = f"""<materialx version="1.39" {XI}>{NODEDEF}
  <nodegraph name="NG_x" nodedef="ND_x"><oren_nayar_diffuse_bsdf name="inner" type="BSDF"/>
    <output name="out" type="BSDF" nodename="inner"/></nodegraph>
  <nodegraph name="ng"><input name="tint" type="color3" value="0.5, 0.4, 0.3"/>
    <convert name="v" type="vector3"><input name="in" type="color3" interfacename="tint"/></convert>
    <transformmatrix name="t" type="vector3"><input name="in" type="vector3" nodename="v"/>
      <input name="mat" type="matrix33" value="1,0,0, 0,1,0, 0,0,1"/></transformmatrix>
    <convert name="k" type="color3"><input name="in" type="vector3" nodename="t"/></convert>
    <multiply name="m" type="color3"><input name="in1" type="color3" nodename="k"/>
      <input name="in2" type="float" value="0.5"/></multiply>
    <geompropvalue name="g" type="float"><input name="geomprop" type="string" value="wear"/>
    </geompropvalue>
    <output name="out" type="color3" nodename="m"/><output name="wear" type="float" nodename="g"/>
  </nodegraph>
  <oren_nayar_diffuse_bsdf name="a" type="BSDF">
    <input name="color" type="color3" nodegraph="ng" output="out"/>
    <input name="weight" type="float" nodegraph="ng" output="wear"/></oren_nayar_diffuse_bsdf>
  <x name="b" type="BSDF"/>
  <mix name="c" type="BSDF"><input name="fg" type="BSDF" nodename="a"/>
    <input name="bg" type="BSDF" nodename="b"/><input name="mix" type="float" value="0.5"/></mix>
  <surface name="s" type="surfaceshader"><input name="bsdf" type="BSDF" nodename="c"/></surface>
  <surfacematerial name="look" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="s"/></surfacematerial>
</materialx>"""


@cache
def originals():
    """Documents to mutate, as text: bundled examples, and three copies of a nodegraph document."""
    files = sorted(examples_folder().glob("*.mtlx"))
    return tuple(file.read_text(encoding="utf-8") for file in files) + (GRAPH,) * 3


def document(rng):
    text = rng.choice(originals())
    if rng.random() < 0.8:
        root = ElementTree.fromstring(text)
        for _ in range(rng.choice((1, 1, 2, 3, 8))):
            rng.choice(TREE)(rng, root)
        text = _written(root)
    if rng.random() < 0.02:
        text = rng.choice((BOMB, EXTERNAL)) + text.replace("0.5", "&a;", 1)
    data = text.encode(errors="surrogatepass")
    if rng.random() < 0.1:
        for _ in range(rng.choice((1, 1, 4, 16))):
            data = rng.choice(BYTES)(rng, data)
    return data


def _written(root):
    """XML text of a tree, which declares the prefix of XInclude if the tree uses the prefix."""
    text = ElementTree.tostring(root, encoding="unicode")
    if "xi:" in text and "xmlns:xi" not in text:
        text = text.replace("<materialx", f"<materialx {XI}", 1)
    return text


def word(rng, root=None):
    """Random value: an odd word, a path, a type name, or a value from the same document."""
    kind = rng.random()
    if kind < 0.45 or (root is None and kind < 0.8):
        return rng.choice(VALUES)
    if kind < 0.6 or root is None:
        return rng.choice(PATHS)
    if kind < 0.7:
        return rng.choice(TYPES)
    values = [value for each in root.iter() for value in each.attrib.values()]
    return rng.choice(values or [""])


def _element(rng, root):
    return rng.choice(list(root.iter()))


def _change(rng, root):
    element = _element(rng, root)
    if element.attrib:
        element.set(rng.choice(list(element.attrib)), word(rng, root))


def _set(rng, root):
    _element(rng, root).set(rng.choice(ATTRIBUTES), word(rng, root))


def _path(rng, root):
    files = [each for each in root.iter() if each.get("type") == "filename"]
    rng.choice(files or [root]).set("value" if files else "fileprefix", rng.choice(PATHS))


def _number(rng, root):
    numbers = [each for each in root.iter() if each.get("type") in ("float", "color3")]
    element = rng.choice(numbers or [root])
    number = rng.choice(("0", "1", "0.5", "1e-30", "1e30", "-1", "3", "1e39", "0.99999999"))
    element.set("value", ", ".join([number] * (3 if element.get("type") == "color3" else 1)))


def _connect(rng, root):
    inputs = [each for each in root.iter("input") if "type" in each.attrib]
    port = rng.choice(inputs or [root])
    fitting = [each for each in root.iter() if each.get("type") == port.get("type")]
    nodes = [each.get("name", "") for each in fitting if each.tag not in ("input", "output")]
    port.attrib = {key: port.get(key, "") for key in ("name", "type")}
    port.set("nodename", rng.choice(nodes or [""]))


def _text(rng, root):
    """Add a node with a random word in an input that accepts any text."""
    category, name = rng.choice(TEXTS)
    node = ElementTree.Element(category, {"name": "text", "type": "color3"})
    attributes = {"name": name, "type": "string", "value": rng.choice(VALUES)}
    ElementTree.SubElement(node, "input", attributes)
    root.insert(0, node)
    lobes = [each for each in root.iter() if each.tag.endswith("diffuse_bsdf")]
    lobe = rng.choice(lobes or [root])
    lobe[:] = [each for each in lobe if each.get("name") != "color"]
    attributes = {"name": "color", "type": "color3", "nodename": "text"}
    ElementTree.SubElement(lobe, "input", attributes)


def _drop(rng, root):
    element = _element(rng, root)
    if element.attrib:
        del element.attrib[rng.choice(list(element.attrib))]


def _remove(rng, root):
    parent = _element(rng, root)
    if len(parent):
        parent.remove(rng.choice(list(parent)))


def _copy(rng, root):
    original = _element(rng, root)
    if original is not root:
        copied = deepcopy(original)
        if rng.random() < 0.5:
            copied.set("name", f"copy{rng.randrange(1000)}")
        _element(rng, root).append(copied)


def _add(rng, root):
    attributes = {"name": f"new{rng.randrange(1000)}", "type": rng.choice(TYPES)}
    child = ElementTree.SubElement(_element(rng, root), rng.choice(CATEGORIES), attributes)
    child.set(rng.choice(ATTRIBUTES), word(rng, root))


def _snippet(rng, root):
    text = f"<part {XI}>{rng.choice(SNIPPETS)}</part>"
    for child in ElementTree.fromstring(text.replace("xi:include", "xi-include")):
        child.tag = child.tag.replace("xi-", "xi:")
        root.insert(0, child)


TEXTS = (
    ("geompropvalue", "geomprop"),
    ("image", "uaddressmode"),
    ("image", "filtertype"),
    ("tiledimage", "frameendaction"),
)
TREE = (_number,) * 6 + (_connect,) * 4 + (_text,) * 2
TREE += (_change,) * 8 + (_set,) * 4 + (_add, _copy, _drop, _path, _remove) * 2
TREE += (_snippet, _snippet)


def _flip(rng, data):
    place = rng.randrange(max(1, len(data)))
    return data[:place] + bytes([rng.randrange(256)]) + data[place + 1 :]


def _cut(rng, data):
    return data[: rng.randrange(len(data) + 1)]


def _insert(rng, data):
    place = rng.randrange(len(data) + 1)
    piece = rng.choice((b"\0", b"\xff", b"<", b">", b'"', b"&", b"&#0;", b"&#27;", b"&x;", b"]]>"))
    return data[:place] + piece * rng.choice((1, 1, 100)) + data[place:]


def _repeat(rng, data):
    start, stop = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    return data[:stop] + data[start:stop] * rng.choice((1, 3)) + data[stop:]


def _encode(rng, data):
    encoding = rng.choice(("utf-16", "utf-32", "utf-8-sig", "utf-7", "latin-1"))
    text = data.decode("utf-8", "replace")
    if rng.random() < 0.5:
        text = f'<?xml version="1.0" encoding="{rng.choice(ENCODINGS)}"?>{text}'
    return text.encode(encoding, "replace")


BYTES = (_flip, _flip, _flip, _cut, _insert, _insert, _repeat, _encode)
