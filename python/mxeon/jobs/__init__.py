# SPDX-License-Identifier: Apache-2.0
"""Run work in other processes and on other machines. The package knows nothing about shading."""

from mxeon.errors import InputError

TIMEOUT = 300.0  # seconds per item
WAIT = 60.0  # maximum seconds without any worker of a cluster, at the start or later
LONGEST = 1e6  # longest time in seconds that timers accept


def check_timeout(seconds: float, name: str = "timeout") -> None:
    """Raise InputError unless 0 < seconds <= LONGEST."""
    if not 0.0 < seconds <= LONGEST:
        raise InputError(f"{name} must be positive and at most {LONGEST:g} s; got {seconds:g}")
