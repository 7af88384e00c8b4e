# SPDX-License-Identifier: Apache-2.0
"""The trial of a wrong reference: the tests of the models, run on a copy of mxeon that holds it."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tools.benchmarks.mutants.mutant import FOLDERS, ROOT, Mutant

TESTS = "tests"  # in the place of a host
FOLDER = "tests/models"
OPTIONS = ("-x", "-q", "--tb=line", "-rfE", "-p", "no:cacheprovider", "--no-header")
FAILED = re.compile(r"^(?:FAILED|ERROR) \S*?(\w+\.py)(?:::(\w+))?.*?(?: - (.*))?$", re.MULTILINE)
WIDTH = {"COLUMNS": "200"}  # of pytest's lines, lest it cut the messages
BLENDER = {"MXEON_CYCLES_PYTHON": f"{ROOT}/.venv-cycles/bin/python"}  # which a copy does not have
PASSED, NO_TEST = 0, 5  # exit statuses of pytest


def trial_of_reference(mutant: Mutant) -> dict[str, Any] | None:
    """The first test that fails, or None: those named for the file are asked first, then all."""
    named = tuple(f"{FOLDER}/{name}" for name in mutant.tests)
    return trial_of_tests(mutant, (named,) if mutant.equivalent else (named, (FOLDER,)))


def trial_of_tests(mutant: Mutant, stages: Sequence[tuple[str, ...]]) -> dict[str, Any] | None:
    """The first of some tests that fails on a copy of mxeon and of eonlib, or None."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        for folder in ("python", *FOLDERS):
            shutil.copytree(ROOT / folder, Path(base, folder))
        for file, text in mutant.texts().items():
            Path(base, file).write_text(text, encoding="utf-8")
        for tests in stages:
            assert_pass(tests)
            if failure := first_failure(Path(base, "python"), tests):
                return failure
    return None


@cache
def assert_pass(tests: tuple[str, ...]) -> None:
    """Raise RuntimeError if some tests fail without any change: then they judge no mutant."""
    if failure := first_failure(ROOT / "python", tests):
        raise RuntimeError(f"a test fails without any change: {failure}")


def first_failure(package: Path, tests: Sequence[str]) -> dict[str, str] | None:
    """The first of some tests that fails with the package of a folder, or None."""
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *OPTIONS, *tests],
        cwd=ROOT,
        env=BLENDER | os.environ | WIDTH | {"PYTHONPATH": str(package)},
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode == PASSED:
        return None
    match = FAILED.search(ended.stdout)
    if ended.returncode == NO_TEST or match is None:
        raise RuntimeError(f"no test ran: {ended.stdout[-400:]}{ended.stderr[-400:]}")
    file, test, message = match.groups()
    diagnosis = f"{file}: {message}" if message else file
    return {"check": test or "import", "excess": "", "host": TESTS, "diagnosis": diagnosis}
