# SPDX-License-Identifier: Apache-2.0
"""The pool, and batches of documents on it: whatever becomes of a worker costs its own item and no other."""

import os
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from mxeon.cli.batch import BatchResult, WorkerCrashed, run_batch
from mxeon.errors import DocumentError
from mxeon.jobs import pool
from mxeon.jobs.pool import ATTEMPTS, Attempt, Outcome, Queue, in_order, run
from tests.support.faults import Tar, misbehave, need, once, square

NUMBERS = [1, 2, 3, 4]


def test_every_item_is_worked_on_once():
    found = dict(run(square, range(20), 2, 60.0))
    assert found == {item: Outcome(item * item) for item in range(20)}


def test_items_of_one_group_have_one_worker_as_long_as_there_are_groups_for_all():
    queue = Queue([Attempt(index, index, index % 3) for index in range(12)])
    taken = [[queue.take(worker).index for worker in (0, 1)] for _ in range(4)]
    assert taken == [[0, 1], [3, 4], [6, 7], [9, 10]]
    assert queue.take(0).index == 2  # the group that nobody works on
    assert queue.take(1).index == 5  # help with the longest, as there is no other
    assert [attempt.index for attempt in queue] == [8, 11] and len(queue) == 2


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
    found = dict(
        run(misbehave, [*NUMBERS[:2], fault, *NUMBERS[2:]], 2, 1.0 if fault == "hang" else 60.0)
    )
    assert found.pop(2) == Outcome(None, end, ATTEMPTS)
    assert sorted(outcome.value for outcome in found.values()) == [1, 4, 9, 16]


def test_a_bug_in_a_worker_shows_its_traceback_once(caplog):
    list(run(misbehave, ["raise"], 1, 60.0))
    assert caplog.text.count("Traceback") > 0 and "in misbehave" in caplog.text
    assert [record.message for record in caplog.records] == ["bug in a worker process"]


def test_an_error_with_words_for_the_user_is_no_bug(caplog):
    outcomes = dict(run(need, ["MOON"], 1, 60.0))
    assert outcomes[0].failure.startswith("NotRun: MOON: missing") and not caplog.records


def test_processes_that_hang_before_they_begin_are_given_up(monkeypatch):
    monkeypatch.setattr(pool, "START", 0.5)
    (outcome,) = dict(pool.run(square, [Tar()], 1, 1.0)).values()
    assert outcome == Outcome(None, "timed out after 1 s; last output: none", ATTEMPTS)


def test_an_item_whose_worker_was_killed_is_tried_again(tmp_path):
    items = [str(tmp_path / name) for name in "ab"]
    found = dict(run(once, items, 2, 60.0))
    assert found == dict.fromkeys((0, 1), Outcome("done", attempts=2))


def test_workers_never_hear_of_ctrl_c():
    (outcome,) = dict(run(_deaf, [0], 1, 60.0)).values()
    assert outcome.value and not _deaf(0)


def test_outcomes_are_put_in_order():
    assert list(in_order([(1, "b"), (2, "c"), (0, "a"), (3, "d")])) == ["a", "b", "c", "d"]


def test_what_workers_print_stays_out_of_ours(capfd):
    list(run(misbehave, ["exit"], 1, 60.0))
    assert capfd.readouterr() == ("", "")


def test_no_temporary_file_outlives_the_pool(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))  # other tests use the machine's
    outcomes = run(square, range(4), 1, 60.0)
    next(outcomes)
    assert list(tmp_path.glob("mxeon-pool-*"))
    outcomes.close()
    assert list(tmp_path.iterdir()) == []


def test_a_pool_that_breaks_again_and_again_is_given_up(monkeypatch):
    monkeypatch.setattr(pool, "_serve", lambda *_: iter(()))
    (outcome,) = dict(run(square, [3], 1, 1.0)).values()
    assert outcome.failure == "worker processes end before they begin to work"


def test_what_the_work_raises_is_no_time_out_of_ours():
    (outcome,) = dict(run(_late, [0], 1, 60.0)).values()
    assert outcome.failure.startswith("TimeoutError: mine; last output:")


@pytest.mark.parametrize(
    "options, words",
    [
        ((0, 1.0), "workers must be at least 1; got 0"),
        ((1, 0.0), "timeout must be positive and at most 1e.06 s; got 0"),
        ((1, float("inf")), "timeout must be positive and at most 1e.06 s; got inf"),
    ],
)
def test_an_impossible_pool_is_one_line(options, words):
    with pytest.raises(ValueError, match=f"^{words}$"):
        list(run(square, [1], *options))


def _late(_):
    raise TimeoutError("mine")


def _deaf(_):
    """Whether this process has had SIGINT blocked since it was started."""
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())


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
