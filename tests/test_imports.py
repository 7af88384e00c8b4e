# SPDX-License-Identifier: Apache-2.0
"""Imports: the floors of the package, and what an import loads."""

import inspect
import json
import pydoc
import re
import subprocess
import sys
import tomllib
import typing
from itertools import pairwise
from pathlib import Path
from pkgutil import resolve_name

import pytest
from numpy.typing import ArrayLike

import mxeon
from mxeon import models

ROOT = Path(__file__).parents[1]
MODELS = ("models", "albedo", "inversion", "sampling", "models.table")
NEW_MODULES = """
import json, sys
before = set(sys.modules)
import {}
new = {{name.partition(".")[0] for name in set(sys.modules) - before}}
print(json.dumps(sorted(new - sys.stdlib_module_names)))
"""


def loaded(module):
    """Packages from outside that the import of a module loads."""
    command = [sys.executable, "-c", NEW_MODULES.format(module)]
    process = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(process.stdout)


def lint(folder):
    """Exit status and output of the import contracts of pyproject.toml, for a source folder."""
    command = (
        "import sys; from importlinter.cli import lint_imports_command; lint_imports_command()"
    )
    process = subprocess.run(
        [
            sys.executable,
            "-P",
            "-c",
            command,
            "--config",
            str(ROOT / "pyproject.toml"),
            "--no-cache",
        ],
        cwd=folder,
        env={"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
    )
    return process.returncode, process.stdout + process.stderr


def test_a_package_imports_from_floors_below_its_own():
    status, output = lint(ROOT / "python")
    assert status == 0, output


def test_an_import_from_a_floor_above_breaks_the_contract(tmp_path):
    package = Path(mxeon.__file__).parent
    for path in package.rglob("*.py"):
        copy = tmp_path / "mxeon" / path.relative_to(package)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    with (tmp_path / "mxeon" / "models" / "table.py").open("a") as file:
        file.write("import mxeon.shaders.scene\n")
    status, output = lint(tmp_path)
    assert status == 1 and "mxeon.models is not allowed to import mxeon.shaders" in output


def drawn(layers):
    """The picture of a contract: a floor a row, the highest first, with its packages in boxes."""
    floors = [[name.removeprefix("mxeon.") for name in layer.split(" | ")] for layer in layers]
    width = max(sum(len(name) + 3 for name in floor) - 1 for floor in floors)
    rows, lines = [], []
    for floor in floors:
        spare, share = width - sum(len(name) + 3 for name in floor) + 1, len(floor)
        widths = [
            len(name) + 2 + spare // share + (i < spare % share) for i, name in enumerate(floor)
        ]
        rows.append("|" + "|".join(map(str.center, floor, widths)) + "|")
        lines.append("+" + "+".join("-" * each for each in widths) + "+")
    between = [
        "".join("+" if "+" in pair else "-" for pair in zip(*each, strict=True))
        for each in pairwise(lines)
    ]
    text = [lines[0]]
    for row, line in zip(rows, [*between, lines[-1]], strict=True):
        text += [row, line]
    return "\n".join(text)


def test_the_design_draws_the_floors_of_the_contracts():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    page = (ROOT / "docs" / "design.md").read_text()
    pictures = [drawn(each["layers"]) for each in contracts["contracts"] if "layers" in each]
    assert len(pictures) == 3
    for picture in pictures:
        assert f"```text\n{picture}\n```" in page, picture


def test_importing_the_package_loads_nothing_else():
    assert loaded("mxeon") == ["mxeon"]


@pytest.mark.parametrize("module", MODELS)
def test_importing_a_model_loads_numpy_alone(module):
    assert loaded(f"mxeon.{module}") == ["mxeon", "numpy"]


@pytest.mark.parametrize("module", ["hosts", "hosts.base", "conformance.results"])
def test_importing_the_table_of_hosts_or_results_loads_numpy_alone(module):
    assert loaded(f"mxeon.{module}") == ["mxeon", "numpy"]


def test_checking_a_function_loads_no_engine():
    call = "mxeon.models.diffuse.brdf, mxeon; mxeon.check_brdf(mxeon.models.diffuse.brdf.eon_brdf)"
    assert {"MaterialX", "moderngl", "pebble", "cattrs", "filelock"}.isdisjoint(loaded(call))


def test_asking_for_help_loads_no_engine():
    assert set(loaded("mxeon.cli")) <= {"mxeon", "numpy"}


@pytest.mark.parametrize("name", ["check", "generate", "load_library"])
def test_public_names_stay_functions_whatever_was_imported_before(name):
    code = f"import mxeon.conformance, mxeon.cli; mxeon.{name}; assert callable(mxeon.{name})"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_public_names_are_listed_before_their_first_use():
    code = (
        "import mxeon; assert set(mxeon.__all__) <= set(dir(mxeon)); assert 'check' in dir(mxeon)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def public():
    """Functions and classes that the API reference shows, by their names there."""
    pages = (ROOT / "docs" / "api").glob("*.md")
    names = [name for page in pages for name in re.findall(r"^::: (\S+)", page.read_text(), re.M)]
    found = [(name, resolve_name(name)) for name in names]
    return [pytest.param(each, id=name) for name, each in found if not inspect.ismodule(each)]


@pytest.mark.parametrize("function", public())
def test_signatures_show_types_by_their_names(function):
    shown = str(inspect.signature(function))
    assert "Union" not in shown and "numpy." not in shown


def test_help_shows_an_argument_on_a_few_characters():
    heading = pydoc.render_doc(models.eon_brdf, renderer=pydoc.plaintext).splitlines()[2]
    assert heading.startswith("eon_brdf(wo: 'ArrayLike', wi: 'ArrayLike', ") and len(heading) < 110
    assert typing.get_type_hints(models.eon_brdf)["wo"] == ArrayLike


def test_an_unknown_public_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'mxeon' has no attribute 'none'"):
        mxeon.none  # noqa: B018
