# SPDX-License-Identifier: Apache-2.0
"""The command: what it prints, what it leaves behind, and the status it ends with."""

import json
import os
import re
import resource
import shutil
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.cli import generate, library, main, parser
from mxeon.cli.batch import BatchResult, WorkerCrashed
from mxeon.errors import FAILED, MISUSE, NOT_RUN, PASSED, InputError, NotRun, ShaderError
from mxeon.jobs.timeouts import TIMEOUT
from mxeon.models.inversion import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal
from mxeon.shaders.generation import TARGETS
from mxeon.shaders.hosts import host_names
from mxeon.shaders.library import eonlib_folder, examples_folder
from mxeon.shaders.scene import SCENES
from tests.support.documents import material
from tests.support.plans import keep_checks

CLAY = str(examples_folder() / "clay.mtlx")
PLASTER = str(examples_folder() / "plaster.mtlx")


def run(*arguments, **environment):
    command = [sys.executable, "-m", "mxeon", *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **environment}, check=False
    )


def one_line(text):
    lines = [line for line in text.splitlines() if line.startswith("mxeon")]
    return lines[0] if len(lines) == 1 and "Traceback" not in text else ""


# --- status -------------------------------------------------------------------------------------


def test_check_passes_and_writes_a_report(tmp_path, capsys, monkeypatch):
    keep_checks(monkeypatch, "value", "curve", "picture")
    assert main(["check", PLASTER, "--report", str(tmp_path / "report")]) == PASSED
    printed = capsys.readouterr().out
    assert "checks passed" in printed and "report.html" in printed
    names = {path.name for path in (tmp_path / "report").iterdir()}
    assert names == {
        "report.html",
        "results.json",
        "junit.xml",
        "pictures",
        "journal",
        ".journal.lock",
    }


def test_check_of_stock_fails_and_names_the_defects(capsys, monkeypatch):
    keep_checks(monkeypatch, "value")
    assert main(["check", PLASTER, "--library", "stock"]) == FAILED
    assert "EON with clamped dot(wo, wi)" in capsys.readouterr().out


def test_check_takes_a_folder_as_library_and_prints_json_for_machines(capsys, monkeypatch):
    keep_checks(monkeypatch, "definition", "value")
    folder = str(eonlib_folder())
    assert main(["check", PLASTER, "--library", folder, "--json"]) == PASSED
    results = json.loads(capsys.readouterr().out)["results"]
    assert folder in {each["library"] for each in results}


def test_check_on_a_host_that_is_missing_did_not_run(monkeypatch, capsys):
    monkeypatch.setenv("MXEON_CYCLES_PYTHON", "/nowhere/python")
    assert main(["check", PLASTER, "--host", "cycles"]) == NOT_RUN
    assert "not run: cycles" in capsys.readouterr().out


def test_render_on_a_host_that_is_missing_did_not_run(monkeypatch, capsys, tmp_path):
    monkeypatch.setenv("MXEON_CYCLES_PYTHON", "/nowhere/python")
    output = tmp_path / "out.exr"
    assert main(["render", PLASTER, "--host", "cycles", "--output", str(output)]) == NOT_RUN
    assert "MXEON_CYCLES_PYTHON" in capsys.readouterr().err and not output.exists()


# --- misuse -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["generate", "nowhere.mtlx", "--target", "glsl"], "must be a readable file"),
        (["generate", CLAY, "--target", "hlsl"], "target must be one of glsl"),
        (["generate", CLAY, "--target", "glsl", "--element", "loam"], "element must be one of"),
        (["generate", CLAY, "--target", "glsl", "--library", "mine"], "library must be one of"),
        (["generate", CLAY, "--target", "osl", "--profile", "arnold"], "profile must be one of"),
        (["generate", CLAY], "required: --target"),
    ],
    ids=["file", "target", "element", "library", "profile", "no target"],
)
def test_generate_refuses_in_one_line_and_writes_nothing(arguments, words, tmp_path):
    ended = run(*arguments, "--outputPath", tmp_path / "out")
    assert ended.returncode == MISUSE and words in one_line(ended.stderr)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["check", PLASTER, "--host", "abacus"], "host must be one of gl"),
        (["check", PLASTER, "--library", "mine"], "library must be one of eonlib, diffuse, stock"),
        (["check", "nowhere.mtlx", "--host", "msl"], "must be a readable file"),
        (["render", CLAY, "--output", "out.exr"], "--element must name one of"),
        (["render", PLASTER, "--output", "out.gif"], "output must end in .exr or .png"),
        (["render", PLASTER, "--output", "out.exr", "--scene", "dusk"], "scene must be one of"),
        (["render", PLASTER, "--output", "out.exr", "--environment", "sky.hdr"], "sky.hdr"),
        (["render", PLASTER, "--output", "out.exr", "--size", "0"], "size must lie in [1, 8192]"),
        (["render", PLASTER, "--output", "out.exr", "--samples", "0"], "samples must lie in [1, "),
        (["render", PLASTER, "--output", "out.exr", "--bounces", "-1"], "bounces must lie in [1, "),
        (
            ["render", PLASTER, "--output", "out.exr", "--samples", "4"],
            "gl: this host takes no number",
        ),
        (["invert", "0.5", "0.5", "--roughness", "1"], "required: B"),
        (["invert", "1.2", "0", "0", "--roughness", "1"], "color must lie in [0, 1]"),
        (["invert", "1", "0", "0", "--roughness", "nan"], "roughness must lie in [0, 1]"),
        (["generate", CLAY, "--target", "osl", "--outputPath", "\0"], "no null character"),
        (["frobnicate"], "invalid choice"),
        ([], "required"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_misuse_is_one_line(arguments, words, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    try:
        status = main(arguments)
    except SystemExit as ended:
        status = ended.code
    assert status == MISUSE and words in one_line(capfd.readouterr().err)
    assert not list(tmp_path.iterdir())


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


def test_a_file_that_is_no_image_is_one_line(tmp_path):
    (tmp_path / "sky.exr").write_text("no image")
    output = tmp_path / "out.exr"
    ended = run("render", PLASTER, "--environment", tmp_path / "sky.exr", "--output", output)
    assert ended.returncode == MISUSE and not output.exists()
    assert "must be an image that OpenImageIO reads" in one_line(ended.stderr)


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    folder = tmp_path / "file" / "out"
    ended = run("generate", PLASTER, "--target", "osl", "--outputPath", folder)
    assert ended.returncode == MISUSE and "must be accessible" in one_line(ended.stderr)


def test_a_closed_output_is_no_obstacle(tmp_path):
    command = f'exec "{sys.executable}" -m mxeon generate "{PLASTER}" --target osl --outputPath out'
    for closed in (">&-", "<&- >&- 2>&-"):
        ended = subprocess.run(["sh", "-c", f"{command} {closed}"], cwd=tmp_path, check=False)
        assert ended.returncode == PASSED and list((tmp_path / "out").glob("*.osl"))
        shutil.rmtree(tmp_path / "out")


def test_in_a_batch_the_other_files_are_done(tmp_path, capsys):
    bad = tmp_path / "bad.mtlx"
    bad.write_text("<materialx")
    status = main(
        ["generate", str(bad), PLASTER, "--target", "osl", "--outputPath", str(tmp_path), "--json"]
    )
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    assert status == MISUSE and len(found["errors"]) == 1
    assert found["files"] and str(bad) in printed.err


def test_a_document_that_ends_its_process_did_not_run(tmp_path, monkeypatch, capsys):
    error = WorkerCrashed("a: worker process crashed (SIGSEGV)")
    monkeypatch.setattr(generate, "run_batch", lambda *_: iter([BatchResult(None, error=error)]))
    arguments = ["generate", CLAY, "--target", "osl", "--outputPath", str(tmp_path)]
    assert main(arguments) == NOT_RUN
    assert one_line(capsys.readouterr().err) == f"mxeon: {error}"


# --- failures that have no words of their own ---------------------------------------------------


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
        [*command, "--outputPath", str(tmp_path), "--workers", "1"],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (count, count)),
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


# --- what the commands do -----------------------------------------------------------------------


def test_generate_writes_a_file_for_each_stage_and_material(tmp_path, capsys):
    targets = ["--target", "glsl", "--target", "osl"]
    assert main(["generate", CLAY, *targets, "--outputPath", str(tmp_path)]) == PASSED
    names = {path.name for path in tmp_path.iterdir()}
    assert {
        "clay.terracotta.glsl.frag",
        "clay.terracotta.glsl.vert",
        "clay.terracotta.osl",
    } <= names
    assert set(capsys.readouterr().out.split()) == {str(tmp_path / name) for name in names}


def test_generate_for_cycles_warns_of_what_it_approximates(tmp_path):
    document = tmp_path / "qon.mtlx"
    document.write_text(material('<oren_nayar_diffuse_bsdf name="lobe" type="BSDF"/>'))
    options = ["--target", "osl", "--profile", "cycles", "--outputPath", tmp_path]
    ended = run("generate", document, *options)
    assert ended.returncode == PASSED
    assert "look: Cycles has no closure for qualitative Oren-Nayar" in one_line(ended.stderr)


@pytest.mark.parametrize("host", ["gl", "reference"])
def test_render_writes_a_linear_exr_that_says_what_made_it(host, tmp_path):
    output = str(tmp_path / "plaster.exr")
    options = ["--element", "ochre_plaster", "--size", "64", "--scene", "front"]
    assert main(["render", PLASTER, "--host", host, "--output", output, *options]) == PASSED
    image = oiio.ImageBuf(output)
    assert image.spec().get_string_attribute("mxeon:element") == "ochre_plaster"
    pixels = image.get_pixels(oiio.FLOAT)
    assert pixels.shape == (64, 64, 3) and pixels.max() > 0.1 and not pixels[0, 0].any()


def test_library_prints_the_folder_and_what_each_target_finds(capsys):
    assert main(["library", "--folder"]) == PASSED
    assert capsys.readouterr().out.strip() == str(eonlib_folder())
    assert main(["library", "--verify"]) == PASSED
    assert "IM_oren_nayar_diffuse_bsdf_genosl" in capsys.readouterr().out


@pytest.mark.parametrize(
    "option, function",
    [([], eon_rho_from_albedo_normal), (["--average"], eon_rho_from_albedo_avg)],
)
def test_invert_prints_rho(option, function, capsys):
    assert main(["invert", "0.8", "0.4", "0.1", "--roughness", "0.7", *option]) == PASSED
    printed = np.array(capsys.readouterr().out.split(), dtype=float)
    assert np.abs(printed - function([0.8, 0.4, 0.1], 0.7)).max() <= 5e-10  # nine digits printed


def test_a_reader_who_has_enough_is_no_error():
    command = f"{sys.executable} -m mxeon library --verify | head -1"
    ended = subprocess.run(command, shell=True, capture_output=True, text=True, check=True)
    assert ended.stderr == ""


def test_help_names_every_choice(capsys):
    for command, choices in {
        "check": host_names(),
        "generate": TARGETS,
        "render": [scene.name for scene in SCENES],
    }.items():
        with pytest.raises(SystemExit):
            parser().parse_args([command, "--help"])
        words = set(re.findall(r"[\w-]+", capsys.readouterr().out))
        assert set(choices) <= words


def test_a_limit_is_a_timeout():
    old, new = (parser().parse_args(["check", f"--{name}", "7"]) for name in ("limit", "timeout"))
    assert old.timeout == new.timeout == 7.0 and parser().parse_args(["check"]).timeout == TIMEOUT


def test_help_loads_no_shader_generator():
    code = "import sys, mxeon.cli; mxeon.cli.parser(); sys.exit('MaterialX' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_reader_who_has_had_enough_is_no_success():
    code = """import sys
from mxeon import cli
def show(options):
    raise BrokenPipeError
cli.library.run = show
sys.exit(cli.main(["library"]))"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (141, "")
