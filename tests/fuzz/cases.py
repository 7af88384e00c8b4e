# SPDX-License-Identifier: Apache-2.0
"""Cases of the fuzzer in four families.

`mutated` has random documents and command lines, made from a seed and a number. `found` has small
cases that reproduce faults found earlier. `includes` combines all ways in which a shader source may
include a file. `names` combines kinds of file names, commands and encodings.
"""

import random
import re
from dataclasses import dataclass
from itertools import product

from mxeon.shaders.library import examples_folder
from tests.fuzz.documents import CANARY, POISON, XI, document, word
from tests.support.documents import connected, material

TARGETS = ("glsl", "essl", "vulkan", "wgsl", "msl", "slang", "osl", "mdl")
OUT = "../out"

# Command lines to mutate. To be fast, some commands name a host that does not exist.
COMMANDS = (
    ("generate", "base.mtlx", "--target", "osl", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "glsl", "--element", "look", "--json", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "osl", "--profile", "cycles", "--outputPath", OUT),
    ("generate", "base.mtlx", "part.mtlx", "--target", "mdl", "--library", "stock", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "osl", "--maxSize", "9999", "--outputPath", OUT),
    ("generate", "base.mtlx", "--target", "osl", "--allowOutside", "--outputPath", OUT),
    ("render", "base.mtlx", "--host", "reference", "--size", "4", "--output", f"{OUT}/a.png"),
    ("render", "base.mtlx", "--host", "reference", "--scene", "back", "--output", f"{OUT}/a.exr", "--size", "4"),
    ("render", "base.mtlx", "--host", "reference", "--environment", "textures/a.png", "--output", f"{OUT}/a.png", "--size", "4"),
    ("check", "base.mtlx", "--host", "abacus"),
    ("check", "--library", "stock", "--report", f"{OUT}/r", "--resume", "--host", "abacus"),
    ("check", "--workers", "1", "--timeout", "5", "--json", "--host", "abacus"),
    ("library",),
    ("library", "--folder"),
    ("invert", "0.5", "0.4", "0.3", "--roughness", "0.5"),
    ("invert", "0.5", "0.4", "0.3", "--roughness", "1", "--average"),
    ("report", "make", "textures"),
    ("report", "diff", "results.json", "results.json"),
    ("kit", "check", "textures", "--renderer", "mine"),
    ("--version",),
    ("--help",),
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One test case of the fuzzer: a command line, and files and links in the working folder."""

    name: str
    files: tuple[tuple[str, bytes], ...]
    arguments: tuple[str, ...]
    links: tuple[tuple[str, str], ...] = ()
    encoding: str = "utf-8"


def case(seed, number):
    """Random case that depends only on the seed and the number."""
    rng = random.Random(f"{seed}-{number}")
    files = [("base.mtlx", document(rng))]
    if rng.random() < 0.15:
        files = [("base.mtlx", _including(rng)), ("part.mtlx", document(rng))]
    arguments = _command(rng) if rng.random() < 0.15 else _document(rng, files[0][1])
    return Case(f"{seed}-{number}", tuple(files), arguments)


def _including(rng):
    names = ("part.mtlx", "base.mtlx", "./part.mtlx", "../documents/part.mtlx", word(rng))
    name = rng.choice(names)
    href = "".join(each for each in name if each.isprintable() and each not in '"&<')
    includes = f'<xi:include href="{href}"/>' * rng.choice((1, 1, 2))
    return f'<materialx version="1.39" {XI}>{includes}</materialx>'.encode()


def _document(rng, data):
    """Random command line that renders a document or generates its shaders."""
    kind = rng.random()
    names = re.findall(r'<surfacematerial name="(\w+)"', data.decode(errors="replace"))
    if kind < 0.2:
        host = "gl" if kind < 0.01 else "reference"
        element = ("--element", rng.choice(names)) if names else ()
        output = ("--size", "4", "--output", f"{OUT}/a.png")
        return ("render", "base.mtlx", "--host", host, *element, *output)
    library = rng.choice(("eonlib", "eonlib", "eonlib", "stock"))
    arguments = ["generate", "base.mtlx", "--target", rng.choice(TARGETS), "--library", library]
    if rng.random() < 0.1:
        arguments += ["--profile", "cycles"]
    return (*arguments, "--outputPath", OUT)


def _command(rng):
    """Random command line, mutated from COMMANDS."""
    arguments = list(rng.choice(COMMANDS))
    for _ in range(rng.choice((1, 1, 2, 4))):
        place = rng.randrange(len(arguments))
        kind = rng.random()
        if kind < 0.5:
            kept = arguments[place - 1] in ("--outputPath", "--output", "--report", "--size")
            arguments[place] = arguments[place] if kept else word(rng)
        elif kind < 0.65:
            arguments.insert(place, rng.choice(arguments))
        elif kind < 0.8:
            other = rng.choice(COMMANDS)
            arguments.insert(place, rng.choice(other))
        elif len(arguments) > 1:
            del arguments[place]
    if "check" in arguments[:1]:
        arguments += ["--host", "abacus"]
    return tuple(arguments)


# Files outside the working folder. No case may read these files.
SECRET = f'<materialx version="1.39"><constant name="{CANARY}" type="float"/></materialx>'
AROUND = (
    ("secret.mtlx", SECRET),
    ("secret.glsl", f"// {CANARY}\n"),
    ("secret.png", CANARY),
    ("1001.png", CANARY),
)


# --- faults of earlier runs, and documents at a limit ---------------------------------------------

TINTED = connected(color='nodename="tint"')
ROUGH = connected(roughness='value="0"')
LEFT = '<mix name="lobe" type="BSDF"><input name="fg" type="BSDF" nodename="a"/></mix>'
ADD = '<add name="a{}" type="color3">{}</add>'
IMAGE = '<image name="tint" type="color3"><input name="{}" type="{}" value="{}"/></image>' + TINTED
PROPERTY = IMAGE.replace("image", "geompropvalue").format("geomprop", "string", f"x; {POISON};")
DEFINED = '<nodedef name="ND_{0}" node="{0}" {1}><output name="out" type="BSDF"/></nodedef>'
TWICE = """<nodegraph name="NG_g{0}" nodedef="ND_g{0}"><{1} name="x" type="BSDF"/>
  <{1} name="y" type="BSDF"/><add name="z" type="BSDF"><input name="in1" type="BSDF" nodename="x"/>
  <input name="in2" type="BSDF" nodename="y"/></add><output name="out" type="BSDF" nodename="z"/>
</nodegraph>"""
RENDER = ("render", "base.mtlx", "--host", "reference", "--size", "4", "--output", f"{OUT}/a.png")


def row(count, names):
    """Lobe colored by a chain of nodes. The inputs `names` of each node read the preceding node."""
    port = '<input name="{}" type="color3" nodename="a{}"/>'
    nodes = ADD.format(0, "")
    for number in range(1, count):
        nodes += ADD.format(number, "".join(port.format(name, number - 1) for name in names))
    return nodes + connected(color=f'nodename="a{count - 1}"')


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


# Each case has a title, the nodes of a document, and a command.
ROWS = (
    ("a lobe in an input", f'<input name="i" type="float">{ROUGH}</input>', _generate("glsl")),
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
    ("a property that is more than a name", PROPERTY, _generate("glsl")),
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


# --- families -----------------------------------------------------------------------------------

SEED = 1
COUNTS = {"found": len(FOUND), "mutated": 20_000, "includes": 1000, "names": 400}


def cases(family, count=None):
    """All cases of a family, or a random sample if the family has more than `count` cases."""
    rows, to_case = {
        "found": (FOUND, lambda _, found: found),
        "mutated": (range(20_000), lambda _, number: case(SEED, number)),
        "includes": (includes(), including),
        "names": (product(NAMES, READERS, ENCODINGS), named),
    }[family]
    rng, rows = random.Random(f"{SEED}-{family}"), list(rows)
    drawn = rng.sample(rows, min(count or COUNTS[family], len(rows)))
    return [to_case(rng, each) for each in drawn]


# --- shader sources that include forbidden files, in all forms and depths ---------------------

NODE = """<nodedef name="ND_own" node="own"><output name="out" type="color3"/></nodedef>
<implementation name="IM_own" nodedef="ND_own" file="{}" {}{}/><own name="own" type="color3"/>"""
FUNCTIONS = {
    "glsl": "void own(out vec3 result) { result = vec3(0.5); }",
    "msl": "void own(thread vec3& result) { result = vec3(0.5); }",
    "slang": "void own(out vec3 result) { result = vec3(0.5); }",
    "osl": "void own(output color result) { result = color(0.5); }",
    "mdl": "color own() { return color(0.5); }",
}
WAYS = (
    '#include "{}"',
    '  #include"{}" // it',
    '// #include "{}"',
    'x#include "{}"y',
    '#include "{}" "',
    "#include <{}>",
    "# include '{}'",
    '#include "{}"\r',
    '#include "lib/../{}"',
    '#include "./{}',
)
FILES = (
    "../secret.glsl", "link/secret.glsl", "/proc/self/cwd/../secret.glsl", "linked.glsl", "pipe.glsl",
    "zero.glsl", "/dev/zero", "/dev/stdin", "/proc/self/mem", "/etc/hostname", "", ".", "textures",
    "missing.glsl", "own.glsl", "part0.glsl", "latin.glsl", "empty.glsl", "marked.glsl", "null.glsl",
    "base.mtlx", "textures/brick_color.png", "$fileTransformUv", "lib/$fileTransformUv", "\x00",
    "../secret.glsl\x00", "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl", "a" * 300, "~", "$",
    "libraries/stdlib/genglsl/lib/$fileTransformUv", "libraries/../../../../../../../../../etc/hostname",
    "file:///etc/hostname", "link/documents/part1.glsl",
)  # fmt: skip
DEPTHS = (0, 1, 3, 15, 16, 400)
BROUGHT = ("own.glsl", *FILES)  # files named by implementation elements

LINKS = (("linked.glsl", "../secret.glsl"), ("zero.glsl", "/dev/zero"), ("pipe.glsl", ""))
OTHERS = (
    ("latin.glsl", b"// caf\xe9\nfloat latin;"),
    ("empty.glsl", b""),
    ("marked.glsl", b"\xef\xbb\xbffloat marked;"),
    ("null.glsl", b"float nothing;\0"),
)


def includes():
    """Rows of implementation file, form of include, included file, depth, target, and function."""
    for row in product(WAYS, FILES, DEPTHS, FUNCTIONS):
        yield "own.glsl", *row, 'function="own" '
    for name, target in product(BROUGHT, FUNCTIONS):
        for function in ('function="own" ', 'function="" ', ""):
            yield name, WAYS[0], "part0.glsl", 1, target, function


def including(rng, row):
    """Case with a document, and shader sources each of which includes the next source."""
    name, way, file, depth, target, function = row
    links = [WAYS[0].format(f"part{number}.glsl") for number in range(depth)]
    first, *parts = (f"{line}\n" for line in (*links, way.format(file)))
    sources = [("own.glsl", first + FUNCTIONS[target])]
    sources += [(f"part{number}.glsl", text + "float x;\n") for number, text in enumerate(parts)]
    limited = rng.choice(("", f'target="gen{target}" '))
    node = NODE.format(name.replace("\0", "\1"), function, limited)
    document = material(node + connected(color='nodename="own"'))
    files = [("base.mtlx", document), *sources]
    encoded = tuple((name, text.encode()) for name, text in files)
    arguments = ("generate", "base.mtlx", "--target", target, "--outputPath", OUT)
    if rng.random() < 0.1:
        arguments = ("render", "base.mtlx", "--size", "4", "--host", "reference", "--allowCode")
        arguments += ("--output", f"{OUT}/a.png")
    return Case(f"{way} {file} {depth}", encoded + OTHERS, arguments, LINKS)


# --- file names that confuse a terminal or a runner -------------------------------------------

NAMES = (
    "::error::a", "  ::add-mask::a", "\t::stop-commands::a", "a\n::error::b", "a\r::error::b",
    "##[error]a", "a ##[add-mask]b", "\u2028::error::a", "::set-output name=a::b", "%0A::error::a",
    "t\xf6ne", "\u3042", "\U0001f600", "\x1b[31ma", "a\u202eb", "\ufeffa", "-a", "a'b\"c", "<b>a", "|a|",
)  # fmt: skip
CLAY = (examples_folder() / "clay.mtlx").read_bytes()
ENCODINGS = ("utf-8", "ascii", "latin-1", "cp1252", "shift_jis", "utf-16")
# Commands that read the document with a given name.
READERS = (
    ("check", "{}", "--host", "msl", "--workers", "0"),
    ("check", "{}", "--host", "msl", "--workers", "0", "--full"),
    ("check", "{}", "--host", "msl", "--workers", "0", "--json"),
    ("check", "{}", "--host", "abacus"),
    ("generate", "{}", "--target", "osl", "--outputPath", OUT),
    ("generate", "{}", "--target", "osl", "--json", "--outputPath", OUT),
    ("generate", "missing {}", "--target", "osl", "--outputPath", OUT),
    ("render", "{}", "--host", "reference", "--size", "4", "--output", f"{OUT}/a.png"),
)  # fmt: skip


def named(_, row):
    """Case with an oddly named document, and a command whose terminal uses the given encoding."""
    stem, command, encoding = row
    file = f"./{stem}.mtlx" if stem.startswith("-") else f"{stem}.mtlx"
    arguments = tuple(each.format(file) if "{}" in each else each for each in command)
    return Case(f"{stem!r} {command[0]} {encoding}", ((file, CLAY),), arguments, (), encoding)
