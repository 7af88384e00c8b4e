# SPDX-License-Identifier: Apache-2.0
"""The journal of a run: nothing finished is lost or done twice, whatever ended the run."""

import errno
import os
import resource
import signal
import subprocess
import sys
import time
from dataclasses import replace
from multiprocessing import active_children
from pathlib import Path

import numpy as np
import pytest

from mxeon.conformance.run import check, read_run, to_run
from mxeon.conformance.run.journal import LOCK, PREVIOUS, Journal, read_journal
from mxeon.conformance.run.journal_lines import JOURNAL
from mxeon.shaders.library import examples_folder
from tests.support.journals import FILES, FINDINGS, PIXELS, PLAN, TASKS, journal
from tests.support.plans import keep_checks

EXAMPLE = examples_folder() / "plaster.mtlx"


def test_findings_come_back_as_they_were(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(1, FINDINGS)
    plan, found = read_journal(tmp_path)
    assert plan == PLAN and list(found) == [1]
    (picture,), (curve,) = found[1].pictures, found[1].curves
    assert np.array_equal(picture.image, PIXELS) and picture.reference is None
    assert np.array_equal(curve.measured, PIXELS[0]) and curve.rho == (1.0, 0.5, 0.0)
    plain = {"pictures": (), "curves": ()}
    assert replace(found[1], **plain) == replace(FINDINGS, **plain)


def test_a_torn_last_line_is_dropped_and_its_task_done_again(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
        kept.add(1, FINDINGS)
    path = tmp_path / JOURNAL
    whole = path.read_bytes()
    path.write_bytes(whole[:-7])
    with journal(tmp_path, resume=True) as kept:
        assert list(kept.findings) == [0]
        kept.add(1, FINDINGS)
    assert path.read_bytes() == whole


def test_processes_end_with_a_run_that_cannot_be_kept(tmp_path, monkeypatch):
    keep_checks(monkeypatch, "value")
    monkeypatch.setattr(Journal, "add", lambda *_: Path("/dev/full").write_text("."))
    before = set(active_children())
    with pytest.raises(OSError) as error:
        check([EXAMPLE], ["gl"], workers=1, folder=tmp_path, nodes=["common"])
    assert set(active_children()) <= before  # while the error still holds what was under way
    assert error.value.errno == errno.ENOSPC


def test_a_run_says_what_is_missing(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(1, FINDINGS)
    run = to_run(*read_journal(tmp_path))
    assert run.missing == (str(TASKS[0]), str(TASKS[2]))


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
    ],
)
def test_another_run_is_not_resumed(tmp_path, change, words):
    with journal(tmp_path):
        pass
    with pytest.raises(ValueError, match="--resume must go on with the same run; ") as error:
        journal(tmp_path, replace(PLAN, **change), resume=True).__enter__()
    assert str(error.value).endswith(f"; these differ: {words}")


def test_a_long_list_of_differences_is_cut(tmp_path):
    with journal(tmp_path):
        pass
    files = {f"{number}.png": "00" for number in range(20)} | FILES
    with pytest.raises(ValueError, match=r"0.png, 1.png, .* and 12 more$"):
        journal(tmp_path, replace(PLAN, files=files), resume=True).__enter__()


def test_a_run_that_was_never_begun_is_begun(tmp_path):
    with journal(tmp_path, resume=True) as kept:
        assert kept.findings == {}
    assert read_journal(tmp_path) == (PLAN, {})


def test_nothing_is_touched_before_a_journal_is_entered(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
    (tmp_path / LOCK).unlink(missing_ok=True)
    before = sorted(tmp_path.rglob("*"))
    journal(tmp_path)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_new_run_keeps_the_old_journal_beside(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
    before = (tmp_path / JOURNAL).read_bytes()
    with journal(tmp_path) as kept:
        assert kept.findings == {}
    assert (tmp_path / PREVIOUS / Path(JOURNAL).name).read_bytes() == before


def test_one_folder_has_one_writer(tmp_path):
    with journal(tmp_path), pytest.raises(ValueError, match="must have one writer"):
        journal(tmp_path).__enter__()


@pytest.mark.parametrize("text", ["", "{}\n", "[]\n", '{"format": 0}\n', "\0\n", '{"format": 4}\n'])
def test_what_is_no_journal_is_one_line(tmp_path, text):
    (tmp_path / JOURNAL).parent.mkdir()
    (tmp_path / JOURNAL).write_text(text)
    with pytest.raises(ValueError, match=f"{JOURNAL}: must be a journal of format 4; ") as error:
        read_journal(tmp_path)
    assert "\n" not in str(error.value)


def test_a_folder_without_a_journal_is_one_line(tmp_path):
    with pytest.raises(ValueError, match=f"must hold the {JOURNAL} of a run; there is none"):
        read_run(tmp_path)


@pytest.mark.parametrize("name", [JOURNAL, "journal/*.npy"])
def test_a_pipe_in_place_of_a_file_of_the_journal_blocks_nobody(tmp_path, name):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
    (path,) = tmp_path.glob(name)
    path.unlink()
    os.mkfifo(path)
    if name == JOURNAL:
        with pytest.raises(OSError, match="not a regular file"):
            read_journal(tmp_path)
    else:
        with pytest.warns(UserWarning, match="pictures of"):
            assert read_journal(tmp_path)[1] == {}


def test_pictures_are_on_disk_before_the_line_that_names_them(tmp_path, monkeypatch):
    synced, fsync = [], os.fsync
    monkeypatch.setattr(
        os, "fsync", lambda file: synced.append(os.readlink(f"/proc/self/fd/{file}")) or fsync(file)
    )
    with journal(tmp_path) as kept:
        synced.clear()
        kept.add(0, FINDINGS)
    suffixes = [Path(path).suffix for path in synced]
    assert suffixes == [".npy", "", ".jsonl"]  # the picture, its name, the line


def test_a_full_disk_loses_nothing_that_was_finished(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
        before = (tmp_path / JOURNAL).read_bytes()
        with room_for(len(before) + 100), pytest.raises(OSError, match="File too large"):
            kept.add(1, replace(FINDINGS, pictures=()))
        assert (tmp_path / JOURNAL).read_bytes() == before
        kept.add(1, FINDINGS)
    assert list(read_journal(tmp_path)[1]) == [0, 1]


class room_for:
    """No file may grow beyond so many bytes: what a full disk does, without one."""

    def __init__(self, size):
        self._size = size

    def __enter__(self):
        self._limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self._handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (self._size, self._limits[1]))

    def __exit__(self, *error):
        resource.setrlimit(resource.RLIMIT_FSIZE, self._limits)
        signal.signal(signal.SIGXFSZ, self._handler)


def wait_for_lines(path, count, process):
    end = time.monotonic() + 300.0
    while not path.exists() or path.read_bytes().count(b"\n") < count:
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)


KEPT = ("value", "reciprocity", "curve", "picture")
SHORT = f"""import builtins, sys
from mxeon.__main__ import main
from tests.support.plans import keep_checks
keep_checks(builtins, *{KEPT})
"""
RUN = f"{SHORT}sys.exit(main())"
# The same, which waits to be killed when the findings of three tasks are kept.
WAITING = f"""{SHORT}import time
from mxeon.conformance.run.journal import Journal
add = Journal.add
def add_three(journal, number, findings):
    add(journal, number, findings)
    if len(journal.findings) == 3:
        time.sleep(300.0)
Journal.add = add_three
sys.exit(main())"""


def test_a_killed_run_is_resumed_to_the_same_end(tmp_path, monkeypatch):
    keep_checks(monkeypatch, *KEPT)
    monkeypatch.chdir(Path(__file__).parents[2])
    options = ["check", str(EXAMPLE), "--report", str(tmp_path)]
    process = subprocess.Popen([sys.executable, "-c", WAITING, *options], stdout=subprocess.DEVNULL)
    wait_for_lines(tmp_path / JOURNAL, 4, process)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    done = read_journal(tmp_path)[1].keys()
    assert read_run(tmp_path).missing
    command = [sys.executable, "-c", RUN, *options, "--resume"]
    finished = subprocess.run(command, capture_output=True, text=True)
    assert finished.returncode == 0, finished.stderr
    lines = (tmp_path / JOURNAL).read_text().splitlines()[1:]
    assert len(lines) == len(set(lines)) and len(done) > 0
    assert read_run(tmp_path).results == check([EXAMPLE], libraries=["eonlib", "stock"]).results
