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
    "types": ("mypy",),  # which remembers the files that are as they were
}


@pytest.mark.parametrize("tool", TOOLS)
def test_the_code_passes(tool):
    command = [sys.executable, "-m", *TOOLS[tool]]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=550)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_function_without_types_is_refused(tmp_path):
    (tmp_path / "untyped.py").write_text("def untyped(x): return x\n")
    configuration = ["--config-file", str(ROOT / "pyproject.toml"), "untyped.py"]
    command = [sys.executable, "-m", "mypy", "--no-incremental", *configuration]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=550)
    assert done.returncode == 1 and "missing a type annotation" in done.stdout
