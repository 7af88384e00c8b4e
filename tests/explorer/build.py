# SPDX-License-Identifier: Apache-2.0
"""Node and the packages for building the page, which `./run` installs."""

import shutil
import sys
from pathlib import Path

from tests.support.availability import PACKAGES, missing

SOURCES = Path(__file__).parents[2] / "explorer"
MODULES = SOURCES / "node_modules"


def node():
    """Path of this environment's node, or of another one; None if there is none."""
    own = Path(sys.executable).with_name("node")
    return str(own) if own.exists() else shutil.which("node")


def needs_modules():
    """Skip the test if the packages are not installed; fail if `./run test --all` should have installed them."""
    if node() and MODULES.is_dir():
        return
    missing(PACKAGES, "explorer/node_modules: must be installed; ./run test --all does it")
