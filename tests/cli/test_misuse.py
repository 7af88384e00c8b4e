# SPDX-License-Identifier: Apache-2.0
"""After misuse or a failure, a command prints one line, exits as documented, and writes no file."""

import json

import pytest

from mxeon.cli import generate, library, main
from mxeon.cli.batch import BatchResult, WorkerCrashed
from mxeon.errors import FAILED, MISUSE, NOT_RUN, InputError, NotRun, ShaderError
from tests.support.command import CLAY, PLASTER, one_line
from tests.support.documents import material, textured, written


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
        (MemoryError(), NOT_RUN, "memory must suffice for the work; none is left"),
        (InputError("x" * 2000), MISUSE, "x" * 994 + " [...]"),
    ],
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


def test_two_documents_of_one_name_do_not_overwrite_each_other(tmp_path, capsys):
    files = [tmp_path / "a.mtlx", tmp_path / "b" / "a.mtlx"]
    files[1].parent.mkdir()
    for file, color in zip(files, ("0.1, 0.1, 0.1", "0.9, 0.9, 0.9"), strict=True):
        lobe = f'<input name="color" type="color3" value="{color}"/></eon_diffuse_bsdf>'
        file.write_text(material(f'<eon_diffuse_bsdf name="lobe" type="BSDF">{lobe}'))
    out = tmp_path / "out"
    arguments = ["generate", *map(str, files), "--target", "osl", "--outputPath", str(out)]
    assert main(arguments) == MISUSE
    assert "must not overwrite" in one_line(capsys.readouterr().err)
    assert "color(0.1" in (out / "a.look.osl").read_text()


def test_in_a_batch_the_other_files_are_done(tmp_path, capsys):
    bad = written(tmp_path, "<materialx")
    options = ["--target", "osl", "--outputPath", str(tmp_path), "--json"]
    status = main(["generate", str(bad), PLASTER, *options])
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    assert status == MISUSE and len(found["errors"]) == 1
    assert found["files"] and str(bad) in printed.err


def test_every_fault_of_a_document_has_its_line(tmp_path, capsys):
    path = written(tmp_path, textured(["no.png"]).replace('"color"', '"colr"'))
    lines = [
        f"{path}: input \"lobe/colr\" must be an input of oren_nayar_diffuse_bsdf; got 'colr': did "
        "you mean color?",
        f'{path}: input "i0/file" must name a file that exists; got no.png: pass its folder as '
        "--path FOLDER",
    ]
    for command in (
        f"generate {path} --target osl --outputPath {tmp_path} --json",
        f"render {path} --output {tmp_path}/a.png",
        f"explore {path} --output {tmp_path}/a.html",
        f"check {path}",
    ):
        assert main([*command.split(), "--workers", "0"]) == MISUSE
        printed = capsys.readouterr()
        assert printed.err.splitlines() == [f"mxeon: {line}" for line in lines]
        if "--json" in command:
            assert json.loads(printed.out)["errors"] == lines


def test_a_document_that_ends_its_process_did_not_run(tmp_path, monkeypatch, capsys):
    error = WorkerCrashed("a: worker process crashed (SIGSEGV)")
    results = (each for each in [BatchResult(None, error=error)])
    monkeypatch.setattr(generate, "run_batch", lambda *_: results)
    arguments = ["generate", CLAY, "--target", "osl", "--outputPath", str(tmp_path)]
    assert main(arguments) == NOT_RUN
    assert one_line(capsys.readouterr().err) == f"mxeon: {error}"
