# SPDX-License-Identifier: Apache-2.0
"""A run of `mxeon check` as a user starts it, in a folder of its own."""

import subprocess
import time
from pathlib import Path

import psutil

from mxeon.conformance.run import read_run
from mxeon.conformance.run.journal import JOURNAL, read_journal
from mxeon.jobs.processes import PYTHON
from mxeon.shaders.library import examples_folder

DOCUMENT = examples_folder() / "plaster.mtlx"


def start(folder, *options, files=(DOCUMENT,), capture=True):
    """The process of a run that keeps its journal and report in `folder`, resumed if begun.

    It leads a process group of its own, like a command in a terminal.
    """
    command = [*PYTHON, "-m", "mxeon", "check", *map(str, files), "--node", "common"]
    command += ["--report", str(folder), "--resume", "--workers", "2", *options]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} if capture else {}
    return psutil.Popen(command, text=True, process_group=0, **streams)


def finished(folder):
    """How many items a run has finished; 0 before it has begun."""
    path = Path(folder, JOURNAL)
    return max(0, path.read_bytes().count(b"\n") - 1) if path.exists() else 0


def verdicts(folder):
    """What a run found, as a set that two equal runs share."""
    return {
        (each.check, each.subject, each.host, each.library, each.verdict, each.error)
        for each in read_run(folder).results
    }


def done_twice(folder):
    """How many items have more than one line in a journal."""
    _, findings = read_journal(folder)
    return finished(folder) - len(findings)


def workers(process):
    """The processes that work for a run, those that they started included."""
    try:
        return [
            each
            for each in process.children(recursive=True)
            if "spawn_main" in "".join(each.cmdline())
        ]
    except psutil.Error:
        return []


def wait_for_end(process, seconds):
    """Exit status and standard error of a run."""
    try:
        _, errors = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        raise TimeoutError(f"a run did not end within {seconds} s") from None
    return process.returncode, errors.strip()


def until(condition, seconds, process):
    """Wait for a condition, or for the end of the process; whether it came true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and process.poll() is None:
        if condition():
            return True
        time.sleep(0.005)
    return condition()
