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

from tools.benchmarks.mutants.mutant import ROOT, Mutant

TESTS = "tests"  # in the place of a host
FOLDER = "tests/models"
OPTIONS = ("-x", "-q", "--tb=line", "-rfE", "-p", "no:cacheprovider", "--no-header")
FAILED = re.compile(r"^(?:FAILED|ERROR) \S*?(\w+\.py)(?:::(\w+))?.*?(?: - (.*))?$", re.MULTILINE)
WIDTH = {"COLUMNS": "200"}  # of pytest's lines, lest it cut the messages
PASSED, NO_TEST = 0, 5  # exit statuses of pytest


def trial_of_reference(mutant: Mutant) -> dict[str, Any] | None:
    """The first test that fails, or None: those named for the file are asked first, then all."""
    with TemporaryDirectory(prefix="mxeon-mutant-") as base:
        copy = Path(base, "python")
        shutil.copytree(ROOT / "python", copy)
        for file, text in mutant.texts().items():
            Path(base, file).write_text(text, encoding="utf-8")
        named = tuple(f"{FOLDER}/{name}" for name in mutant.tests)
        for tests in (named,) if mutant.equivalent else (named, (FOLDER,)):
            assert_pass(tests)
            if failure := first_failure(copy, tests):
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
        env=os.environ | WIDTH | {"PYTHONPATH": str(package)},
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
