# SPDX-License-Identifier: Apache-2.0
"""Documents with names that confuse a terminal or a runner."""

from itertools import product

from mxeon.shaders.library import examples_folder
from tests.fuzz.cases import OUT, Case

NAMES = (
    "::error::a", "  ::add-mask::a", "\t::stop-commands::a", "a\n::error::b", "a\r::error::b",
    "##[error]a", "a ##[add-mask]b", "\u2028::error::a", "::set-output name=a::b", "%0A::error::a",
    "t\xf6ne", "\u3042", "\U0001f600", "\x1b[31ma", "a\u202eb", "\ufeffa", "-a", "a'b\"c", "<b>a", "|a|",
)  # fmt: skip
CLAY = (examples_folder() / "clay.mtlx").read_bytes()
ENCODINGS = ("utf-8", "ascii", "latin-1", "cp1252", "shift_jis", "utf-16")
# Commands for a document with such a name.
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


def rows():
    """The stem of a document's name, a command, and the encoding of the terminal."""
    return product(NAMES, READERS, ENCODINGS)


def to_case(_, row):
    stem, command, encoding = row
    file = f"./{stem}.mtlx" if stem.startswith("-") else f"{stem}.mtlx"
    arguments = tuple(each.format(file) if "{}" in each else each for each in command)
    return Case(f"{stem!r} {command[0]} {encoding}", ((file, CLAY),), arguments, (), encoding)
