# SPDX-License-Identifier: Apache-2.0
"""The wheel and the sdist have the right contents, and work outside the checkout."""

import os
import sys
import zipfile
from pathlib import Path

import MaterialX as mx
import pytest

import mxeon
from mxeon.conformance.results.known_issues import issues
from mxeon.shaders.nodes import EON
from tests.support.command import output
from tests.support.documents import lobe, material

pytestmark = pytest.mark.whole

CHECKOUT = Path(__file__).parents[1]
DATA = {
    "libraries": "eonlib/documents",
    "genglsl": "eonlib/genglsl",
    "genosl": "eonlib/genosl",
    "examples": "examples",
}  # folders of the checkout, and paths of their files in the wheel
SUFFIXES = (".mtlx", ".glsl", ".osl", ".xml", ".png")
SCRIPT = Path(mx.__file__).parent / "_scripts" / "generateshader.py"

LOAD = """
import mxeon
from mxeon.conformance.results.known_issues import issues
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.library import assert_eonlib, data_folder, examples_folder, load_library
print(data_folder())
assert_eonlib(load_library())
assert issues()
assert_eonlib(load_library(profile="cycles"))
for path in sorted(examples_folder().glob("*.mtlx")):
    print(path.name, len(mxeon.generate(path, "glsl")))
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Folder with the sdist, and with the wheel that was built from the sdist."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, CHECKOUT]
    output(*build, cwd=folder)
    return folder


@pytest.fixture(scope="module")
def wheel(built):
    [path] = built.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """New virtual environment with the wheel. The wheel uses the dependencies installed here."""
    folder = tmp_path_factory.mktemp("fresh")
    run([sys.executable, "-m", "venv", "--without-pip", folder], folder)
    python = folder / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", python]
    run([*pip, "install", "--no-deps", "--no-index", wheel], folder)
    [packages] = folder.glob("lib/python*/site-packages")
    (packages / "dependencies.pth").write_text(str(Path(mx.__file__).parents[1]))
    return folder


def run(command, folder):
    """Run a command without the checkout on Python's path, and return the command's output."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return output(*command, cwd=folder, env=clean)


def test_the_wheel_holds_the_package_with_the_data_of_the_checkout_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    parts = {part for name in names for part in name.split("/")}
    assert not parts & {"tests", "__pycache__"}
    # A folder `libraries` elsewhere in the wheel would hide MaterialX's folder `libraries`.
    libraries = {name.split("/libraries/")[0] for name in names if "/libraries/" in name}
    assert libraries == {"mxeon/data/eonlib/genglsl/environment"}
    assert {name.split("/")[0] for name in names} == {
        *("mxeon", f"mxeon-{mxeon.__version__}.dist-info")
    }
    assert {"mxeon/py.typed", "mxeon/explorer/explorer.html", "mxeon/data/LICENSE"} <= names
    for folder, place in DATA.items():
        sources = [path for path in (CHECKOUT / folder).rglob("*") if path.suffix in SUFFIXES]
        paths = [path.relative_to(CHECKOUT / folder).as_posix() for path in sources]
        assert paths and {f"mxeon/data/{place}/{path}" for path in paths} <= names
    data = {name.removeprefix("mxeon/data/") for name in names if name.startswith("mxeon/data/")}
    pins = {f"renderers/{name}.json" for name in ("package", "package-lock")}
    assert {name for name in data if name.startswith("renderers/")} == pins
    pages = {name for name in data if name.startswith("upstream/")}
    ledger = {f"upstream/{page}.md" for page in (*issues(), "README")}
    assert pages == {*ledger, "upstream/measured.json"}
    folders = {"eonlib", "examples", "renderers", "upstream", "LICENSE"}
    assert {name.split("/")[0] for name in data} == folders


def test_the_installed_package_loads_and_generates_outside_the_checkout(environment, tmp_path):
    folder, *made = run([environment / "bin" / "python", "-I", "-c", LOAD], tmp_path).splitlines()
    assert Path(folder).is_relative_to(environment)
    examples = sorted(path.name for path in (CHECKOUT / "examples").glob("*.mtlx"))
    assert [line.split()[0] for line in made] == examples


def test_the_installed_command_answers(environment, tmp_path):
    mxeon_there = environment / "bin" / "mxeon"
    assert run([mxeon_there, "--version"], tmp_path) == f"mxeon {mxeon.__version__}\n"


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
