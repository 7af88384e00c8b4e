# SPDX-License-Identifier: Apache-2.0
"""The journal of a run: nothing finished is lost or done twice, whatever ended the run."""

import hashlib
import json
import os
import resource
import signal
import subprocess
import sys
import time
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from mxeon.conformance.results import FAILED, Control, Curve, Picture, Result
from mxeon.conformance.run import check, read_run, to_run
from mxeon.conformance.run.journal import LOCK, PREVIOUS, Journal, read_journal
from mxeon.conformance.run.journal_lines import NAME, to_line
from mxeon.conformance.run.plan import Findings, Plan, Task
from mxeon.shaders.hosts.base import Identity
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep_checks

EXAMPLE = examples_folder() / "plaster.mtlx"
TASKS = tuple(Task("value", name, "gl", "eonlib") for name in "abc")
OPTIONS, FILES = {"--maxSize": "9"}, {"clay.mtlx": "00", "clay.png": "01"}
PLAN = Plan("1.0", {"Python": "3"}, TASKS, ("clay.mtlx",), OPTIONS, FILES)
PIXELS = np.linspace(0.0, 1.0, 12, dtype=np.float32).reshape(2, 2, 3)
FINDINGS = Findings(
    results=(
        Result(
            "value",
            "claim",
            "a",
            "gl",
            "eonlib",
            FAILED,
            error=float("inf"),
            tolerance=1.0,
            worst={"wo": [0.0, 1.0]},
            control=Control("wrong", 2.0, True),
        ),
    ),
    pictures=(Picture("d", "e", "gl", "eonlib", "side", PIXELS, None, {"version": "1"}),),
    curves=(
        Curve("a", "gl", "eonlib", (1.0, 0.5, 0.0), 0.5, np.arange(2.0), PIXELS[0], PIXELS[1]),
    ),
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


def test_a_torn_last_line_is_dropped_and_its_task_done_again(tmp_path):
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
    before = (tmp_path / NAME).read_bytes()
    with journal(tmp_path) as kept:
        assert kept.findings == {}
    assert (tmp_path / PREVIOUS / Path(NAME).name).read_bytes() == before


def test_one_folder_has_one_writer(tmp_path):
    with journal(tmp_path), pytest.raises(ValueError, match="must have one writer"):
        journal(tmp_path).__enter__()


@pytest.mark.parametrize("text", ["", "{}\n", "[]\n", '{"format": 0}\n', "\0\n", '{"format": 3}\n'])
def test_what_is_no_journal_is_one_line(tmp_path, text):
    (tmp_path / NAME).parent.mkdir()
    (tmp_path / NAME).write_text(text)
    with pytest.raises(ValueError, match=f"{NAME}: must be a journal of format 3; ") as error:
        read_journal(tmp_path)
    assert "\n" not in str(error.value)


def test_a_folder_without_a_journal_is_one_line(tmp_path):
    with pytest.raises(ValueError, match=f"must hold the {NAME} of a run; there is none"):
        read_run(tmp_path)


def pixels(array):
    stream = BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def zipped():
    stream = BytesIO()
    np.savez(stream, PIXELS)
    return stream.getvalue()


HUGE = pixels(PIXELS).replace(b"(2, 2, 3), }           ", b"(100000, 1000000, 3), }")
DAMAGES = {
    "none": None, "empty": b"", "cut": pixels(PIXELS)[:-1], "other": pixels(1.0 - PIXELS),
    "zip": zipped(), "huge": HUGE,
}  # fmt: skip


@pytest.mark.parametrize("content", DAMAGES.values(), ids=DAMAGES)
def test_a_task_whose_picture_is_damaged_is_done_again(tmp_path, content):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
        kept.add(1, replace(FINDINGS, pictures=()))
    (picture,) = tmp_path.glob("journal/*.npy")
    picture.unlink()
    if content is not None:
        picture.write_bytes(content)
    with pytest.warns(UserWarning, match="does it again: pictures of gl, value, a, eonlib$"):
        assert list(read_journal(tmp_path)[1]) == [1]
    with pytest.warns(UserWarning, match="pictures of"), journal(tmp_path, resume=True) as kept:
        assert list(kept.findings) == [1]
        kept.add(0, FINDINGS)
    assert np.array_equal(read_journal(tmp_path)[1][0].pictures[0].image, PIXELS)


@pytest.mark.parametrize(
    "content", [pixels(np.zeros((2, 2, 3))), pixels(np.zeros(3, np.float32)), HUGE, zipped(), b""]
)
def test_what_is_called_by_its_digest_and_is_no_picture_does_not_count(tmp_path, content):
    forge_picture(tmp_path, hashlib.sha256(content).hexdigest(), content)
    with pytest.warns(UserWarning, match="pictures of gl, value, b, eonlib"):
        assert read_journal(tmp_path)[1] == {}


def forge_picture(folder, stem, content):
    """A journal whose only line is right, and names a picture of these bytes."""
    forge(folder, lambda record: named(record, f"{stem}.npy"))
    (folder / NAME).with_name(f"{stem}.npy").write_bytes(content)


def named(record, name):
    record["findings"]["pictures"][0]["image"] = name


def forge(folder, change):
    """A journal whose only line was changed, with a digest that is right."""
    with journal(folder) as kept:
        kept.add(1, FINDINGS)
    header, line = (folder / NAME).read_bytes().splitlines(keepends=True)
    record = json.loads(line)
    del record["digest"]
    change(record)
    (folder / NAME).write_bytes(header + to_line(record, json.loads(header)["digest"]))


def changed(**values):
    return lambda record: record.update(values)


def changed_result(**values):
    return lambda record: record["findings"]["results"][0].update(values)


FORGED = [
    *(changed(task=task) for task in ("x", None, -1, 1_000_000_000, 1.5, True, [], {})),
    *(changed(findings=findings) for findings in ({}, None, [], {"results": 3}, {"more": 1})),
    *(changed_result(verdict=verdict) for verdict in ("maybe", None, 1, [])),
    *(changed_result(worst=worst) for worst in ({"a": None}, {"a": "b"}, {"a": [None]}, 5, "x")),
    *(changed_result(tolerance=tolerance) for tolerance in (None, -1.0)),
    *(changed_result(figure=figure) for figure in (-1.0, "x", 10**400, [], True)),
    *(changed_result(**{name: "x"}) for name in ("host", "library", "control", "distances")),
    *(changed_result(reason=reason) for reason in (None, 1)),
    *(lambda record, name=name: named(record, name) for name in (None, 1, "", "../a.npy", "\0")),
]


@pytest.mark.parametrize("change", FORGED)
def test_a_line_that_mxeon_does_not_write_does_not_count(tmp_path, change):
    forge(tmp_path, change)
    with pytest.warns(UserWarning, match="damaged in the journal"):
        run = read_run(tmp_path)
    assert run.results == () and len(run.missing) == len(TASKS)


@pytest.mark.parametrize(
    "before, after", [(b"failed", b"passed"), (b'"task": 1', b'"task": 0'), (b"0.5", b"0.25")]
)
def test_an_edited_line_does_not_count(tmp_path, before, after):
    with journal(tmp_path) as kept:
        kept.add(1, FINDINGS)
        kept.add(2, FINDINGS)
    header, line, last = (tmp_path / NAME).read_bytes().splitlines(keepends=True)
    assert before in line
    (tmp_path / NAME).write_bytes(header + line.replace(before, after) + last)
    with pytest.warns(UserWarning, match="does it again: line 2$"):
        assert list(read_journal(tmp_path)[1]) == [2]


@pytest.mark.parametrize(
    "line", [b"", b"\0" * 9, b"[" * 100_000, b"1" * 5000, b"\xff", b'{"task": 0}']
)
def test_a_line_that_is_no_record_costs_no_other(tmp_path, line):
    with journal(tmp_path) as kept:
        kept.add(1, FINDINGS)
    with (tmp_path / NAME).open("ab") as file:
        file.write(line + b"\n")
    with pytest.warns(UserWarning, match="does it again: line 3$"):
        assert list(read_journal(tmp_path)[1]) == [1]
    with pytest.warns(UserWarning, match="line 3"), journal(tmp_path, resume=True):
        pass
    assert list(read_journal(tmp_path)[1]) == [1]  # without a warning


def test_findings_of_another_run_do_not_count(tmp_path):
    for name, version in (("a", "1.0"), ("b", "2.0")):
        with journal(tmp_path / name, replace(PLAN, version=version)) as kept:
            kept.add(1, FINDINGS)
    header, _ = (tmp_path / "a" / NAME).read_bytes().splitlines(keepends=True)
    _, line = (tmp_path / "b" / NAME).read_bytes().splitlines(keepends=True)
    (tmp_path / "a" / NAME).write_bytes(header + line)
    with pytest.warns(UserWarning, match="line 2"):
        assert read_journal(tmp_path / "a")[1] == {}


@pytest.mark.parametrize("name", [NAME, "journal/*.npy"])
def test_a_pipe_in_place_of_a_file_of_the_journal_blocks_nobody(tmp_path, name):
    with journal(tmp_path) as kept:
        kept.add(0, FINDINGS)
    (path,) = tmp_path.glob(name)
    path.unlink()
    os.mkfifo(path)
    if name == NAME:
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
sys.exit(main())"""


def test_a_killed_run_is_resumed_to_the_same_end(tmp_path, monkeypatch):
    keep_checks(monkeypatch, *KEPT)
    monkeypatch.chdir(Path(__file__).parents[2])
    command = [sys.executable, "-c", SHORT, "check", str(EXAMPLE), "--report", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    wait_for_lines(tmp_path / NAME, 4, process)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    done = read_journal(tmp_path)[1].keys()
    assert read_run(tmp_path).missing
    finished = subprocess.run([*command, "--resume"], capture_output=True, text=True)
    assert finished.returncode == 0, finished.stderr
    lines = (tmp_path / NAME).read_text().splitlines()[1:]
    assert len(lines) == len(set(lines)) and len(done) > 0
    assert read_run(tmp_path).results == check([EXAMPLE]).results
