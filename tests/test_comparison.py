# SPDX-License-Identifier: Apache-2.0
"""Two reports compared: what got worse is said first and by the exit status."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mxeon.cli import main
from mxeon.comparison import BETTER, OTHER, WORSE, Change, compare
from mxeon.hosts import Identity
from mxeon.report import to_json, write
from mxeon.results import FAILED, NOT_RUN, PASSED, Picture, Result, Run

PLACE = "gl, eonlib, value, clay"


def made_run(verdict=PASSED, figure=1e-7, device="llvmpipe", difference=1e-7, subject="clay"):
    pixels = np.zeros((4, 4, 3))
    picture = Picture("d", "e", "gl", "eonlib", "side", pixels + difference, pixels, {})
    result = Result("value", "claim", subject, "gl", "eonlib", verdict, figure, tolerance=1e-6)
    return Run("1.0", {"Python": "3"}, (Identity("gl", "4.5", device),), (result,), (picture,))


def changes(before, after):
    return compare(*(json.loads(to_json(run)) for run in (before, after)))


def test_equal_runs_do_not_differ():
    assert changes(made_run(), made_run(figure=1.5e-7)) == ()


@pytest.mark.parametrize(
    "after, expected",
    [
        ({"verdict": FAILED}, Change(WORSE, PLACE, "passed at 1e-07", "failed at 1e-07")),
        ({"verdict": NOT_RUN, "figure": None}, Change(WORSE, PLACE, "passed at 1e-07", "not run")),
        ({"figure": 3e-7}, Change(OTHER, PLACE, "passed at 1e-07", "passed at 3e-07")),
        ({"figure": float("nan")}, Change(OTHER, PLACE, "passed at 1e-07", "passed at NaN")),
        ({"device": "GPU"}, Change(OTHER, "host gl", "4.5, llvmpipe", "4.5, GPU")),
        (
            {"difference": 1e-3},
            Change(OTHER, "gl, eonlib, d, e, side, largest difference", "1e-07", "0.001"),
        ),
    ],
)
def test_each_kind_of_change_is_told(after, expected):
    assert changes(made_run(), made_run(**after)) == (expected,)


def test_what_got_better_is_no_worse():
    (change,) = changes(made_run(verdict=FAILED), made_run())
    assert change.kind == BETTER


def test_a_check_that_went_is_worse_and_one_that_came_is_not():
    found = changes(made_run(), made_run(subject="slate"))
    assert [change.kind for change in found] == [WORSE, OTHER]
    assert (found[0].after, found[1].before) == ("none", "none")


def test_records_of_one_name_are_told_apart():
    before, after = made_run(), made_run(FAILED)
    passed = replace(before, results=before.results * 2)
    (change,) = changes(passed, replace(before, results=before.results + after.results))
    assert change.kind == WORSE and change.place == f"{PLACE}, number 2"


@pytest.mark.parametrize("verdict, status", [(PASSED, 0), (FAILED, 1)])
def test_the_exit_status_says_whether_anything_got_worse(tmp_path, capsys, verdict, status):
    for name, run in (("a", made_run()), ("b", made_run(verdict))):
        write(run, tmp_path / name)
    assert main(["report", "diff", str(tmp_path / "a"), str(tmp_path / "b")]) == status
    printed = capsys.readouterr().out
    assert printed.startswith("no difference" if status == 0 else "worse: gl, eonlib, value, clay")


@pytest.mark.parametrize(
    "text, words",
    [
        ("[", "must be the results.json of a report"),
        ("{}", "must be the results.json of a report"),
        ('{"format": 1}', "must be the results.json of a report; it lacks "),
        ('{"format": 1, "results": 3, "pictures": []}', "must be the results.json of a report"),
        ('{"format": 0}', "format must be 1; got 0: make it anew"),
    ],
)
def test_what_is_no_report_is_one_line(tmp_path, capsys, text, words):
    (tmp_path / "results.json").write_text(text)
    assert main(["report", "diff", str(tmp_path), str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1
