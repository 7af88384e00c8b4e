# SPDX-License-Identifier: Apache-2.0
"""Markdown that `mxeon doc` fills or compares: odd markers, and tables with odd cells and headings."""

from itertools import product

from tests.fuzz.cases import OUT, Case
from tests.fuzz.words import PATHS, POISON, VALUES

MARKERS = (
    "@MX_TABLE_{}@", "@MX_TABLE_{}", "@MX_TABLE_@{}", "@MX_TABLE_oren_nayar_diffuse_bsdf@{}",
    "{}@MX_TABLE_mix@", "@MX_TABLE_sheen_bsdf@@MX_TABLE_{}@",
)  # fmt: skip
TABLES = (
    "# {}\n\n|Port|Type|\n|---|---|\n|`a`|float|\n",
    "# mix\n\n|Port|{}|\n|---|---|\n|`a`|float|\n",
    "# mix\n\n|{}|Type|\n|---|---|\n|`a`|float|\n",
    "# mix\n\n|Port|Type|\n|---|---|\n|{}|float|\n",
    "# mix\n\n|Port|Type|Default|\n|---|---|---|\n|`fg`|{}|\n",
    "# mix\n\n|Port|Type|Default|\n|---|---|---|\n|`fg`|BSDF|{}|\n",
    "# mix\n\n|Port|Type|Accepted Values|\n|---|---|---|\n|`mix`|float|{}|\n",
    "# mix\n\n|Port|Type|\n|---|---|\n|`a`|Same as `{}`|\n",
)
FILL = ("doc", "page.md", "--output", f"{OUT}/page.md")
COMPARE = ("doc", "page.md", "--compare")
ENCODINGS = ("utf-8", "utf-16", "latin-1")


def rows():
    """Text, command and encoding."""
    harmless = [each for each in (*VALUES, *PATHS) if POISON not in each]  # else it is written out
    for text, value, encoding in product(MARKERS, harmless, ENCODINGS):
        yield text.format(value), FILL, encoding
    for text, value, last in product(TABLES, (*VALUES, *PATHS), ((), ("--json",))):
        yield text.format(value), COMPARE + last, "utf-8"


def to_case(_, row):
    """The case of a row."""
    text, command, encoding = row
    data = text.encode(encoding, errors="replace")
    return Case(f"{text[:80]!r}, {encoding}", (("page.md", data),), command)
