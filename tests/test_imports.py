# SPDX-License-Identifier: Apache-2.0
"""Imports respect the layers of the package, and load no more packages than needed."""

import json
import re
import sys
from pathlib import Path

import pytest

import mxeon
from tests.support.command import output

ROOT = Path(__file__).parents[1]
NUMPY_ALONE = (
    *("mxeon", "mxeon.models", "mxeon.models.sampling"),
    *("mxeon.models.table", "mxeon.hosts", "mxeon.hosts.base", "mxeon.conformance.results"),
)
NEW_MODULES = """
import json, sys
before = set(sys.modules)
import {}
new = {{name.partition(".")[0] for name in set(sys.modules) - before}}
print(json.dumps(sorted(new - sys.stdlib_module_names)))
"""


def loaded(module):
    """Third-party packages that are loaded when a module is imported."""
    return json.loads(output(sys.executable, "-c", NEW_MODULES.format(module)))


def test_a_package_imports_from_floors_below_its_own():
    command = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    arguments = ["--config", ROOT / "pyproject.toml", "--no-cache"]
    environment = {"PYTHONPATH": str(ROOT / "python")}
    output(sys.executable, "-P", "-c", command, *arguments, cwd=ROOT / "python", env=environment)


def test_what_needs_no_engine_runs_without_modules_and_signals_of_posix(tmp_path):
    script = ROOT / "tests" / "support" / "elsewhere.py"
    output(sys.executable, "-X", "warn_default_encoding", script, cwd=tmp_path)


@pytest.mark.parametrize("module", NUMPY_ALONE)
def test_importing_a_model_or_a_table_loads_numpy_alone(module):
    assert loaded(module) == ["mxeon", *(["numpy"] if module != "mxeon" else [])]


def test_checking_a_function_loads_no_engine():
    call = "mxeon.models.diffuse, mxeon; mxeon.check_brdf(mxeon.models.diffuse.eon_brdf)"
    assert {"MaterialX", "moderngl", "pebble", "cattrs", "filelock"}.isdisjoint(loaded(call))


def test_asking_for_help_loads_no_engine():
    assert set(loaded("mxeon.cli")) <= {"mxeon", "numpy"}


def test_an_unknown_public_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'mxeon' has no attribute 'none'"):
        mxeon.none  # noqa: B018


def test_no_module_is_imported_by_a_string_that_the_layers_cannot_see():
    texts = {path.name: path.read_text() for path in (ROOT / "python" / "mxeon").rglob("*.py")}
    named = {name for name, text in texts.items() if re.search(r'import_module\(f?"mxeon', text)}
    assert named == {"mitsuba_worker.py"}  # Mitsuba's Python environment may lack mxeon's plugins
