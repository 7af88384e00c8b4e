# SPDX-License-Identifier: Apache-2.0
"""The style that tools can check: lint, format and types, as pyproject.toml configures them."""

import subprocess
import sys
from pathlib import Path

import pytest

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
    command = [sys.executable, "-m", *TOOLS[tool]]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
