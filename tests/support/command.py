# SPDX-License-Identifier: Apache-2.0
"""The command in a process of its own, and the one line of its messages."""

import os
import subprocess
import sys

from mxeon.shaders.library import examples_folder

CLAY = str(examples_folder() / "clay.mtlx")
PLASTER = str(examples_folder() / "plaster.mtlx")


def run(*arguments, **environment):
    command = [sys.executable, "-m", "mxeon", *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **environment}, check=False
    )


def one_line(text):
    lines = [line for line in text.splitlines() if line.startswith("mxeon")]
    return lines[0] if len(lines) == 1 and "Traceback" not in text else ""
