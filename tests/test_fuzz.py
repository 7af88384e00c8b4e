# SPDX-License-Identifier: Apache-2.0
"""The fuzzer: a slice of it has no fault, and a trial notices what is wrong."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mxeon.jobs import pool
from tests.fuzz import opens
from tests.fuzz.cases import OUT, Case
from tests.fuzz.families import FAMILIES, cases
from tests.fuzz.trial import trial
from tests.fuzz.words import CANARY, POISON
from tests.support.availability import program

LIMIT = 60.0  # seconds for one case
# Cases of each family: few of those that take a second each. tests/models tries every argument.
COUNTS = dict.fromkeys(FAMILIES, 12) | {"found": None, "mutated": 50}
del COUNTS["arguments"]


@pytest.mark.parametrize("family", COUNTS)
def test_a_slice_of_each_family_ends_without_fault(family):
    tried = cases(family, COUNTS[family])
    outcomes = [each for _, each in pool.run(FAMILIES[family].trial, tried, 1, LIMIT)]
    assert len(outcomes) == len(tried) >= 12
    faults = (each.failure or each.value[1] for each in outcomes)
    assert [fault for fault in faults if fault] == []


@pytest.fixture(scope="module")
def strace():
    """Skip the test where the system lets no process be traced."""
    command = [program("strace"), "-o", os.devnull, sys.executable, "-V"]
    if subprocess.run(command, capture_output=True).returncode:
        pytest.skip("the system lets no process be traced")


@pytest.mark.usefixtures("strace")
def test_materialx_opens_no_file_that_a_document_names():
    paths = opens.opens(10)
    assert opens.strangers(paths) == []
    assert any(opens.COPIES in path for path in paths) and paths.total() > 100


@pytest.mark.usefixtures("strace")
def test_the_trace_notices_what_materialx_opens():
    assert any(path.endswith(".glsl") for path in opens.strangers(opens.opens(4, bare=True)))


def write(path, text):
    """A command that writes a file."""
    Path(path).parent.mkdir(exist_ok=True)
    Path(path).write_text(text)
    return 0


WRONG = {
    "a traceback": (lambda _: 1 / 0, "ended with ZeroDivisionError"),
    "another status": (lambda _: 7, "ended with 7"),
    "no reason": (lambda _: 2, "did not say why"),
    "two lines": (lambda _: print("more", file=sys.stderr) or 0, "said 'more'"),
    "a command": (lambda _: print("  ::error::x") or 0, "said '  ::error::x' to a runner"),
    "a command in it": (lambda _: print("a ##[error]x") or 0, "said '##[error]x' to a runner"),
    "a long line": (lambda _: print("mxeon" + 2000 * ".", file=sys.stderr) or 0, "of 2005 char"),
    "a file elsewhere": (lambda _: write("../stray", "x"), "wrote stray"),
    "a file changed": (lambda _: write("base.mtlx", "x"), "wrote documents"),
    "a secret told": (lambda _: print(CANARY) or 0, "gave away a file from outside"),
    "a secret written": (lambda _: write("../out/a.osl", CANARY), "gave away a file from outside"),
    "a word as code": (lambda _: write("../out/a.osl", POISON), "let a word into a shader as code"),
}


@pytest.mark.parametrize("does, fault", WRONG.values(), ids=WRONG)
def test_a_trial_notices(does, fault):
    assert fault in trial(Case("control", (("base.mtlx", b""),), ("generate", OUT)), does)[1]
