# SPDX-License-Identifier: Apache-2.0
"""Jobs in worker processes: results in order, whatever becomes of the processes."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from mxeon.cli.batch import BatchResult, WorkerCrashed, run_batch
from mxeon.errors import DocumentError
from mxeon.shaders.library import examples_folder
from tests.support.faults import misbehave

CLAY = str(examples_folder() / "clay.mtlx")

with_processes = pytest.mark.parametrize("workers", [0, 2])


def process(_):
    return os.getpid()


def hesitant(document):
    warnings.warn(f"{document} is odd", stacklevel=2)
    if document == "bad":
        raise DocumentError("bad: must be good")
    return document.upper()


@with_processes
def test_values_warnings_and_errors_come_in_order(workers):
    one, bad, two = run_batch(hesitant, ["one", "bad", "two"], workers, 60.0)
    assert one == BatchResult("ONE", ("one is odd",))
    assert (bad.value, bad.warnings) == (None, ("bad is odd",))
    assert isinstance(bad.error, DocumentError) and str(bad.error) == "bad: must be good"
    assert two == BatchResult("TWO", ("two is odd",))


def test_no_workers_means_this_process():
    assert [each.value for each in run_batch(process, [0], 0, 60.0)] == [os.getpid()]
    assert [each.value for each in run_batch(process, [0], 1, 60.0)] != [os.getpid()]


def test_a_process_that_crashes_costs_its_document_alone():
    first, crashed, last = run_batch(misbehave, [2, "SIGSEGV", 3], 1, 60.0)
    assert (first, last) == (BatchResult(4), BatchResult(9))
    assert isinstance(crashed.error, WorkerCrashed) and str(crashed.error) == (
        "SIGSEGV: worker process crashed (SIGSEGV); last output: about to SIGSEGV"
    )


def test_a_bug_in_a_worker_prints_its_traceback():
    code = "from tests.support.faults import misbehave; from mxeon.cli.batch import run_batch\n"
    code += "[result] = run_batch(misbehave, ['raise'], 1, 60.0); print(result.error)"
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert done.stdout.startswith("raise: RuntimeError: no light; last output:")
    assert done.stderr.startswith("bug in a worker process\n") and "in misbehave" in done.stderr
