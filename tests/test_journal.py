# SPDX-License-Identifier: Apache-2.0
"""The journal of a run: nothing finished is lost or done twice, whatever ended the run."""

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance import check, read_run, to_run
from mxeon.hosts import Identity
from mxeon.journal import NAME, PREVIOUS, Journal, read_journal
from mxeon.library import examples_folder
from mxeon.results import FAILED, Control, Curve, Findings, Item, Picture, Plan, Result

EXAMPLE = examples_folder() / "plaster.mtlx"
ITEMS = tuple(Item("value", name, "gl", "eonlib") for name in "abc")
PLAN = Plan("1.0", {"Python": "3"}, ITEMS, {"clay.mtlx": "00"})
PIXELS = np.linspace(0.0, 1.0, 12, dtype=np.float32).reshape(2, 2, 3)
FINDINGS = Findings(
    results=(
        Result(
            "value", "claim", "a", "gl", "eonlib", FAILED, figure=float("inf"), tolerance=1.0,
            worst={"wo": [0.0, 1.0]}, control=Control("wrong", 2.0, True),
        ),
    ),
    pictures=(Picture("d", "e", "gl", "eonlib", "side", PIXELS, None, {"version": "1"}),),
    curves=(Curve("a", "gl", "eonlib", (1.0, 0.5, 0.0), 0.5, np.arange(2.0), PIXELS[0], PIXELS[1]),),
    notes=(("text", "place"),),
    errors=("broken",),
    hosts=(Identity("gl", "4.5", "device"),),
)


def journal(folder, plan=PLAN, **options):
    return Journal(folder, plan, **options)


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


def test_a_torn_last_line_is_dropped_and_its_item_done_again(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
        kept.add(1, FINDINGS)
    path = tmp_path / NAME
    whole = path.read_bytes()
    path.write_bytes(whole[:-7])
    with journal(tmp_path, resume=True) as kept:
        assert list(kept.findings) == [0]
        kept.add(1, FINDINGS)
    assert path.read_bytes() == whole


def test_a_run_says_what_is_missing(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(1, Findings())
    run = to_run(*read_journal(tmp_path))
    assert run.missing == (str(ITEMS[0]), str(ITEMS[2]))


@pytest.mark.parametrize(
    "change, words",
    [
        ({"version": "2.0"}, "it is of mxeon 1.0, this is 2.0"),
        ({"software": {"Python": "4"}}, "it ran with {'Python': '3'}, this has {'Python': '4'}"),
        ({"documents": {"clay.mtlx": "01"}}, "these documents differ: clay.mtlx"),
        ({"items": ITEMS[:1]}, "its hosts, libraries or documents were others"),
    ],
)
def test_another_run_is_not_resumed(tmp_path, change, words):
    with journal(tmp_path):
        pass
    with pytest.raises(ValueError, match="--resume must go on with the same run; ") as error:
        journal(tmp_path, replace(PLAN, **change), resume=True)
    assert str(error.value).endswith(words)


@pytest.mark.parametrize("text", [None, '{"form'], ids=["none", "torn"])
def test_a_run_that_was_never_begun_is_begun(tmp_path, text):
    if text:
        (tmp_path / NAME).parent.mkdir()
        (tmp_path / NAME).write_text(text)
    with journal(tmp_path, resume=True) as kept:
        assert kept.findings == {}
    assert read_journal(tmp_path) == (PLAN, {})


def test_a_new_run_keeps_the_old_journal_beside(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
    before = (tmp_path / NAME).read_bytes()
    with journal(tmp_path) as kept:
        assert kept.findings == {}
    assert (tmp_path / PREVIOUS / Path(NAME).name).read_bytes() == before


def test_one_folder_has_one_writer(tmp_path):
    with journal(tmp_path), pytest.raises(ValueError, match="must have one writer"):
        journal(tmp_path)


@pytest.mark.parametrize("text", ["", "{}\n", "[]\n", '{"format": 0}\n', "\0\n"])
def test_what_is_no_journal_is_one_line(tmp_path, text):
    (tmp_path / NAME).parent.mkdir()
    (tmp_path / NAME).write_text(text)
    with pytest.raises(ValueError, match=f"{NAME}: must be a journal of mxeon 1; ") as error:
        read_journal(tmp_path)
    assert "\n" not in str(error.value)


def test_a_folder_without_a_journal_is_one_line(tmp_path):
    with pytest.raises(ValueError, match=f"must hold the {NAME} of a run; there is none"):
        read_run(tmp_path)


def test_a_full_disk_loses_nothing_that_was_finished(tmp_path):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
        before = (tmp_path / NAME).read_bytes()
        with room_for(len(before) + 100), pytest.raises(OSError, match="File too large"):
            kept.add(1, replace(FINDINGS, pictures=()))
        assert (tmp_path / NAME).read_bytes() == before
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


def test_a_killed_run_is_resumed_to_the_same_end(tmp_path):
    command = [sys.executable, "-m", "mxeon", "check", str(EXAMPLE), "--report", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    end = time.monotonic() + 300.0
    while not (tmp_path / NAME).exists() or (tmp_path / NAME).read_bytes().count(b"\n") < 4:
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    done = read_journal(tmp_path)[1].keys()
    assert read_run(tmp_path).missing
    finished = subprocess.run([*command, "--resume"], capture_output=True, text=True)
    assert finished.returncode == 0, finished.stderr
    lines = (tmp_path / NAME).read_text().splitlines()[1:]
    assert len(lines) == len(set(lines)) and len(done) > 0
    assert read_run(tmp_path).results == check([EXAMPLE]).results
