# SPDX-License-Identifier: Apache-2.0
"""The style that tools can check: lint, format and types, as pyproject.toml configures them."""

import ast
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

from mxeon.hosts import HOSTS

ROOT = Path(__file__).parents[1]
TOOLS = {
    "lint": ("ruff", "check", "--no-cache"),
    "format": ("ruff", "format", "--check", "--no-cache"),
    "types": ("mypy",),  # which remembers the files that are as they were
}

PACKAGES = sorted(path for path in (ROOT / "python" / "mxeon").iterdir() if path.is_dir())


def anys(text):
    """Lines that use the type Any, but for imports."""
    tree = ast.parse(text)
    names = {
        node.lineno for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id == "Any"
    }
    return [line for number, line in enumerate(text.splitlines(), 1) if number in names]


def test_the_conformance_suite_says_why_a_type_is_any():
    files = sorted((ROOT / "python" / "mxeon" / "conformance").rglob("*.py"))
    lines = [line for path in files for line in anys(path.read_text())]
    assert [line for line in lines if "  # " not in line] == []
    assert anys("from typing import Any\n\nx: list[Any] = []\n") == ["x: list[Any] = []"]


def class_names(package):
    """Modules that define a class, by its name."""
    names = defaultdict(list)
    for path in sorted(package.rglob("*.py")):
        module = ".".join(path.relative_to(package.parent).with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                names[node.name].append(module.removesuffix(".__init__"))
    return names


def test_no_class_name_stands_twice():
    names = class_names(ROOT / "python" / "mxeon")
    # A row of HOSTS names a module alone: its class is `Host` by convention; see docs/design.md.
    modules = {row.module for row in HOSTS if row.module}
    assert set(names.pop("Host")) == {"mxeon.hosts.base", "mxeon.conformance.reference", *modules}
    assert {name: modules for name, modules in names.items() if len(modules) > 1} == {}


def constants_imported(package):
    """Modules that define each constant of the conformance suite that is imported by its name."""
    home, imported = "mxeon.conformance", set()
    defined = defaultdict(list)
    for path in package.rglob("*.py"):
        tree = ast.parse(path.read_text())
        module = ".".join(path.relative_to(package.parent).with_suffix("").parts)
        stored = [each for node in tree.body for each in targets(node) if each.isupper()]
        # These are read as `tolerances.VALUE`, `kinds.SHEEN` and `lobes.CHECKS`.
        spaces = (f"{home}.accuracy.", f"{home}.checks.", f"{home}.nodes.kinds")
        if module.startswith(home) and not module.startswith(spaces):
            for name in stored:
                defined[name].append(module)
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(home):
                imported |= {each.name for each in node.names if each.name.isupper()}
    return {name: modules for name, modules in defined.items() if name in imported}


def targets(node):
    """Names that a statement assigns to."""
    assigned = getattr(node, "targets", [getattr(node, "target", None)])
    return [each.id for one in assigned if one for each in ast.walk(one) if type(each) is ast.Name]


def test_a_constant_that_others_import_stands_once():
    names = constants_imported(ROOT / "python" / "mxeon")
    assert len(names) > 100
    assert {name: modules for name, modules in names.items() if len(modules) > 1} == {}


@pytest.mark.parametrize("tool", TOOLS)
def test_the_code_passes(tool):
    command = [sys.executable, "-m", *TOOLS[tool]]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=550)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_function_without_types_is_refused(tmp_path):
    (tmp_path / "untyped.py").write_text("def untyped(x): return x\n")
    configuration = ["--config-file", str(ROOT / "pyproject.toml"), "untyped.py"]
    command = [sys.executable, "-m", "mypy", "--no-incremental", *configuration]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=550)
    assert done.returncode == 1 and "missing a type annotation" in done.stdout
