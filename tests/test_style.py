# SPDX-License-Identifier: Apache-2.0
"""The style that tools can check: lint, format and types, as pyproject.toml configures them, and stiff English."""

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOOLS = {
    "lint": ("ruff", "check", "--no-cache"),
    "format": ("ruff", "format", "--check", "--no-cache"),
    "types": ("mypy",),
    "types on Windows": ("mypy", "--platform", "win32", "--cache-dir", ".mypy_cache/win32"),
}
PARTLY = ("conformance", "models")  # packages whose docstrings and comments are not read
# Turns of phrase that a reader has to read twice, and what to write.
STIFF = {
    r"in (the )?place of": "instead of",
    r"of which": "whose, or a new sentence",
    r"there (is|are) (one|none),? where": "name who has it and who lacks it",
    r"\w+ of (its|their|your|one's) own(?=[^\w ]| (and|that|in|or|for|to)\b)": "its own ...",
    r"one's own": "your own",
    r"from [\w.]+( [\w.]+)? on(?=[,.;:)])": "since ..., at least ..., ... and later",
    r"\w\W, says \w+": "X says: ...",
    r"(is|are) (asked|told|answered) (of|by|with|so)\b": "the verb of what happens",
    r"stands? (in|on|at|for|below|there) (the|a|their|its) (page|report|summary|table|file|text|picture)s?\b": "is",
    r"so (has|have|is|are) (that|those|the|its)\b": "repeat the noun",
    r"that (is|are) no (?!longer|more|less)": "that is not a",
    r"with the words of": "with the message of",
    r"costs? (one|a) (check|task|item|run)": "loses one ...",
    r"what (it|they|one) (has|have) (of|in|for)\b": "name the thing",
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
    command = [sys.executable, "-m", *TOOLS[tool]]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@cache  # parsing takes longer than all patterns
def read(module):
    """Text of a module; of PARTLY without docstrings and comments: its messages and help texts among it."""
    text = module.read_text(encoding="utf-8")
    if not set(PARTLY) & set(module.parts):
        return text
    nodes = list(ast.walk(ast.parse(text)))
    lone = {id(each.value) for each in nodes if isinstance(each, ast.Expr)}
    strings = (each for each in nodes if isinstance(each, ast.Constant) and id(each) not in lone)
    return "\n".join(each.value for each in strings if isinstance(each.value, str))


@pytest.mark.parametrize("pattern", STIFF)
def test_pages_and_messages_read_as_written_not_as_translated(pattern):
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
    texts = {page: page.read_text(encoding="utf-8") for page in pages}
    texts |= {module: read(module) for module in sorted((ROOT / "python").rglob("*.py"))}
    stiff = re.compile(r"\b" + pattern.replace(" ", r"\s+"), re.IGNORECASE)
    found = [(str(path), each[0]) for path, text in texts.items() for each in stiff.finditer(text)]
    assert found == [], f"write: {STIFF[pattern]}"
