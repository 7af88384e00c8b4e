# SPDX-License-Identifier: Apache-2.0
"""A damaged or forged journal: what it does not hold as it was written does not count."""

import hashlib
import json
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from mxeon.conformance.run import read_run
from mxeon.conformance.run.journal import read_journal
from mxeon.conformance.run.journal_lines import JOURNAL, to_line
from tests.support.journals import FINDINGS, PIXELS, PLAN, TASKS, journal


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
    (folder / JOURNAL).with_name(f"{stem}.npy").write_bytes(content)


def named(record, name):
    record["findings"]["pictures"][0]["image"] = name


def forge(folder, change):
    """A journal whose only line was changed, with a digest that is right."""
    with journal(folder) as kept:
        kept.add(1, FINDINGS)
    header, line = (folder / JOURNAL).read_bytes().splitlines(keepends=True)
    record = json.loads(line)
    del record["digest"]
    change(record)
    (folder / JOURNAL).write_bytes(header + to_line(record, json.loads(header)["digest"]))


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
    header, line, last = (tmp_path / JOURNAL).read_bytes().splitlines(keepends=True)
    assert before in line
    (tmp_path / JOURNAL).write_bytes(header + line.replace(before, after) + last)
    with pytest.warns(UserWarning, match="does it again: line 2$"):
        assert list(read_journal(tmp_path)[1]) == [2]


@pytest.mark.parametrize(
    "line", [b"", b"\0" * 9, b"[" * 100_000, b"1" * 5000, b"\xff", b'{"task": 0}']
)
def test_a_line_that_is_no_record_costs_no_other(tmp_path, line):
    with journal(tmp_path) as kept:
        kept.add(1, FINDINGS)
    with (tmp_path / JOURNAL).open("ab") as file:
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
    header, _ = (tmp_path / "a" / JOURNAL).read_bytes().splitlines(keepends=True)
    _, line = (tmp_path / "b" / JOURNAL).read_bytes().splitlines(keepends=True)
    (tmp_path / "a" / JOURNAL).write_bytes(header + line)
    with pytest.warns(UserWarning, match="line 2"):
        assert read_journal(tmp_path / "a")[1] == {}


def test_a_half_of_a_character_is_damage(tmp_path):
    findings = replace(FINDINGS, notes=(("half \ud83d", "place"),), pictures=())
    with journal(tmp_path) as written:
        written.add(0, findings)
    with pytest.warns(UserWarning, match="damaged in the journal.*: line 2"):
        assert not read_journal(tmp_path)[1]
