# SPDX-License-Identifier: Apache-2.0
"""A test whose host, program or package is missing is skipped; it fails if MXEON_REQUIRE names what is missing.

MXEON_REQUIRE holds names of hosts, separated by commas, and `packages` for all programs and Python packages.
`./run test --all` names all that it installs.
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
    """Hosts that have to run, and `packages` if every test has to."""
    names = {name for name in os.environ.get(VARIABLE, "").split(",") if name}
    known = (*host_names(), PACKAGES)
    if unknown := names - set(known):
        raise ValueError(
            f"{VARIABLE} must hold some of {', '.join(known)}; got {', '.join(sorted(unknown))}"
        )
    return names


def missing(name, reason):
    """Skip the test for this reason; fail if the name is required."""
    if name in required():
        pytest.fail(f"{VARIABLE} names {name}: {reason}")
    pytest.skip(reason, allow_module_level=True)


def program(name):
    """Path of a program on PATH, without which the test does not run."""
    return shutil.which(name) or missing(PACKAGES, f"no program {name}; ./run test --all has it")


def package(name):
    """A module of a Python package, without which the test does not run."""
    try:
        return import_module(name)
    except ImportError as error:
        missing(PACKAGES, f"{error}; ./run test --all has it")


@contextmanager
def available(host):
    """Skip the test if what is done here says that a host cannot run; fail if it is required."""
    try:
        yield
    except NotRun as reason:
        missing(host, str(reason))
