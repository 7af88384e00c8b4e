# SPDX-License-Identifier: Apache-2.0
"""Families of cases, each of which is a sample of a product of tables.

Tables list, for example, all ways to include a file, or kinds of file names. Two families have no
tables: `mutated` has random documents and command lines, and `found` has faults of earlier runs.
"""

import random
from itertools import product

from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import OUT, Case, case
from tests.fuzz.found import FOUND
from tests.support.documents import connected, material

SEED = 1
COUNTS = {"found": len(FOUND), "mutated": 20_000, "includes": 1000, "names": 400}


def cases(family, count=None):
    """All cases of a family, or a random sample if there are more than `count`."""
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
BROUGHT = ("own.glsl", *FILES)  # files named by the implementation element

LINKS = (("linked.glsl", "../secret.glsl"), ("zero.glsl", "/dev/zero"), ("pipe.glsl", ""))
OTHERS = (
    ("latin.glsl", b"// caf\xe9\nfloat latin;"),
    ("empty.glsl", b""),
    ("marked.glsl", b"\xef\xbb\xbffloat marked;"),
    ("null.glsl", b"float nothing;\0"),
)


def includes():
    """Rows: implementation's file, form of the include, included file, depth, target, function."""
    for row in product(WAYS, FILES, DEPTHS, FUNCTIONS):
        yield "own.glsl", *row, 'function="own" '
    for name, target in product(BROUGHT, FUNCTIONS):
        for function in ('function="own" ', 'function="" ', ""):
            yield name, WAYS[0], "part0.glsl", 1, target, function


def including(rng, row):
    """Case with a document and a chain of shader sources that include each other."""
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
# Commands that read a document by its name.
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
    """Case with an oddly named document, for a command whose terminal has the given encoding."""
    stem, command, encoding = row
    file = f"./{stem}.mtlx" if stem.startswith("-") else f"{stem}.mtlx"
    arguments = tuple(each.format(file) if "{}" in each else each for each in command)
    return Case(f"{stem!r} {command[0]} {encoding}", ((file, CLAY),), arguments, (), encoding)
