# SPDX-License-Identifier: Apache-2.0
"""Words that often make programs fail, for mutated documents and command lines."""

POISON = "poison()"  # forbidden in shaders, except in a document's own permitted source
CANARY = "canary-5f1e"  # text in files outside the document's folder

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
