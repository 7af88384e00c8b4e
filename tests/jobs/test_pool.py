# SPDX-License-Identifier: Apache-2.0
"""If a worker of the pool fails, only the worker's item is lost, also in batches of documents."""

import os
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from mxeon.cli.batch import BatchResult, run_batch
from mxeon.errors import DocumentError
from mxeon.jobs.pool import ATTEMPTS, Outcome, run
from tests.support.faults import misbehave, once, square


@pytest.mark.parametrize(
    "fault, end",
    [
        ("SIGKILL", "worker process crashed (SIGKILL); last output: about to SIGKILL"),
        ("SIGSEGV", "worker process crashed (SIGSEGV); last output: about to SIGSEGV"),
        ("exit", "worker process ended with exit status 7; last output: about to exit"),
        ("hang", "timed out after 1 s; last output: about to hang"),
        ("raise", "RuntimeError: no light; last output: about to raise"),
    ],
)
def test_a_fault_costs_its_item_alone_and_is_named(fault, end):
    found = dict(run(misbehave, [1, 2, fault, 3, 4], 2, 1.0 if fault == "hang" else 60.0))
    assert found.pop(2) == Outcome(None, end, ATTEMPTS)
    assert sorted(outcome.value for outcome in found.values()) == [1, 4, 9, 16]


def test_an_item_whose_worker_was_killed_is_tried_again(tmp_path):
    items = [str(tmp_path / name) for name in "ab"]
    found = dict(run(once, items, 2, 60.0))
    assert found == dict.fromkeys((0, 1), Outcome("done", attempts=2))


def test_workers_never_hear_of_ctrl_c():
    (outcome,) = dict(run(_deaf, [0], 1, 60.0)).values()
    assert outcome.value and not _deaf(0)


def test_no_temporary_file_outlives_the_pool(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))  # a folder that no other test uses
    outcomes = run(square, range(4), 1, 60.0)
    next(outcomes)
    assert list(tmp_path.glob("mxeon-pool-*"))
    outcomes.close()
    assert list(tmp_path.iterdir()) == []


def _deaf(_):
    """Whether SIGINT is blocked in this process."""
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def hesitant(document):
    warnings.warn(f"{document} is odd", stacklevel=2)
    if document == "bad":
        raise DocumentError("bad: must be good")
    return document.upper()


@pytest.mark.parametrize("workers", [0, 2])
def test_values_warnings_and_errors_come_in_order(workers):
    one, bad, two = run_batch(hesitant, ["one", "bad", "two"], workers, 60.0)
    assert one == BatchResult("ONE", ("one is odd",))
    assert (bad.value, bad.warnings) == (None, ("bad is odd",))
    assert isinstance(bad.error, DocumentError) and str(bad.error) == "bad: must be good"
    assert two == BatchResult("TWO", ("two is odd",))


def test_a_bug_in_a_worker_prints_its_traceback():
    code = "from tests.support.faults import misbehave; from mxeon.cli.batch import run_batch\n"
    code += "[result] = run_batch(misbehave, ['raise'], 1, 60.0); print(result.error)"
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.stdout.startswith("raise: RuntimeError: no light; last output:")
    assert done.stderr.startswith("bug in a worker process\n") and "in misbehave" in done.stderr
