# SPDX-License-Identifier: Apache-2.0
"""Skips tests whose host, program or package is missing, unless MXEON_REQUIRE demands a failure.

MXEON_REQUIRE is a comma-separated list of hosts, in which `packages` stands for all programs and
Python packages. `./run test --all` lists everything that the command installs.
"""

import os
import shutil
from contextlib import contextmanager
from importlib import import_module

import pytest

from mxeon import survey
from mxeon.errors import NotRun
from mxeon.hosts import host_names, register

register(*survey.ROWS)
VARIABLE, PACKAGES = "MXEON_REQUIRE", "packages"


def required():
    """Names in MXEON_REQUIRE: hosts that must run, and `packages` if every test must run."""
    names = {name for name in os.environ.get(VARIABLE, "").split(",") if name}
    known = (*host_names(), PACKAGES)
    if unknown := names - set(known):
        raise ValueError(
            f"{VARIABLE} must hold some of {', '.join(known)}; got {', '.join(sorted(unknown))}"
        )
    return names


def missing(name, reason):
    """Skip the test for the given reason, or fail if `name` is required."""
    if name in required():
        pytest.fail(f"{VARIABLE} names {name}: {reason}")
    pytest.skip(reason, allow_module_level=True)


def program(name):
    """Path of a program on PATH. The test is skipped if the program is missing."""
    return shutil.which(name) or missing(PACKAGES, f"no program {name}; ./run test --all has it")


def package(name):
    """Import and return a module. The test is skipped if the module's package is not installed."""
    try:
        return import_module(name)
    except ImportError as error:
        missing(PACKAGES, f"{error}; ./run test --all has it")


@contextmanager
def available(host):
    """Skip the test if the `with` block raises NotRun. If the host is required, fail instead."""
    try:
        yield
    except NotRun as reason:
        missing(host, str(reason))
