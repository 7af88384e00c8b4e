# SPDX-License-Identifier: Apache-2.0
"""Failures of the command that have no words of their own."""

import os
import subprocess
import sys
from pathlib import Path

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
        (OSError(), MISUSE, "file or standard output: must be accessible; OSError"),
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


def test_a_working_folder_that_may_not_be_entered_changes_nothing(tmp_path):
    folder, drop = tmp_path / "closed", "-dac_override,-dac_read_search"
    folder.mkdir()
    drops = ["setpriv", f"--bounding-set={drop}", f"--inh-caps={drop}"] if os.geteuid() == 0 else []
    ended = subprocess.run(
        [*drops, "sh", "-c", 'chmod 0 . && exec "$@"', "sh", sys.executable, "-P", "-m", "mxeon"]
        + ["generate", CLAY, "--target", "osl", "--workers", "1", "--outputPath", tmp_path / "out"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    folder.chmod(0o700)
    assert (ended.returncode, ended.stderr) == (PASSED, "") and ended.stdout


@pytest.mark.parametrize("arguments", (["check", "--host", "msl"], ["generate", "--target", "osl"]))
def test_a_name_that_the_terminal_cannot_encode_loses_nothing(tmp_path, arguments):
    file = tmp_path / "t\xf6ne.mtlx"
    file.write_bytes(Path(CLAY).read_bytes())
    more = ["--outputPath", tmp_path] if arguments[0] == "generate" else []
    ended = subprocess.run(
        [sys.executable, "-m", "mxeon", *arguments, file, "--workers", "0", *more],
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=False,
    )
    assert ended.returncode in (PASSED, NOT_RUN) and b"Traceback" not in ended.stderr
    assert b"t\\xf6ne" in ended.stdout


def test_a_deleted_working_folder_is_one_line(tmp_path, monkeypatch, capsys):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    options = ["--target", "osl", "--outputPath", str(tmp_path), "--workers", "1"]
    assert main(["generate", CLAY, *options]) == NOT_RUN
    assert one_line(capsys.readouterr().err).startswith("mxeon: working folder must exist, as ")


def test_too_little_memory_for_numpy_is_one_line():
    ended = subprocess.run(
        ["prlimit", "--as=200000000", sys.executable, "-m", "mxeon", "library"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == NOT_RUN
    assert one_line(ended.stderr).startswith(
        "mxeon: address space must be at least 268435456 bytes"
    )


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
