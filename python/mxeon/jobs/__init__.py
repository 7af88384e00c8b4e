# SPDX-License-Identifier: Apache-2.0
"""Work in other processes and on other machines. Independent of shading."""

from mxeon.errors import InputError

TIMEOUT = 300.0  # seconds per item
WAIT = 60.0  # seconds until the workers of a cluster must arrive, or return if all restart at once
LONGEST = 1e6  # the longest wait that timers accept


def check_timeout(seconds: float, name: str = "timeout") -> None:
    """Raise InputError unless 0 < seconds <= LONGEST."""
    if not 0.0 < seconds <= LONGEST:
        raise InputError(f"{name} must be positive and at most {LONGEST:g} s; got {seconds:g}")
