# SPDX-License-Identifier: Apache-2.0
"""Small cases that reproduce faults found by the fuzzer and by the search for limits."""

from tests.fuzz.cases import OUT, Case
from tests.fuzz.words import POISON
from tests.support.documents import connected, material

TINTED = connected(color='nodename="tint"')
ROUGH = connected(roughness='value="0"')
LEFT = '<mix name="lobe" type="BSDF"><input name="fg" type="BSDF" nodename="a"/></mix>'
ADD = '<add name="a{}" type="color3">{}</add>'
IMAGE = '<image name="tint" type="color3"><input name="{}" type="{}" value="{}"/></image>' + TINTED
GEOMPROP = IMAGE.replace("image", "geompropvalue")
DEFINED = '<nodedef name="ND_{0}" node="{0}" {1}><output name="out" type="BSDF"/></nodedef>'
TWICE = """<nodegraph name="NG_g{0}" nodedef="ND_g{0}"><{1} name="x" type="BSDF"/>
  <{1} name="y" type="BSDF"/><add name="z" type="BSDF"><input name="in1" type="BSDF" nodename="x"/>
  <input name="in2" type="BSDF" nodename="y"/></add><output name="out" type="BSDF" nodename="z"/>
</nodegraph>"""
RENDER = ("render", "base.mtlx", "--host", "reference", "--size", "4", "--output", f"{OUT}/a.png")


def row(count, names):
    """Lobe whose color comes from a chain of nodes; each uses the previous node in all `names`."""
    port = '<input name="{}" type="color3" nodename="a{}"/>'
    nodes = (
        ADD.format(number, "".join(port.format(name, number - 1) for name in names if number))
        for number in range(count)
    )
    return "".join(nodes) + connected(color=f'nodename="a{count - 1}"')


def _generate(target):
    return "generate", "base.mtlx", "--target", target, "--outputPath", OUT


def doubled(count):
    definitions = "".join(DEFINED.format(f"g{number}", "") for number in range(count))
    parts = ["eon_diffuse_bsdf", *(f"g{number}" for number in range(count))]
    graphs = "".join(TWICE.format(number, parts[number]) for number in range(count))
    return f'{definitions}{graphs}<{parts[count]} name="lobe" type="BSDF"/>'


def _inherited(count):
    rows = (DEFINED.format(f"i{n}", f'inherit="ND_i{n - 1}"' if n else "") for n in range(count))
    return "".join(rows) + f'<i{count - 1} name="lobe" type="BSDF"/>'


# Title, nodes of the document, and command.
ROWS = (
    (
        "a lobe in an input",
        '<input name="i" type="float">' + ROUGH + "</input>",
        _generate("glsl"),
    ),
    ("a mix of one", f'<eon_diffuse_bsdf name="a" type="BSDF"/>{LEFT}', RENDER),
    ("an image without a file", IMAGE.format("default", "color3", "1, 0, 0"), RENDER),
    ("a row too long for recursion", row(900, ("in1",)), RENDER),
    ("a row of which each uses the last twice", row(60, ("in1", "in2")), RENDER),
    ("nodegraphs of which each uses the last twice", doubled(60), _generate("osl")),
    ("definitions of which each inherits the last", _inherited(20_000), _generate("osl")),
    (
        "a type of the libraries with members",
        '<typedef name="float"><member name="a" type="float"/></typedef>' + ROUGH,
        _generate("glsl"),
    ),
    (
        "a text that ends its quotes",
        IMAGE.format("uaddressmode", "string", f"x&quot;; {POISON}; //"),
        _generate("osl"),
    ),
    (
        "a file name that ends its quotes",
        IMAGE.format("file", "filename", f"&lt;UDIM&gt;&quot;; {POISON}; //"),
        _generate("osl"),
    ),
    (
        "a property that is more than a name",
        GEOMPROP.format("geomprop", "string", f"x; {POISON};"),
        _generate("glsl"),
    ),
    (
        "a choice that is none",
        IMAGE.format("uaddressmode", "string", f"periodic); {POISON}; ("),
        _generate("mdl"),
    ),
)
FOUND = tuple(
    Case(name, (("base.mtlx", material(nodes).encode()),), arguments)
    for name, nodes, arguments in ROWS
) + (
    Case("an argument of one long word", (), ("library", "a" * 70_000)),
    Case("an argument that turns what is said", (), ("library", "\u202elrat")),
)
