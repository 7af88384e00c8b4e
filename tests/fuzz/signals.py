# SPDX-License-Identifier: Apache-2.0
"""Commands that get a signal at a random moment of their run."""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mxeon.shaders.library import examples_folder

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
STARTED = 0.3  # seconds after which the command, and not Python's start, gets the signal
LONGEST = 3.0  # seconds that the command takes
LIMIT = 60.0


def rows():
    """Signals and numbers of cases."""
    for number in range(1000):
        for name in SIGNALS:
            yield name, number


def struck(row):
    """Exit status of a command that gets a signal, and what was wrong, or ""."""
    name, number = row
    wait = random.Random(f"{name}-{number}").uniform(STARTED, LONGEST)
    with tempfile.TemporaryDirectory(prefix="mxeon-signals-") as folder:
        temporary, out = Path(folder, "tmp"), Path(folder, "out")
        temporary.mkdir()
        status, errors = _run(folder, temporary, out, name, wait)
        return status, "; ".join(_faults(status, errors, name, temporary, out))


def _run(folder, temporary, out, name, wait):
    document = str(examples_folder() / "plaster.mtlx")
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "mxeon", "generate", document, "--target", "glsl"]
        + ["--workers", "1", "--outputPath", str(out)],
        cwd=folder,
        env=os.environ | {"TMPDIR": str(temporary)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        process_group=0,
    )
    time.sleep(wait)
    process.send_signal(name)
    _, errors = process.communicate(timeout=LIMIT)
    return process.returncode, errors


def _faults(status, errors, name, temporary, out):
    if status not in (0, 128 + name, -name):
        yield f"ended with {status}"
    if "Traceback" in errors or "leaked" in errors:
        yield f"said {errors.strip().splitlines()[-1]!r}"
    left = [*temporary.iterdir(), *(out.glob(".*") if out.exists() else ())]
    if left:
        yield f"left {', '.join(path.name for path in left)}"
