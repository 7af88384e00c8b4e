# SPDX-License-Identifier: Apache-2.0
"""The commands of mxeon print the documented output, write their files, and set the exit status."""

import json
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon import check
from mxeon.cli import main, parser
from mxeon.errors import FAILED, PASSED
from mxeon.models.diffuse import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal
from mxeon.report import write
from mxeon.shaders.document.policy import LIMITS
from mxeon.shaders.library import eonlib_folder
from tests.support.command import CLAY, PLASTER, one_line
from tests.support.documents import lobe, material
from tests.support.plans import keep, keep_checks

MIRROR = material(lobe("generalized_schlick_bsdf", roughness=(0.0, 0.0)))

# --- exit status --------------------------------------------------------------------------------


def pattern(line):
    """Regular expression for a printed line, in which files, errors and numbers may vary."""
    rest = r"\.\.\.|(?<=load )\w+|(?<=: )docs|(?<=EON, )[\d.e-]+|(?= To fix)|\s{2,}|\d+(?= checks| of )|(?<= of )\d+"
    return ".*".join(map(re.escape, re.split(rest, line)))


def test_check_passes_writes_a_report_and_answers_as_the_pages_show(tmp_path, capsys):
    options = ["--report", str(tmp_path / "report"), "--workers", "0"]
    assert main(["check", PLASTER, *options]) == PASSED
    text = capsys.readouterr().out
    printed = [" ".join(each.split()) for each in re.split(r"\n(?!  )", text.strip())]
    for page in ("README.md", "docs/commands.md"):
        text = (Path(__file__).parents[2] / page).read_text(encoding="utf-8")
        [shown] = re.findall(r"^(ochre_plaster: .*?)^(?:```|\.{3})", text, re.DOTALL | re.MULTILINE)
        assert re.match(pattern(" ".join(shown.split())), " ".join(printed)), page
    assert printed[-1].endswith("report.html")
    assert re.search(r"Finished in \d+\.\d s\.$", printed[-3])
    files = {"report.html", "results.json", "junit.xml", ".journal.lock"}
    names = {path.name for path in (tmp_path / "report").iterdir()}
    assert names == files | {"pictures", "journal", "upstream"}
    # Stock MaterialX fails, but only the results with eonlib decide the verdict.
    found = json.loads((tmp_path / "report" / "results.json").read_text())
    assert (found["verdict"], found["compared"]) == ("passed", ["stock"])
    failed = [each["library"] for each in found["results"] if each["verdict"] == "failed"]
    assert {*failed} == {"stock"}
    suites = ElementTree.parse(tmp_path / "report" / "junit.xml").findall("testsuite")
    assert {each.get("failures") for each in suites} == {"0"}
    times = [each["seconds"] for each in found["results"]]
    assert min(times) >= 0.0 and 0.0 < sum(times) <= found["seconds"]
    assert main(["report", "make", str(tmp_path / "report")]) == PASSED
    kept = json.loads((tmp_path / "report" / "results.json").read_text())
    assert [each["seconds"] for each in kept["results"]] == times


def test_a_report_made_by_the_api_equals_the_commands(tmp_path, monkeypatch, capsys):
    keep(monkeypatch, lambda task: task.check in ("picture", "studio"))
    main(["check", PLASTER, "--report", str(tmp_path / "command"), "--workers", "0"])
    made = [tmp_path / "command" / "report.html"]
    made.append(write(check(PLASTER, compared="stock"), tmp_path / "api"))
    pages = [re.sub(r"Finished in [\d.]+", "", page.read_text(encoding="utf-8")) for page in made]
    assert "Difference of the two" in pages[0]
    assert pages[0] == pages[1]


def test_a_picture_for_the_report_that_takes_too_long_is_a_note(tmp_path, monkeypatch):
    keep(monkeypatch, lambda task: task.check == "studio")
    run = check(PLASTER, folder=tmp_path, workers=1, timeout=1e-3)
    [note] = [each for each in run.notes if "in the studio" in each]
    assert "timed out" in note and Path(PLASTER).name in note


def test_check_of_stock_fails_and_names_the_defects(capsys, monkeypatch):
    keep_checks(monkeypatch, "value")
    stock = ["check", PLASTER, "--library", "stock", "--workers", "0"]
    assert main(stock) == FAILED
    short = capsys.readouterr().out
    assert (
        "EON in GLSL is wrong for light from behind: docs/upstream/genglsl_clamped_dot.md" in short
    )
    assert short.splitlines()[-1].startswith("To fix it, load ")
    assert main([*stock, "--full"]) == FAILED
    assert "EON with clamped dot(wo, wi)" in capsys.readouterr().out


@pytest.mark.parametrize(
    "options, scene, shape",
    [
        ([], "studio", "ball"),
        (["--scene", "side"], "side", "sphere"),
        (["--host", "reference"], "side", "sphere"),
    ],
    ids=" ".join,
)
def test_render_shows_a_shader_ball_in_a_studio_where_the_host_can_and_says_so_in_the_file(
    options, scene, shape, gl, tmp_path, capsys
):
    output = str(tmp_path / "a.exr")
    options = [*options, "--element", "ochre_plaster", "--size", "32", "--output", output]
    assert main(["render", PLASTER, *options]) == PASSED
    image = oiio.ImageBuf(output)
    for name, value in {"element": "ochre_plaster", "scene": scene, "shape": shape}.items():
        assert image.spec().get_string_attribute(f"mxeon:{name}") == value
    pixels = image.get_pixels(oiio.FLOAT)
    assert pixels.shape == (32, 32, 3) and pixels.max() > 0.1
    assert pixels[0, 0].any() == (shape == "ball")
    printed, error = capsys.readouterr()
    assert printed == f"{output}\n"
    fallback = "warning: reference: cannot draw the studio's environment; used --scene side"
    assert (fallback in one_line(error)) if "reference" in options else not error


# --- effects of commands ------------------------------------------------------------------------


def test_generate_writes_a_file_for_each_stage_and_material(tmp_path, capsys):
    targets = ["--target", "glsl", "--target", "osl"]
    assert main(["generate", CLAY, *targets, "--outputPath", str(tmp_path)]) == PASSED
    names = {path.name for path in tmp_path.iterdir()}
    assert {f"clay.terracotta.{end}" for end in ("glsl.frag", "glsl.vert", "osl")} <= names
    assert set(capsys.readouterr().out.split()) == {str(tmp_path / name) for name in names}


@pytest.mark.parametrize("host", ["gl", "webgl"])
def test_an_environment_image_ends_at_its_poles(host, hosts, tmp_path):
    hosts(host)  # skips the test if the host cannot run
    document, sky, output = (str(tmp_path / name) for name in ("a.mtlx", "sky.exr", "a.exr"))
    Path(document).write_text(MIRROR)
    rows = np.linspace(1.0, 0.0, 8, dtype=np.float32)  # white at the top, black at the bottom
    oiio.ImageBuf(np.broadcast_to(rows[:, None, None], (8, 16, 3)).copy()).write(sky)
    options = ["--host", host, "--environment", sky, "--size", "128", "--output", output]
    assert main(["render", document, *options]) == PASSED
    # Where the mirror's normal is tilted by 45 degrees, the mirror reflects a pole of the sky.
    pixels = oiio.ImageBuf(output).get_pixels(oiio.FLOAT)
    above, below = pixels[16:22, 61:67], pixels[106:112, 61:67]
    np.testing.assert_allclose(above, 1.0, atol=2.0**-7)
    np.testing.assert_allclose(below, 0.0, atol=2.0**-7)


def test_library_prints_the_folder_and_how_to_load_it(capsys, tmp_path):
    assert main(["library", "--folder"]) == PASSED
    assert capsys.readouterr().out.strip() == str(eonlib_folder())
    assert main(["library"]) == PASSED
    recipes = capsys.readouterr().out.splitlines()
    assert len(recipes) == 8 and all(str(eonlib_folder()) in line for line in recipes)
    words = recipes[-1].partition("mxeon ")[2].split()
    names = {"DIR": str(tmp_path), "FILE": str(CLAY)}
    assert main([names.get(word, word) for word in words]) == PASSED


@pytest.mark.parametrize(
    "option, function",
    [([], eon_rho_from_albedo_normal), (["--average"], eon_rho_from_albedo_avg)],
)
def test_invert_prints_rho(option, function, capsys):
    assert main(["invert", "0.8", "0.4", "0.1", "--roughness", "0.7", *option]) == PASSED
    printed = np.array(capsys.readouterr().out.split(), dtype=float)
    # The command prints nine digits.
    assert np.abs(printed - function([0.8, 0.4, 0.1], 0.7)).max() <= 5e-10


COMMANDS = ("check", "generate", "render", "explore", "library", "invert")
COMMANDS += ("report make", "report diff", "report field", "report schema")
COMMANDS += ("kit export", "kit check")


@pytest.mark.parametrize("command", ["", "report", "kit", *COMMANDS])
def test_help_is_a_sentence_then_usage_and_examples_that_parse(command, capsys):
    assert main([*command.split(), "--help"]) == PASSED
    text = capsys.readouterr().out
    first, usage, *_ = text.split("\n\n")
    assert re.fullmatch(r"[A-Z][^.]*\.", first)
    assert usage.startswith(f"usage: mxeon {command}".rstrip())
    assert "--max" not in text and "--allow" not in text
    examples = re.findall(r"^  mxeon (.*?)(?:  #.*)?$", text, re.MULTILINE)
    assert examples and all(parser().parse_args(each.split()).run for each in examples)


def test_options_for_documents_without_trust_are_listed_apart(capsys):
    for command in ("check", "generate", "render", "explore"):
        assert main([command, "--help-limits"]) == PASSED
        text = capsys.readouterr().out
        assert {f"--max{name.capitalize()}" for name in LIMITS} <= set(text.split())
        assert ("--allowCode" in text) == (command != "generate") and "--workers" not in text


def test_a_reader_who_has_had_enough_is_no_success():
    code = """import sys
from mxeon import cli
def show(options):
    raise BrokenPipeError
cli.library.run = show
sys.exit(cli.main(["library"]))"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (141, "")
