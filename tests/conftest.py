# SPDX-License-Identifier: Apache-2.0
"""Hosts for the tests, each opened once in a session, when a test first asks for it."""

import pytest
from coverage import Coverage

from mxeon.conformance import reference as reference_host
from mxeon.shaders.hosts import open_host
from tests.support.availability import available, required


def pytest_configure():
    """Refuse an unknown name of a required host before any test runs."""
    try:
        required()
    except ValueError as error:
        raise pytest.UsageError(str(error)) from None


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    """Trace lines in the tests of the models alone, which have to reach them all by themselves."""
    coverage = None if "models" in item.path.parts else Coverage.current()
    if coverage is None:
        return (yield)
    coverage.stop()
    try:
        return (yield)
    finally:
        coverage.start()


@pytest.fixture(scope="session")
def hosts():
    """The host of a name, which stays open until the session ends."""
    opened = {}

    def host(name):
        if name not in opened:
            with available(name):
                opened[name] = open_host(name, reference_host.ROW)
                opened[name].identity()
        return opened[name]

    yield host
    for each in opened.values():
        each.close()


@pytest.fixture(scope="session")
def gl(hosts):
    """The gl host."""
    return hosts("gl")


@pytest.fixture(scope="session")
def reference(hosts):
    """The reference host."""
    return hosts("reference")
