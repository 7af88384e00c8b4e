# SPDX-License-Identifier: Apache-2.0
"""A sample of the fuzzer's cases runs without a fault."""

import os
import subprocess
import sys

import pytest

from mxeon.jobs import pool
from tests.fuzz import opens
from tests.fuzz.cases import COUNTS, cases
from tests.fuzz.trial import judged
from tests.support.availability import program

LIMIT = 60.0  # time limit of a case in seconds
# Number of cases per family. Each case may take a second.
FEW = dict.fromkeys(COUNTS, 12) | {"found": None, "mutated": 50}


@pytest.mark.parametrize("family", FEW)
def test_a_slice_of_each_family_ends_without_fault(family):
    tried = cases(family, FEW[family])
    outcomes = [each for _, each in pool.run(judged, tried, 1, LIMIT)]
    assert len(outcomes) == len(tried) >= 12
    faults = (each.failure or each.value[1] for each in outcomes)
    assert [fault for fault in faults if fault] == []


@pytest.fixture(scope="module")
def strace():
    """Skip the test if the system does not permit a process to trace another process."""
    command = [program("strace"), "-o", os.devnull, sys.executable, "-V"]
    if subprocess.run(command, capture_output=True).returncode:
        pytest.skip("the system lets no process be traced")


@pytest.mark.usefixtures("strace")
def test_materialx_opens_no_file_that_a_document_names():
    count = 20
    paths = opens.opens(count)
    assert opens.strangers(paths) == []
    assert any(map(opens.OWN.search, paths)) and paths.total() > 2 * count


@pytest.mark.usefixtures("strace")
def test_the_trace_notices_what_materialx_opens():
    assert any(path.endswith(".glsl") for path in opens.strangers(opens.opens(4, bare=True)))
