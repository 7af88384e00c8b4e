# SPDX-License-Identifier: Apache-2.0
"""The programs of OSL: where they are, which version they are, and what they print."""

import os
import re
import shutil
import subprocess
import warnings
from collections.abc import Sequence
from pathlib import Path

from mxeon.errors import MxeonError, NotRun, ShaderError
from mxeon.hosts.base import RendererWarning

VARIABLES = {"oslc": "MXEON_OSLC", "testrender": "MXEON_TESTRENDER", "testshade": "MXEON_TESTSHADE"}
TIMEOUT = 300.0  # seconds for one of them
LINES = 4  # last ones of a program's output in a message
# The first line of the help: oslc has no option for its version.
TITLE = re.compile(r"^oslc -- (Open Shading Language) compiler (\S+)", re.MULTILINE)


def find_program(name: str, host: str = "testrender") -> str:
    """Path of a program that a host needs, named by its variable or on PATH."""
    variable = VARIABLES[name]
    program = os.environ.get(variable) or name
    path = shutil.which(program)
    if path is None:
        raise NotRun(
            f"{host}: no program {program!r}; build Open Shading Language, as tools/build_testrender.sh "
            f"does on Debian 12, and name it in {variable}"
        )
    return os.path.abspath(path)


def version(oslc: str) -> str:
    """Name and version of the language that an oslc compiles, as its help states them."""
    title = TITLE.search(output([oslc, "--help"]))
    if title is None:
        raise NotRun(f"testrender: {oslc} must be OSL's compiler; its help names no version")
    return f"{title[1]} {title[2]}"


def output(
    command: Sequence[str],
    folder: Path | None = None,
    failure: type[MxeonError] = NotRun,
    host: str = "testrender",
) -> str:
    """Standard output of a program; its warnings are passed on as `RendererWarning`.

    `failure` is raised with the last lines of a program that fails, ShaderError for an error reported by
    one that ends well: testrender goes on without the lobes that it has no room for.
    """
    try:
        process = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotRun(f"{host}: {error}") from None
    lines = (process.stdout + process.stderr).strip().splitlines()
    program = Path(command[0]).name
    if process.returncode:
        last = " | ".join(lines[-LINES:])
        raise failure(f"{host}: {program}: exit status {process.returncode}; last output: {last}")
    for line in lines:
        if line.startswith("ERROR") or "Assertion" in line:
            raise ShaderError(f"{host}: {program}: {line}")
    for line in dict.fromkeys(lines):
        if line.startswith("WARNING"):
            warnings.warn(f"{program}: {line}", RendererWarning, stacklevel=2)
    return process.stdout
