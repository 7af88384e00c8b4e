# SPDX-License-Identifier: Apache-2.0
"""Node and the packages that the page is built with, which `./run` installs."""

import shutil
import sys
from pathlib import Path

from tests.support.availability import PACKAGES, missing

SOURCES = Path(__file__).parents[2] / "explorer"
MODULES = SOURCES / "node_modules"


def node():
    """Path of node: that of this environment, or another; None if there is none."""
    own = Path(sys.executable).with_name("node")
    return str(own) if own.exists() else shutil.which("node")


def needs_modules():
    """Skip the test where the packages are not installed; fail where `./run test --all` was to do it."""
    if node() and MODULES.is_dir():
        return
    missing(PACKAGES, "explorer/node_modules: must be installed; ./run test --all does it")
