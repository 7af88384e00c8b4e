# SPDX-License-Identifier: Apache-2.0
"""Failures of the command that have no words of their own."""

import os
import subprocess
import sys

import pytest

from mxeon.cli import library, main
from mxeon.errors import FAILED, MISUSE, NOT_RUN, PASSED, InputError, NotRun, ShaderError
from tests.support.command import CLAY, PLASTER, one_line


def failing(monkeypatch, error):
    def fail(_):
        raise error

    monkeypatch.setattr(library, "run", fail)
    return main(["library"])


@pytest.mark.parametrize(
    "error, status, words",
    [
        (InputError(), MISUSE, "InputError"),
        (OSError(), MISUSE, "file: must be accessible; OSError"),
        (FileExistsError(17, "File exists", "out"), MISUSE, "out: must be a folder; File exists"),
        (NotRun("gl: none"), NOT_RUN, "gl: none"),
        (ShaderError("gl: no shader"), FAILED, "gl: no shader"),
        (MemoryError(), NOT_RUN, "memory must suffice for the work; there is no more"),
        (InputError("x" * 2000), MISUSE, "x" * 994 + " [...]"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_every_failure_says_what_is_wrong(monkeypatch, capsys, error, status, words):
    assert failing(monkeypatch, error) == status
    assert capsys.readouterr().err == f"mxeon: {words}\n"


@pytest.mark.parametrize(
    "error", [TypeError("no number"), RuntimeError("of a library"), ValueError("of NumPy")]
)
def test_a_bug_shows_its_traceback_and_is_no_failed_check(monkeypatch, capsys, error):
    assert failing(monkeypatch, error) == NOT_RUN
    printed = capsys.readouterr().err
    assert printed.startswith("Traceback") and printed.endswith(f"{error}\n")


def test_a_deleted_working_folder_is_one_line(tmp_path, monkeypatch, capsys):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    options = ["--target", "osl", "--outputPath", str(tmp_path), "--workers", "1"]
    assert main(["generate", CLAY, *options]) == NOT_RUN
    assert one_line(capsys.readouterr().err).startswith("mxeon: working folder must exist, as ")


@pytest.mark.parametrize("count", [6, 8, 10, 12])
def test_too_few_open_files_are_one_line(tmp_path, count):
    command = [sys.executable, "-m", "mxeon", "generate", CLAY, "--target", "osl"]
    ended = subprocess.run(
        ["prlimit", f"--nofile={count}", *command, "--outputPath", tmp_path, "--workers", "1"],
        env=os.environ | {"TMPDIR": str(tmp_path)},  # a folder cannot be removed without a file
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode != PASSED:  # how many are needed is Python's business
        assert ended.returncode in (MISUSE, NOT_RUN)
        assert ended.stderr.count("\n") == 1 and "Too many open files" in ended.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["generate", "\udcff.mtlx", "--target", "osl", "--outputPath", "."],
        ["render", CLAY, "--output", "\udcff.png"],
        ["check", CLAY, "--report", "\udcff"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_file_name_that_is_no_text_is_one_line(arguments, capsys):
    assert main(arguments) == MISUSE
    rule = "mxeon: arguments must be UTF-8, file names too; got "
    assert one_line(capsys.readouterr().err).startswith(rule)


def test_a_limit_beyond_all_memory_is_no_limit(tmp_path):
    options = ["--target", "osl", "--outputPath", str(tmp_path), "--maxSize", "9" * 24]
    assert main(["generate", PLASTER, *options]) == PASSED


def test_without_docstrings_the_command_is_the_same():
    command = [sys.executable, "-OO", "-m", "mxeon", "--help"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (
        ended.returncode == PASSED and "specification of physically based shading" in ended.stdout
    )


@pytest.mark.parametrize("buffered", ["", "1"], ids=["buffered", "unbuffered"])
@pytest.mark.parametrize(
    "command, status",
    [
        ("report diff x y 2>/dev/full", MISUSE),
        ("frobnicate 2>/dev/full", MISUSE),
        ("library >/dev/full", MISUSE),
        ("--help >/dev/full", (PASSED, MISUSE)),  # argparse tells of no failed write
    ],
)
def test_a_stream_that_takes_nothing_changes_no_status(command, status, buffered):
    ended = subprocess.run(
        f'"{sys.executable}" -m mxeon {command}',
        shell=True,
        env=os.environ | {"PYTHONUNBUFFERED": buffered},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode in (status if isinstance(status, tuple) else (status,))
    assert "Traceback" not in ended.stderr and "Exception ignored" not in ended.stderr
