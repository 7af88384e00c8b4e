# SPDX-License-Identifier: Apache-2.0
"""Commands refuse to overwrite their inputs, and files that no argument names."""

import os
import re
import shlex
import sys
from pathlib import Path

import pytest

from mxeon import check, report
from mxeon.cli import main
from mxeon.conformance.results import JUNIT, PAGE, RESULTS
from mxeon.errors import MISUSE, NOT_RUN, PASSED
from mxeon.kit.export import DESCRIPTION, export_kit, kit_node
from mxeon.shaders.library_export import export_library
from mxeon.shaders.nodes import OREN_NAYAR
from tests.support.command import CLAY, PLASTER, one_line
from tests.support.documents import textured
from tests.support.results import PREVIOUS, Run

# Input files, by the file's role in a command.
FILES = {
    "document": "look.mtlx",
    "include": "part.mtlx",
    "texture": "tiles.png",
    "set of textures": "tiles.1001.png",
    "source": "code.glsl",
    "included source": "code.inc",
    "environment": "sky.exr",
    "definitions": "defs/own.mtlx",
    "library": "lib/nodes.mtlx",
    "library's source": "lib/nodes.inc",
    "results": "run/results.json",
    "picture": "run/pictures/a.exr",
    "journal": "run/journal/items.jsonl",
    "kit": f"kit/{DESCRIPTION}",
    "render": "kit/renders/a.exr",
    "page": "nodes.md",
}
TRUSTED = ("library", "library's source", "definitions")
MATERIAL = ("document", "include", "texture", "set of textures", "source", "included source")
MATERIAL += TRUSTED
OPTIONS = "--library lib --definitions defs --workers 0"
# Commands without the final argument, which is the output's path. Values are the output's path, and
# the roles of the files that the command reads.
WRITING = {
    f"render look.mtlx --environment sky.exr {OPTIONS} --output": (
        "out.png",
        (*MATERIAL, "environment"),
    ),
    f"explore look.mtlx {OPTIONS} --output": ("out.html", MATERIAL),
    f"generate look.mtlx --target osl {OPTIONS} --outputPath": ("out/look.a.osl", MATERIAL),
    "report field run --output": ("out.html", ("results", "picture", "journal")),
    f"check look.mtlx {OPTIONS} --report": ("out/junit.xml", MATERIAL),
    "kit check kit --report": ("out/results.json", ("kit", "render")),
    "kit export --library lib --definitions defs": ("out/kit.json", TRUSTED),
}
EMPTY = '<materialx version="1.39" xmlns:xi="http://www.w3.org/2001/XInclude"></materialx>'


@pytest.fixture
def inputs(tmp_path, monkeypatch):
    """Working folder that contains a file for each role. No rendering engine can start there."""
    for name in FILES.values():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    look = textured(["tiles.png", "tiles.&lt;UDIM&gt;.png"])
    parts = '<xi:include href="part.mtlx"/><implementation name="c" file="code.glsl"/>'
    head, tag, rest = look.partition("<materialx")
    rest = ' xmlns:xi="http://www.w3.org/2001/XInclude"' + rest.replace(">", f">{parts}", 1)
    (tmp_path / "look.mtlx").write_text(head + tag + rest)
    (tmp_path / "code.glsl").write_text('#include "code.inc"')
    part = '<xi:include href="nodes.inc"/>'
    (tmp_path / "lib" / "nodes.mtlx").write_text(EMPTY.replace("><", f">{part}<", 1))
    for each in ("lib/nodes.inc", "defs/own.mtlx"):
        (tmp_path / each).write_text(EMPTY)
    monkeypatch.chdir(tmp_path)

    def start(*_):
        raise AssertionError

    monkeypatch.setattr("mxeon.hosts.open_engine", start)
    return tmp_path


def content(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def refused(arguments, folder, capsys):
    """Assert that a command prints a one-line refusal and changes no file. Return the line."""
    before = content(folder)
    assert main(arguments) == MISUSE
    assert content(folder) == before
    printed = capsys.readouterr()
    assert printed.out == ""
    return one_line(printed.err)


@pytest.mark.parametrize(
    "command, kind", [(each, kind) for each in WRITING for kind in WRITING[each][1]]
)
def test_no_output_is_a_file_that_is_read(command, kind, inputs, capsys):
    output = inputs / WRITING[command][0]
    output.parent.mkdir(exist_ok=True)
    named = output if output.parent == inputs else output.parent
    for link in (os.symlink, os.link):
        link(inputs / FILES[kind], output)
        line = refused([*command.split(), str(named)], inputs, capsys)
        assert "output must not replace an input file" in line and FILES[kind] in line
        output.unlink()


@pytest.mark.parametrize("spelling", ["tiles.png", "lib/../tiles.png", "./tiles.png"])
def test_an_output_of_the_name_of_an_input_is_refused(spelling, inputs, capsys):
    line = refused([*next(iter(WRITING)).split(), spelling], inputs, capsys)
    assert "output must not replace an input file" in line


@pytest.mark.parametrize(
    "command, folder",
    [
        ("check look.mtlx --report", "."),
        ("check look.mtlx --definitions defs --report", "defs"),
        ("check look.mtlx --library lib --report", "lib"),
        ("kit check kit --report", "kit"),
        ("kit check kit --report", "kit/renders"),
    ],
)
def test_a_report_goes_to_no_folder_that_holds_what_is_read(folder, command, inputs, capsys):
    (inputs / "there").symlink_to(inputs / folder)
    for name in (folder, "there"):
        line = refused([*command.split(), name], inputs, capsys)
        assert "must be a folder without input files" in line


LOOK = f"{FILES['document']} --workers 0"
RENDER, OSL = f"render {LOOK} --output a.exr", "generate --target osl --outputPath out --workers 0"
# Commands with invalid options or outputs, and words of the error message. mxeon must refuse each
# command before any engine starts.
WRONG = {
    f"{OSL} {CLAY} --element loam": "element must be one of",
    f"{OSL} nowhere.mtlx": "must be a readable file",
    f"{OSL} {FILES['document']} --profile arnold": "profile must be one of",
    f"{OSL} '\0'": "no null character",
    f"{OSL} \udcff.mtlx": "arguments and file names must be UTF-8; got ",
    f"generate {LOOK} --outputPath out": "required: --target",
    f"{OSL} look.mtlx --path nowhere": "--path: must name a folder that exists; got 'nowhere'",
    "check kit": "must hold MaterialX documents",
    f"check {LOOK} --host abacus": "host must be one of gl",
    f"check {LOOK} --host cycels": "got 'cycels': did you mean cycles?",
    f"check {LOOK} --library mine": "library must be one of eonlib, diffuse, stock",
    f"check {LOOK} --library eonlb": "got 'eonlb': did you mean eonlib?",
    f"check {LOOK} --libary stock": "got '--libary': did you mean --library?",
    f"check {LOOK} --node shen_bsdf": "did you mean sheen_bsdf? see mxeon check --node list",
    f"check {LOOK} --report \udcff": "arguments and file names must be UTF-8; got ",
    f"render {CLAY} --output a.exr": "--element must name one of",
    f"render {LOOK} --output none/a.exr": "must lie in a folder that exists; got none/",
    f"render {LOOK} --output \udcff.png": "arguments and file names must be UTF-8; got ",
    f"{RENDER} --scene dusk": "scene must be one of",
    f"{RENDER} --samples 0": "samples must lie in [1, ",
    f"{RENDER} --bounces -1": "bounces must lie in [1, ",
    "invert 0.5 0.5 --roughness 1": "required: B",
    "invert 1.2 0 0 --roughness 1": "color must lie in [0, 1]",
    "frobnicate": "command must be one of check, generate",
    f"chek {LOOK}": "got 'chek': did you mean check?",
    f"render {LOOK} --integrator path --output out.jpg": "output must end in .exr or .png; got",
    f"render {LOOK} --integrator path --output folder.png": "folder.png: must be accessible; not a re",
    f"explore {CLAY} nowhere.mtlx --output out.html": "must be a readable file",
    f"explore {CLAY} --workers 0 --maxSize 10 --output out.html": "raise it with --maxSize",
    f"explore {CLAY} --workers 0 --maxShaders 0 --output out.html": "got 2: raise it with --maxShaders",
    f"explore {CLAY} --workers -1 --output out.html": "workers must be at least 0",
    f"explore {LOOK} --output out.txt": "output must end in .html; got 'out.txt'",
    "report field run --output out.txt": "output must end in .html; got 'out.txt'",
    f"check {LOOK} --report nodes.md": "nodes.md: must be a folder; File exists",
    f"check {LOOK} --report nodes.md/out": "nodes.md: must be a folder; File exists",
    "kit check kit --report nodes.md": "nodes.md: must be a folder; File exists",
    "kit export nodes.md": "nodes.md: must be a folder; File exists",
    "library --export lib": "lib: must be a new or empty folder, or end in .zip",
    "library --export nodes.md": "nodes.md: must be a new or empty folder, or end in .zip",
    "kit export lib": "must be new, empty or a kit",
    "kit export out --node studio_rough": ": load its definition by --definitions FOLDER",
    "kit export out --node conductor_bsdf": "got 'conductor_bsdf', which lacks color and roughness",
    "kit export out --node uniform_edf": ", which lacks roughness",
    f"generate {LOOK} --target osl --outputPath nodes.md": "nodes.md: must be a folder; File exists",
    f"render {LOOK} --integrator path --library nosuch --output out.png": "or a folder that exists; got 'nosuch'",
    f"check {LOOK} --waitForWorkers -1": "waitForWorkers must be positive and at most 1e+06 s; got -1",
    f"check {LOOK} --report ''": "arguments must not be empty; got 'check' 'look.mtlx'",
    f"check {LOOK} --report=": "arguments must not be empty",
    f"generate {LOOK} --target osl --outputPath ''": "arguments must not be empty",
    "library --export ''": "arguments must not be empty",
    "kit export ''": "arguments must not be empty",
}


@pytest.mark.parametrize("command, words", WRONG.items())
def test_what_is_wrong_is_said_first(command, words, inputs, capsys):
    (inputs / "folder.png").mkdir()
    assert words in refused(shlex.split(command), inputs, capsys)


# Invalid options of `mxeon render`, and the error message that a host prints.
UNDRAWN = {
    "--environment sky.hdr": "sky.hdr",
    "--size 0": "size must lie in [1, 8192]",
    "--samples 4": "gl: samples and bounces can be",
    "--shape ball --host reference": "shape must be sphere; got ball, which gl and webgl draw",
    "--geometry teapot.fbx": "shape must be one of sphere, ball, a file .obj or .glb; got 'teapot.fbx'",
}


@pytest.mark.parametrize("options, words", UNDRAWN.items())
def test_what_a_host_cannot_draw_is_one_line(options, words, tmp_path, capsys):
    arguments = ["render", PLASTER, "--output", str(tmp_path / "a.exr"), "--workers", "0"]
    assert words in refused([*arguments, *options.split()], tmp_path, capsys)


@pytest.mark.parametrize("package", ["jinja2", "matplotlib"])
@pytest.mark.parametrize(
    "command", [f"check {LOOK} --report out", "report make run", "report field run --output f.html"]
)
def test_a_page_without_its_packages_is_refused_first(
    package, command, inputs, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, package, None)
    assert f"needs {package}: pip install '.[report]'" in refused(command.split(), inputs, capsys)


REFUSED = "check look.mtlx --host nosuch", "check nowhere", "check look.mtlx --seed -1"


@pytest.mark.parametrize("command", [*REFUSED, "kit check kit"])
def test_a_refused_run_leaves_no_results_of_an_older_one(command, inputs, capsys):
    out, names = inputs / "out", (RESULTS, JUNIT, PAGE)
    (out / "pictures").mkdir(parents=True)
    for name in (*names, "pictures/mine.png"):
        (out / name).write_text(name)
    assert main([*command.split(), "--report", "out"]) == MISUSE
    assert not any((out / name).exists() and (out / name).read_text() == name for name in names)
    assert (out / "pictures" / "mine.png").exists()
    assert {each.name: each.read_text() for each in (out / PREVIOUS).iterdir()} == {
        name: name for name in names
    }


@pytest.mark.parametrize(
    "command",
    [f"generate {PLASTER} --workers 0 --target osl --outputPath", "kit export", "library --export"],
)
def test_names_of_outputs_steer_no_terminal_and_no_runner(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    name = "::error::a\x1b[31m\nb"  # control characters for a CI runner and a terminal
    assert main([*command.split(), name]) == PASSED
    printed = capsys.readouterr().out
    assert os.path.isdir(name) and "error::a\ufffd[31m\ufffdb" in printed
    assert not re.search("^(::|b)|\x1b", printed, re.MULTILINE)


def test_functions_that_write_refuse_likewise(inputs):
    writing = (
        lambda: check(["look.mtlx"], folder="."),
        lambda: check(["look.mtlx"], folder=""),
        lambda: export_kit("kit", node=kit_node(OREN_NAYAR, library="lib")),
        lambda: report.write(Run("1.0", {}, (), (), documents=(inputs / "look.mtlx",)), "out"),
        lambda: export_library(""),
    )
    os.mkdir("out")
    os.link("tiles.png", "out/results.json")
    os.link("lib/nodes.mtlx", "kit/sphere.obj")
    before = content(inputs)
    for write in writing:
        with pytest.raises(ValueError, match="input file|must have a name"):
            write()
    assert content(inputs) == before


def test_a_second_run_replaces_its_own_outputs(tmp_path, monkeypatch):
    """A command may write into the folder of a library that the command reads."""
    monkeypatch.chdir(tmp_path)
    os.mkdir("lib")
    (tmp_path / "lib" / "own.mtlx").write_text('<materialx version="1.39"></materialx>')
    line = f"check {PLASTER} --host msl --library lib --workers 0 --report lib/out"
    for _ in range(2):
        assert main(line.split()) == NOT_RUN


GENERATE = f"generate {PLASTER} --target osl --workers 0 --outputPath out"
# Commands that write a folder, and names of output files that an attacker may create as links.
OUTPUT = "plaster.ochre_plaster.osl"
FOLDERS = {
    GENERATE: (OUTPUT,),
    "kit export out --size 64": ("kit.json", "README.md", "sphere.obj", "materials", "renders"),
    f"check {PLASTER} --host msl --workers 0 --report out": (
        *("results.json", "junit.xml", "report.html"),
        *("journal", "journal/items.jsonl", ".journal.lock"),
    ),
}


@pytest.mark.parametrize(
    "command, name", [(each, name) for each in FOLDERS for name in FOLDERS[each]]
)
def test_nothing_is_written_through_a_link_in_a_folder(
    command, name, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    other, link = tmp_path / "other", Path("out", name)
    main(command.split())
    assert link.exists()
    link.rename("moved")
    link.symlink_to(other)
    dangling = [None] if name == FOLDERS[command][0] else []
    for content in (*dangling, "mine"):
        if content:
            other.write_text(content)
        capsys.readouterr()
        assert main(command.split()) == MISUSE
        said = capsys.readouterr().err
        assert (
            said == f"mxeon: {link}: must not be a link, which leads to another file; remove it\n"
        )
        assert (other.read_text() if other.exists() else None) == content


def test_a_folder_that_is_a_link_is_written_to(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkdir("there")
    os.symlink("there", "out")
    assert main(GENERATE.split()) == PASSED
    assert Path("there", OUTPUT).exists()
