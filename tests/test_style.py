# SPDX-License-Identifier: Apache-2.0
"""The code passes lint, format and type checks as configured in pyproject.toml."""

import re
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from tests.support.command import output

ROOT = Path(__file__).parents[1]
WINDOWS = ("mypy", "--platform", "win32", "--cache-dir", ".mypy_cache/win32")
TOOLS = [("ruff", "check", "--no-cache"), ("ruff", "format", "--check", "--no-cache")]
TOOLS += [pytest.param(tool, marks=pytest.mark.whole) for tool in (("mypy",), WINDOWS)]


@pytest.mark.parametrize("tool", TOOLS)
def test_the_code_passes(tool):
    output(sys.executable, "-m", *tool, cwd=ROOT)


WORDS = "of from for to in by with that which whose where as on at over than beside below above"
FRAGMENT = re.compile(f"(^|  ) *# ({'|'.join(WORDS.split())}|without) ")


def fragments(text):
    """Lines whose comment begins like a fragment, except continuation lines and strings."""
    lines, found = [line.lstrip() for line in text.splitlines()], []
    for before, line in pairwise(["", *lines]):
        if FRAGMENT.search(line) and line[:1] != '"' and not (before[:1] == line[:1] == "#"):
            found.append(line)
    return found


def test_comments_stand_by_themselves():
    files = [f for part in ("python", "tools", "tests") for f in (ROOT / part).rglob("*.py")]
    texts = [f.read_text("utf-8") for f in files if f != Path(__file__)]
    assert [line for text in texts for line in fragments(text)] == []
