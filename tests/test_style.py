# SPDX-License-Identifier: Apache-2.0
"""The code passes lint, format and type checks as configured in pyproject.toml."""

import re
import sys
from pathlib import Path

import pytest

from tests.support.command import output

ROOT = Path(__file__).parents[1]
TOOLS = {
    "lint": ("ruff", "check", "--no-cache"),
    "format": ("ruff", "format", "--check", "--no-cache"),
    "types": ("mypy",),
    "types on Windows": ("mypy", "--platform", "win32", "--cache-dir", ".mypy_cache/win32"),
}


@pytest.mark.parametrize(
    "tool",
    [
        "lint",
        "format",
        *(pytest.param(tool, marks=pytest.mark.whole) for tool in ("types", "types on Windows")),
    ],
)
def test_the_code_passes(tool):
    output(sys.executable, "-m", *TOOLS[tool], cwd=ROOT)


FRAGMENT = re.compile(
    "(^|  ) *# (of|from|for|to|in|by|with|that|which|whose|where|as|on|at|over|than|beside|below|above"
    "|without) "
)


def fragments(text):
    """Lines whose comment begins like a fragment; continuation lines and strings are ignored."""
    lines = [line.lstrip() for line in text.splitlines()]
    pairs = zip(["", *lines], lines, strict=False)
    return [
        b
        for a, b in pairs
        if FRAGMENT.search(b) and not (a[:1] == b[:1] == "#") and not b.startswith('"')
    ]


def test_comments_stand_by_themselves():
    files = [f for part in ("python", "tools", "tests") for f in (ROOT / part).rglob("*.py")]
    texts = [f.read_text("utf-8") for f in files if f != Path(__file__)]
    assert [line for text in texts for line in fragments(text)] == []
