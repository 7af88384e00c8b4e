# SPDX-License-Identifier: Apache-2.0
"""The Python in which Blender runs."""

from __future__ import annotations

import os
from pathlib import Path

from mxeon.errors import NotRun
from mxeon.shaders.library import data_folder

CHECKOUT = data_folder()  # in an installed package, no folder that has an environment


def interpreter(name: str = "cycles") -> Path:
    """Path of the Python that has `bpy`: MXEON_CYCLES_PYTHON, or in the checkout's `.venv-cycles`.

    A `.venv-cycles` in the working folder is not used: anyone may have put it there.
    """
    path = os.environ.get("MXEON_CYCLES_PYTHON")
    python = Path(path or Path(CHECKOUT, ".venv-cycles", "bin", "python"))
    if python.is_file() and os.access(python, os.X_OK):
        return python
    missing = f"no interpreter {path}" if path else "no folder .venv-cycles"
    raise NotRun(
        f"{name}: {missing}; pip install bpy==5.0.1 in an environment of Python 3.11 "
        "and name its interpreter in MXEON_CYCLES_PYTHON"
    )
