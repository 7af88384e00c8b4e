# SPDX-License-Identifier: Apache-2.0
"""The two chains of modules: imports run one way, and only conformance sees both."""

import ast
import json
import subprocess
import sys
from fnmatch import fnmatchcase
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import mxeon

# Every module, or a pattern of them, after all that it may import.
BASE = ("errors", "signals", "processes", "writing")
MODELS = ("geometry", "formulas", "quadrature", "models", "albedo", "defects", "inversion")
MODELS += ("hemisphere", "ltc", "cltc", "eon_sampling", "sampling", "reference")
SHADERS = ("reading", "library", "permissions", "screening", "encoding", "values", "notes")
SHADERS += ("expansion", "words", "trust", "document", "generation")
SHADERS += ("twins", "scene", "images", "tracer", "hosts")
SHADERS += ("hosts.*",)
CONFORMANCE = ("conformance.*", "conformance")
REPORT = ("junit", "pictures", "plots", "page", "report", "comparison")
FIGURES = ("figures.*", "figures")
KIT = ("kit.*", "kit")
COMMAND = ("arguments", "making", "cli", "__main__")
RUNNING = ("pool", "cluster", "results", "records", "verdict", "journal_lines", "journal")
ORDER = BASE + MODELS + ("compiled",) + SHADERS + RUNNING + CONFORMANCE
ORDER += REPORT + FIGURES + KIT + COMMAND

# The one host that is made of the models.
REFERENCE = "hosts.reference"

# What a run and its pictures consist of.
FOR_REPORT = (*REPORT, "reading", "records", "results", "verdict", "writing", "scene", "hosts")

# Packages from outside, and who may import them.
EXTERNAL = {
    "MaterialX": ("library", "trust", "values", "notes", "expansion", "words", "document")
    + ("generation", "hosts", "hosts.*", "conformance.items"),
    "OpenImageIO": ("images", "writing", "kit.*", "conformance.items"),
    "bpy": ("hosts.cycles_worker",),
    "cattrs": ("journal_lines", "records"),
    "distributed": ("cluster",),
    "filelock": ("journal",),
    "jinja2": ("page",),
    "matplotlib": ("plots", "figures.*"),
    "moderngl": ("hosts.*", "conformance.items"),
    "numba": ("compiled",),
    "pebble": ("pool",),
    "tqdm": ("cli",),
}

NEW_MODULES = """
import json, sys
before = set(sys.modules)
import {}
new = {{name.partition(".")[0] for name in set(sys.modules) - before}}
print(json.dumps(sorted(new - sys.stdlib_module_names)))
"""

FOLDER = Path(mxeon.__file__).parent
FILES = {
    ".".join(path.relative_to(FOLDER).with_suffix("").parts).removesuffix(".__init__"): path
    for path in FOLDER.rglob("*.py")
    if path.parent != FOLDER or path.name != "__init__.py"
}

of_each_module = pytest.mark.parametrize("module", sorted(FILES))
of_each_model = pytest.mark.parametrize("module", MODELS)


def imported(module):
    """Full names of all that a module imports, anywhere in its text."""
    names = set()
    for node in ast.walk(ast.parse(FILES[module].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {each.name for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            inner = {f"{node.module}.{each.name}" for each in node.names}
            names |= {name for name in inner if name.removeprefix("mxeon.") in FILES} or {
                node.module
            }
    return names


def own(module):
    """Modules of this package that a module imports; the package itself holds none."""
    return {name.removeprefix("mxeon.") for name in imported(module) if name.startswith("mxeon.")}


def packages(module):
    """Packages from outside that a module imports."""
    names = {name.partition(".")[0] for name in imported(module)}
    return names - sys.stdlib_module_names - {"mxeon"}


def matches(module, patterns):
    return any(fnmatchcase(module, pattern) for pattern in patterns)


def place(module):
    """Where a module stands in the order."""
    places = [number for number, pattern in enumerate(ORDER) if fnmatchcase(module, pattern)]
    assert places, f"{module} needs a place in the order of tests/test_imports.py"
    return places[0]


def loaded(module):
    """Packages from outside that the import of a module loads."""
    command = [sys.executable, "-c", NEW_MODULES.format(module)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@of_each_module
def test_imports_run_one_way(module):
    assert [name for name in own(module) if place(name) > place(module)] == []


def test_imports_have_no_circle():
    order = tuple(TopologicalSorter({module: own(module) for module in FILES}).static_order())
    assert set(order) == set(FILES)


@of_each_model
def test_the_models_need_numpy_alone(module):
    assert own(module) <= set(MODELS)
    assert packages(module) <= {"numpy"}


@of_each_module
def test_the_shaders_do_not_see_the_models(module):
    seen = own(module) & set(MODELS)
    if matches(module, SHADERS):
        assert seen == ({"reference"} if module == REFERENCE else set())


@of_each_module
def test_only_conformance_and_the_command_see_both_chains(module):
    both = own(module) & set(MODELS) and any(matches(name, SHADERS) for name in own(module))
    assert not both or matches(module, (*CONFORMANCE, *KIT, REFERENCE, "cli"))


@of_each_module
def test_the_report_consumes_a_run_only(module):
    if module in REPORT:
        assert own(module) <= set(FOR_REPORT)


@of_each_module
def test_packages_stay_with_the_modules_that_need_them(module):
    restricted = packages(module) & set(EXTERNAL)
    assert [name for name in restricted if not matches(module, EXTERNAL[name])] == []


def test_importing_the_package_loads_nothing_else():
    assert loaded("mxeon") == ["mxeon"]


@of_each_model
def test_importing_a_model_loads_numpy_alone(module):
    assert loaded(f"mxeon.{module}") == ["mxeon", "numpy"]


def test_asking_for_help_loads_no_engine():
    assert set(loaded("mxeon.cli")) <= {"mxeon", "numpy"}


@pytest.mark.parametrize("name", ["check", "generate", "load_library"])
def test_public_names_stay_functions_whatever_was_imported_before(name):
    code = f"import mxeon.conformance, mxeon.cli; mxeon.{name}; assert callable(mxeon.{name})"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_unknown_public_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'mxeon' has no attribute 'none'"):
        mxeon.none  # noqa: B018
