# SPDX-License-Identifier: Apache-2.0
"""The page in the package can be rebuilt from its sources on every machine."""

import subprocess
from importlib.resources import files

from tests.explorer.build import MODULES, SOURCES, needs_modules, node

TEMPLATE = files("mxeon.explorer").joinpath("explorer.html")


def run(*command):
    done = subprocess.run(
        [node(), *map(str, command)], cwd=SOURCES, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_template_is_built_from_the_sources(tmp_path):
    needs_modules()
    run("build.mjs", tmp_path / "explorer.html")
    built = (tmp_path / "explorer.html").read_bytes()
    assert built == TEMPLATE.read_bytes(), "build it again: cd explorer && npm run build"


def test_the_sources_pass_the_compiler_and_the_formatter():
    needs_modules()
    run(MODULES / "typescript" / "bin" / "tsc")
    run(MODULES / "prettier" / "bin" / "prettier.cjs", "--check", ".")
