# SPDX-License-Identifier: Apache-2.0
"""Folders as libraries, whose documents and sources are not what they should be.

Their authors are trusted, so a library may name any file; but it ends no process and fills no memory.
"""

from itertools import product

from tests.fuzz.cases import OUT, Case
from tests.fuzz.includes import FILES, FUNCTIONS, OTHERS, WAYS
from tests.fuzz.words import ENCODINGS, SNIPPETS
from tests.support.documents import connected, material

HEAD = '<materialx version="{}" xmlns:xi="http://www.w3.org/2001/XInclude">{}</materialx>'
NODE = """<nodedef name="ND_own" node="own"><output name="out" type="color3"/></nodedef>
<implementation name="IM_own" nodedef="ND_own" file="{}" {}/>"""
USED = material('<own name="own" type="color3"/>' + connected(color='nodename="own"'))
SECRET = ("secret", "/cwd/..")  # parts of names of files that a trusted library may show
NAMES = tuple(name for name in FILES if not any(part in name for part in SECRET))
LINKS = (
    ("zero.glsl", "/dev/zero"),
    ("pipe.glsl", ""),
    ("zero.mtlx", "/dev/zero"),
    ("pipe.mtlx", ""),
)
ELEMENTS = (
    *SNIPPETS,
    '<xi:include href="zero.mtlx"/>',
    '<xi:include href="pipe.mtlx"/>',
    '<xi:include href="own.mtlx"/>',
    '<xi:include href="missing.mtlx"/>',
    '<targetdef name="genglsl" inherit="genglsl"/>',
    '<implementation name="IM_oren_nayar_diffuse_bsdf_genglsl" file="own.glsl" function="own" '
    'nodedef="ND_oren_nayar_diffuse_bsdf" target="genglsl"/>',
    "<",
    "",
)
VERSIONS = ("1.39", "1.38", "1.36", "9.9", "", "x")
FOLDERS = ("lib", "lib/../lib", ".", "", "/dev", "base.mtlx", "textures", "missing", "lib/own.mtlx")


def rows():
    """A document and a source of a library; the folder that is named; which links it has."""
    plain = NODE.format("own.glsl", 'function="own"')
    for element, version, last in product(ELEMENTS, VERSIONS, (False, True)):
        yield HEAD.format(version, plain + element if last else element + plain), "", "lib", ()
    for way, name in product(WAYS, NAMES):
        yield HEAD.format("1.39", plain), way.format(name), "lib", ()
    for name, function in product(NAMES, ('function="own"', "")):
        text = HEAD.format("1.39", NODE.format(name.replace("\0", "\1"), function))
        yield text, "", "lib", ()
    for folder, link in product(FOLDERS, (*LINKS, None)):
        yield HEAD.format("1.39", plain), "", folder, (link,) if link else ()


def to_case(rng, row):
    """A library and a document that uses its node."""
    text, include, folder, links = row
    target = rng.choice(tuple(FUNCTIONS))
    encoding = rng.choice((*ENCODINGS, "utf-8", "utf-8", "utf-8"))
    source = f"{include}\n{FUNCTIONS[target]}"
    files = [("base.mtlx", USED.encode()), ("lib/own.mtlx", _encoded(text, encoding))]
    files += [("lib/own.glsl", source.encode())]
    files += [(f"lib/{name}", data) for name, data in OTHERS]
    linked = dict([(name, end) for name, end in LINKS if name.endswith(".glsl")] + list(links))
    arguments = ("generate", "base.mtlx", "--target", target, "--outputPath", OUT, "--library")
    own = f"lib{rng.randrange(10**9)}"  # a library is loaded once for each name in a process
    files = [(name.replace("lib/", f"{own}/", 1), data) for name, data in files]
    named = tuple((f"{own}/{name}", end) for name, end in linked.items())
    return Case(folder, tuple(files), (*arguments, folder.replace("lib", own)), named)


def _encoded(text, encoding):
    try:
        return text.encode(encoding)
    except (LookupError, UnicodeError):
        return text.encode()
