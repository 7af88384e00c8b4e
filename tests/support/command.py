# SPDX-License-Identifier: Apache-2.0
"""Runs mxeon in a separate process, and checks messages that must have one line."""

import os
import subprocess
import sys
import time

import pytest

from mxeon.shaders.library import examples_folder

CLAY = str(examples_folder() / "clay.mtlx")
PLASTER = str(examples_folder() / "plaster.mtlx")
DEADLINE = 300.0  # timeout in seconds, long enough for a busy machine


def run(*arguments, **environment):
    command = [sys.executable, "-m", "mxeon", *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **environment}, check=False
    )


def output(*command, **options):
    command = [*map(str, command)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def wait_for(condition, process):
    """Wait until a condition holds, and fail if the process ends first."""
    end = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < end
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.01)


def one_line(text):
    lines = [line for line in text.splitlines() if line.startswith("mxeon")]
    return lines[0] if len(lines) == 1 and "Traceback" not in text else ""
