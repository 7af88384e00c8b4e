# SPDX-License-Identifier: Apache-2.0
"""The style that tools can check: lint, format and types, as pyproject.toml configures them."""

import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = {
    "lint": ("ruff", "check", "--no-cache"),
    "format": ("ruff", "format", "--check", "--no-cache"),
    "types": ("mypy",),
}


@pytest.mark.parametrize("tool", TOOLS)
def test_the_code_passes(tool):
    command = [sys.executable, "-m", *TOOLS[tool]]
    root = Path(__file__).parents[1]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=550)
    assert done.returncode == 0, done.stdout + done.stderr
