# SPDX-License-Identifier: Apache-2.0
"""Hosts that cannot run: a test is skipped, or fails where ./run test has installed the host."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from mxeon.errors import NotRun
from mxeon.hosts import host_names, host_rows
from tests.support.availability import VARIABLE, available, required

ROOT = Path(__file__).parents[1]


def missing():
    """A host that says why it cannot run."""
    with available("gl"):
        raise NotRun("gl: no driver")


def test_a_host_that_is_not_required_is_skipped_with_its_reason(monkeypatch):
    monkeypatch.setenv(VARIABLE, "cycles")
    with pytest.raises(pytest.skip.Exception, match="gl: no driver"):
        missing()


def test_a_host_that_is_required_fails_with_its_reason(monkeypatch):
    monkeypatch.setenv(VARIABLE, "cycles,gl")
    with pytest.raises(pytest.fail.Exception, match="MXEON_REQUIRE names gl, .*: gl: no driver"):
        missing()


def test_an_unknown_host_cannot_be_required(monkeypatch):
    monkeypatch.setenv(VARIABLE, "gl,opengl")
    with pytest.raises(
        ValueError, match=f"must hold some of {', '.join(host_names())}; got opengl"
    ):
        required()


def test_a_session_ends_at_once_where_an_unknown_host_is_required(monkeypatch):
    monkeypatch.setenv(VARIABLE, "opengl")
    command = [sys.executable, "-m", "pytest", "--collect-only", __file__]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == pytest.ExitCode.USAGE_ERROR and "got opengl" in done.stderr


def test_the_test_run_requires_every_host_that_it_installs():
    names = re.search(r"MXEON_REQUIRE=\$\{MXEON_REQUIRE-([\w,-]+)\}", (ROOT / "run").read_text())
    assert set(names[1].split(",")) == {row.name for row in host_rows() if row.module} - {
        "eevee",  # its checks take minutes on a software driver
        "luxcore",  # its package brings 200 MB for GPUs
        "testrender",
    }
