# SPDX-License-Identifier: Apache-2.0
"""The journal of a run lists every finished task exactly once, and lists no unfinished task."""

import gc
import subprocess
import sys
import threading
from concurrent import futures
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from mxeon import check
from mxeon.conformance.results.records import StoredImage
from tests.support.command import DEADLINE, PLASTER, wait_for
from tests.support.faults import room_for
from tests.support.plans import keep_checks
from tests.support.results import (
    FILES,
    FINDINGS,
    JOURNAL,
    LOCK,
    PIXELS,
    PLAN,
    PREVIOUS,
    TASKS,
    journal,
    read_journal,
    read_run,
    to_run,
)


def kept(folder, *numbers, findings=FINDINGS, plan=PLAN):
    """Write a journal in which the numbered tasks have finished; return the journal's path."""
    with journal(folder, plan) as written:
        for number in numbers:
            written.add(number, findings)
    return folder / JOURNAL


def test_findings_come_back_as_they_were(tmp_path):
    kept(tmp_path, 1)
    plan, found = read_journal(tmp_path)
    assert plan == PLAN and list(found) == [1]
    (picture,) = found[1].pictures
    assert np.array_equal(picture.image, PIXELS) and picture.reference is None
    assert replace(found[1], pictures=()) == replace(FINDINGS, pictures=())
    assert to_run(plan, found).missing == (str(TASKS[0]), str(TASKS[2]))


def test_a_torn_last_line_is_dropped_and_its_task_done_again(tmp_path):
    path = kept(tmp_path, 0, 1)
    whole = path.read_bytes()
    path.write_bytes(whole[:-7])
    with journal(tmp_path, resume=True) as resumed:
        assert list(resumed.findings) == [0]
        resumed.add(1, FINDINGS)
    assert path.read_bytes() == whole


def pixels(array):
    stream = BytesIO()
    np.save(stream, array)
    return stream.getvalue()


HUGE = pixels(PIXELS).replace(b"(2, 2, 3), }           ", b"(100000, 1000000, 3), }")


@pytest.mark.parametrize("content", [None, b"", pixels(PIXELS)[:-1], pixels(1.0 - PIXELS), HUGE])
def test_a_task_whose_picture_is_damaged_is_done_again(tmp_path, content):
    kept(tmp_path, 0)
    (picture,) = tmp_path.glob("journal/*.npy")
    picture.unlink()
    if content is not None:
        picture.write_bytes(content)
    assert read_journal(tmp_path)[1] == {} and str(TASKS[0]) in read_run(tmp_path).missing
    with journal(tmp_path, resume=True) as resumed:
        resumed.add(0, FINDINGS)
    assert np.array_equal(read_journal(tmp_path)[1][0].pictures[0].image, PIXELS)


def refused(folder):
    """Assert that an invalid journal is refused with a one-line message, and return the message."""
    with pytest.raises(ValueError, match=f"{JOURNAL}: must be a journal of format 10") as error:
        read_run(folder)
    with pytest.raises(ValueError, match="as mxeon wrote it; .*; run again without --resume$"):
        journal(folder, resume=True).__enter__()
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("text", ["", "{}\n", "[]\n", '{"format": 0}\n', "\0\n", '{"format": 9}\n'])
def test_what_is_no_journal_is_refused(tmp_path, text):
    (tmp_path / JOURNAL).parent.mkdir()
    (tmp_path / JOURNAL).write_text(text)
    assert "its first line is of another" in refused(tmp_path)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"version": "2.0"}, "mxeon (1.0, now 2.0)"),
        ({"software": {"Python": "4"}}, "Python (3, now 4)"),
        ({"software": {"Python": "3", "C": "1"}}, "C (none, now 1)"),
        ({"options": {"--maxSize": "10"}}, "--maxSize (9, now 10)"),
        ({"files": FILES | {"clay.png": "02"}}, "clay.png"),
        ({"files": {"clay.mtlx": "00"}, "version": "2.0"}, "mxeon (1.0, now 2.0), clay.png"),
        ({"tasks": (replace(TASKS[0], host="webgl"),)}, "hosts (gl, now webgl)"),
        ({"tasks": TASKS[:1]}, "the checks"),
        (
            {"files": FILES | {f"{k}.png": "00" for k in range(20)}},
            "0.png, 1.png, 10.png and 17 more",
        ),
    ],
)
def test_another_run_is_not_resumed(tmp_path, change, words):
    kept(tmp_path)
    with pytest.raises(ValueError, match="holds another run") as error:
        journal(tmp_path, replace(PLAN, **change), resume=True).__enter__()
    assert str(error.value).endswith(f" another run ({words}); use a new folder, or omit --resume")


def test_a_run_that_was_never_begun_is_begun(tmp_path):
    with pytest.raises(ValueError, match=f"must hold the {JOURNAL} of a run; there is none"):
        read_run(tmp_path)
    with journal(tmp_path, resume=True) as begun:
        assert begun.findings == {}
    assert read_journal(tmp_path) == (PLAN, {})


def test_a_new_run_keeps_the_old_one_in_a_folder(tmp_path):
    path = kept(tmp_path, 0, 1, 2)
    (tmp_path / LOCK).unlink(missing_ok=True)
    (tmp_path / "junit.xml").write_text("old")
    before, files = path.read_bytes(), sorted(tmp_path.rglob("*"))
    journal(tmp_path)
    assert sorted(tmp_path.rglob("*")) == files  # creating the journal object changes no file
    with journal(tmp_path) as new:
        assert new.findings == {} and not (tmp_path / "junit.xml").exists()
    assert (tmp_path / PREVIOUS / JOURNAL).read_bytes() == before
    assert (tmp_path / PREVIOUS / "junit.xml").read_text() == "old"


def test_an_interrupted_run_is_continued_or_kept(tmp_path):
    path = kept(tmp_path, 0)
    before = path.read_bytes()
    words = "holds an interrupted run with 2 of 3 tasks left: --resume continues"
    with pytest.raises(ValueError, match=words):
        journal(tmp_path).__enter__()
    assert path.read_bytes() == before
    with journal(tmp_path, resume=True) as resumed:
        assert list(resumed.findings) == [0]


def test_one_folder_has_one_writer(tmp_path):
    with journal(tmp_path), pytest.raises(ValueError, match="must have one writer"):
        journal(tmp_path).__enter__()


def test_a_full_disk_loses_nothing_that_was_finished(tmp_path):
    with journal(tmp_path) as written:
        written.add(0, FINDINGS)
        size = (tmp_path / JOURNAL).stat().st_size
        with room_for(size + 100), pytest.raises(OSError, match="File too large"):
            written.add(1, replace(FINDINGS, pictures=()))
        assert (tmp_path / JOURNAL).stat().st_size == size
        written.add(1, FINDINGS)
    assert list(read_journal(tmp_path)[1]) == [0, 1]


KEPT = ("value", "reciprocity", "picture")
SHORT = f"""import builtins, sys
from mxeon.__main__ import main
from tests.support.plans import keep_checks
keep_checks(builtins, *{KEPT})
"""
# Code that makes a run wait for a signal after the findings of three tasks are stored.
WAITING = """import signal
from mxeon.conformance.run.journal import Journal
add = Journal.add
def add_three(journal, number, findings):
    add(journal, number, findings)
    if len(journal.findings) == 3:
        signal.pause()
Journal.add = add_three
"""


def test_a_killed_run_is_resumed_to_the_same_end(tmp_path, monkeypatch):
    keep_checks(monkeypatch, *KEPT)
    monkeypatch.chdir(Path(__file__).parents[2])
    options = ["check", PLASTER, "--report", str(tmp_path)]
    code = f"{SHORT}{WAITING}sys.exit(main())"
    process = subprocess.Popen([sys.executable, "-c", code, *options], stdout=subprocess.DEVNULL)
    path = tmp_path / JOURNAL
    wait_for(lambda: path.exists() and path.read_bytes().count(b"\n") > 3, process)
    process.kill()
    process.wait(DEADLINE)
    done = read_journal(tmp_path)[1].keys()
    assert read_run(tmp_path).missing
    command = [sys.executable, "-c", f"{SHORT}sys.exit(main())", *options, "--resume"]
    finished = subprocess.run(command, capture_output=True, text=True)
    assert finished.returncode == 0, finished.stderr
    lines = path.read_text().splitlines()[1:]
    assert len(lines) == len(set(lines)) and len(done) > 0
    assert read_run(tmp_path).results == check(PLASTER, libraries=["eonlib", "stock"]).results


def test_threads_read_pixels_at_once(tmp_path):
    """While CPython parses, garbage collection may start and let another thread run."""
    np.save(tmp_path / "pixels.npy", np.zeros((4, 4, 3), np.float32))
    image, thresholds = StoredImage(tmp_path / "pixels.npy"), gc.get_threshold()
    with ThreadPoolExecutor(1) as pool:

        def read_elsewhere(phase, info):
            if phase == "start" and threading.current_thread() is threading.main_thread():
                futures.wait([pool.submit(np.asarray, image)], 0.01)

        gc.callbacks.append(read_elsewhere)
        gc.set_threshold(1)
        try:
            shape = np.asarray(image).shape
        finally:
            gc.set_threshold(*thresholds)
            gc.callbacks.remove(read_elsewhere)
    assert shape == (4, 4, 3)
