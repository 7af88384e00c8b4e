# SPDX-License-Identifier: Apache-2.0
"""The wheel and the sdist: what they hold, and that they work outside the checkout."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import MaterialX as mx
import pytest

import mxeon
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.shaders.nodes import EON
from tests.support.documents import lobe, material

CHECKOUT = Path(__file__).parents[1]
DATA = {
    "libraries": "eonlib/documents",
    "genglsl": "eonlib/genglsl",
    "genosl": "eonlib/genosl",
    "examples": "examples",
}  # folders of the checkout, and where they lie in the wheel
SUFFIXES = (".mtlx", ".glsl", ".osl", ".xml", ".png")
SCRIPT = Path(mx.__file__).parent / "_scripts" / "generateshader.py"

LOAD = """
import mxeon
from mxeon.conformance.results.known_issues import ISSUES
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.library import assert_ours, data_folder, examples_folder, load_library
print(data_folder())
assert_ours(load_library())
assert_ours(load_library(profile="cycles"))
for path in sorted(examples_folder().glob("*.mtlx")):
    print(path.name, len(mxeon.generate(path, "glsl")))
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Folder of the sdist and of the wheel that was built from it."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, CHECKOUT]
    done = subprocess.run(build, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def wheel(built):
    [path] = built.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """A fresh environment that holds the wheel, and sees the dependencies of this one."""
    folder = tmp_path_factory.mktemp("fresh")
    run([sys.executable, "-m", "venv", "--without-pip", folder], folder)
    python = folder / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", python]
    run([*pip, "install", "--no-deps", "--no-index", wheel], folder)
    [packages] = folder.glob("lib/python*/site-packages")
    (packages / "dependencies.pth").write_text(str(Path(mx.__file__).parents[1]))
    return folder


def run(command, folder):
    """What a command prints, run from a folder; it has to succeed."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        command, cwd=folder, env=clean, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def contents(wheel):
    with zipfile.ZipFile(wheel) as archive:
        return archive.namelist()


def test_the_wheel_holds_the_data_of_the_checkout(wheel):
    files = {name for name in contents(wheel) if name.startswith("mxeon/data/")}
    assert {name.split("/")[2] for name in files} == {
        *("eonlib", "examples", "renderers", "upstream", "LICENSE")
    }
    for folder, place in DATA.items():
        source = CHECKOUT / folder
        sources = [path for path in source.rglob("*") if path.suffix in SUFFIXES]
        names = {f"mxeon/data/{place}/{path.relative_to(source).as_posix()}" for path in sources}
        assert names and names <= files


def test_the_wheel_pins_the_renderers_from_npm_and_holds_none(wheel):
    folder = "mxeon/data/renderers/"
    files = {name for name in contents(wheel) if name.startswith(folder)}
    assert files == {f"{folder}package.json", f"{folder}package-lock.json"}


def test_the_wheel_holds_the_page_of_each_known_issue_and_no_script(wheel):
    folder = "mxeon/data/upstream/"
    files = {name for name in contents(wheel) if name.startswith(folder)}
    assert files >= {f"{folder}{issue.page}.md" for issue in ISSUES}
    assert {Path(name).suffix for name in files} == {".md"}


def test_the_wheel_says_that_it_has_types(wheel):
    assert "mxeon/py.typed" in contents(wheel)


def test_the_wheel_holds_the_page_of_the_explorer(wheel):
    assert "mxeon/explorer/explorer.html" in contents(wheel)


def test_the_wheel_writes_a_copy_of_eonlib_for_others(environment, tmp_path):
    run([environment / "bin" / "mxeon", "library", "--export", tmp_path / "copy"], tmp_path)
    files = {path.relative_to(tmp_path / "copy").as_posix() for path in tmp_path.rglob("*.*")}
    assert {"genglsl/lib/eon.glsl", "README.txt"} <= files
    assert (tmp_path / "copy" / "LICENSE").read_bytes() == (CHECKOUT / "LICENSE").read_bytes()


def test_no_folder_of_the_wheel_hides_materialxs_libraries(wheel):
    assert [name for name in contents(wheel) if "libraries" in name.split("/")] == []


def test_the_wheel_holds_the_package_alone(wheel):
    roots = {name.split("/")[0] for name in contents(wheel)}
    assert roots == {"mxeon", f"mxeon-{mxeon.__version__}.dist-info"}
    parts = {part for name in contents(wheel) for part in name.split("/")}
    assert [
        part for part in parts if part in ("tests", "__pycache__") or part.startswith("test_")
    ] == []


def test_the_sdist_holds_what_the_tests_need_and_nothing_made(built):
    [path] = built.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        names = [name.partition("/")[2] for name in archive.getnames()]
    assert {"run", "pyproject.toml", "LICENSE", "README.md", "tests/test_wheel.py"} <= set(names)
    hidden = (".venv", ".venv-cycles", ".git", "out", "dist", "build")
    assert "explorer/package-lock.json" in names
    assert [
        name
        for name in names
        if name.split("/")[0] in hidden or {"__pycache__", "node_modules"} & {*name.split("/")}
    ] == []


def test_the_installed_package_loads_and_generates_outside_the_checkout(environment, tmp_path):
    folder, *made = run([environment / "bin" / "python", "-I", "-c", LOAD], tmp_path).splitlines()
    assert Path(folder).is_relative_to(environment)
    examples = sorted(path.name for path in (CHECKOUT / "examples").glob("*.mtlx"))
    assert [line.split()[0] for line in made] == examples


def test_the_installed_command_answers(environment, tmp_path):
    answer = run([environment / "bin" / "mxeon", "--version"], tmp_path)
    assert answer == f"mxeon {mxeon.__version__}\n"


def test_the_installed_command_says_where_the_figures_of_the_paper_are(environment, tmp_path):
    command = [environment / "bin" / "mxeon", "figures", tmp_path]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    [line] = done.stderr.splitlines()
    assert done.returncode == 3 and "install a checkout of the repository" in line


@pytest.mark.parametrize(
    "options", [("--path", "{}", "--library", "eonlib"), ("--library", "{}/eonlib")], ids="_".join
)
def test_generateshader_finds_the_installed_library(environment, tmp_path, options):
    [data] = environment.glob("lib/python*/site-packages/mxeon/data")
    options = [option.format(data) for option in options]
    (tmp_path / "clay.mtlx").write_text(material(lobe(EON)))
    command = [sys.executable, SCRIPT, *options, "--outputPath", tmp_path, tmp_path / "clay.mtlx"]
    run(command, tmp_path)
    assert "void eon_diffuse_bsdf(ClosureData" in (tmp_path / "look.glsl.frag").read_text()
