# SPDX-License-Identifier: Apache-2.0
"""Imports: the floors of the package, and what an import loads."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import mxeon

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


def test_an_unknown_public_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'mxeon' has no attribute 'none'"):
        mxeon.none  # noqa: B018
