# SPDX-License-Identifier: Apache-2.0
"""The explorer page in the package can be rebuilt from its sources on every machine."""

import shutil
import sys
from importlib.resources import files
from pathlib import Path

from tests.support.availability import PACKAGES, missing
from tests.support.command import output

SOURCES = Path(__file__).parents[2] / "explorer"
MODULES = SOURCES / "node_modules"
OWN = Path(sys.executable).with_name("node")
NODE = OWN if OWN.exists() else shutil.which("node")
TEMPLATE = files("mxeon.explorer").joinpath("explorer.html")


def needs_modules():
    """Skip the test if Node or its packages are missing, or fail if MXEON_REQUIRE demands them."""
    if not NODE or not MODULES.is_dir():
        missing(PACKAGES, "explorer/node_modules: must be installed; ./run test --all does it")


def test_the_template_is_built_from_the_sources(tmp_path):
    needs_modules()
    output(NODE, "build.mjs", tmp_path / "explorer.html", cwd=SOURCES)
    built = (tmp_path / "explorer.html").read_bytes()
    assert built == TEMPLATE.read_bytes(), "build it again: cd explorer && npm run build"


def test_the_sources_pass_the_compiler_and_the_formatter():
    needs_modules()
    output(NODE, MODULES / "typescript" / "bin" / "tsc", cwd=SOURCES)
    output(NODE, MODULES / "prettier" / "bin" / "prettier.cjs", "--check", ".", cwd=SOURCES)
