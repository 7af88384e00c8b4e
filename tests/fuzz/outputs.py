# SPDX-License-Identifier: Apache-2.0
"""Links planted where outputs go, and names of documents that a terminal or a runner stumbles on."""

from itertools import product

from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import OUT, Case

ENDS = ("../secret.png", "../documents/base.mtlx", "../stray", "../", "/dev/full")
CHECK = ("check", "base.mtlx", "--host", "msl", "--workers", "0", "--report", OUT)
# Commands, and names below the folder that each of them is told.
WRITERS = (
    (
        ("generate", "base.mtlx", "--target", "osl", "--outputPath", OUT),
        ("base.modeling_clay.osl", "base.terracotta.osl"),
    ),
    (
        CHECK,
        (
            "results.json", "junit.xml", "report.html", "pictures", "upstream", "journal",
            "journal/items.jsonl", "journal.previous", ".journal.lock",
        ),
    ),
    ((*CHECK, "--resume"), ("journal", "journal/items.jsonl", ".journal.lock")),
    (
        ("kit", "export", OUT, "--size", "64"),
        ("kit.json", "README.md", "sphere.obj", "sphere.usda", "materials", "scenes", "renders"),
    ),
)  # fmt: skip

NAMES = (
    "::error::a", "  ::add-mask::a", "\t::stop-commands::a", "a\n::error::b", "a\r::error::b",
    "##[error]a", "a ##[add-mask]b", "\u2028::error::a", "::set-output name=a::b", "%0A::error::a",
    "t\xf6ne", "\u3042", "\U0001f600", "\x1b[31ma", "a\u202eb", "\ufeffa", "-a", "a'b\"c", "<b>a", "|a|",
)  # fmt: skip
ENCODINGS = ("utf-8", "ascii", "latin-1", "cp1252", "shift_jis", "utf-16")
# Commands on a document of such a name.
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


def link_rows():
    """Where a link is planted, where it leads, and the command that would write there."""
    for arguments, names in WRITERS:
        for name, end in product(names, ENDS):
            yield arguments, name, end


def to_link(_, row):
    arguments, name, end = row
    links = ((f"{OUT}/{name}", end),)
    return Case(f"{arguments[0]} {name} {end}", _document("base.mtlx"), arguments, links)


def name_rows():
    """The stem of a document's name, a command, and the encoding of the terminal."""
    return product(NAMES, READERS, ENCODINGS)


def to_name(_, row):
    stem, command, encoding = row
    file = f"./{stem}.mtlx" if stem.startswith("-") else f"{stem}.mtlx"
    arguments = tuple(each.format(file) if "{}" in each else each for each in command)
    return Case(f"{stem!r} {command[0]} {encoding}", _document(file), arguments, (), encoding)


def _document(name):
    return ((name, (examples_folder() / "clay.mtlx").read_bytes()),)
