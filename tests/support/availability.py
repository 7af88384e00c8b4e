# SPDX-License-Identifier: Apache-2.0
"""What becomes of a test whose host cannot run: skipped, or failed where the host is required.

MXEON_REQUIRE holds names of hosts with commas between. `./run test --all` names all that it installs.
"""

import os
from contextlib import contextmanager

import pytest

from mxeon.errors import NotRun
from mxeon.hosts import host_names

VARIABLE = "MXEON_REQUIRE"


def required():
    """Hosts that have to run."""
    names = {name for name in os.environ.get(VARIABLE, "").split(",") if name}
    if unknown := names - set(host_names()):
        raise ValueError(
            f"{VARIABLE} must hold some of {', '.join(host_names())}; got {', '.join(sorted(unknown))}"
        )
    return names


@contextmanager
def available(host):
    """Skip the test if what is done here says that a host cannot run; fail if it is required."""
    try:
        yield
    except NotRun as reason:
        if host in required():
            pytest.fail(f"{VARIABLE} names {host}, which did not run: {reason}")
        pytest.skip(str(reason))
