# SPDX-License-Identifier: Apache-2.0
"""The table of checks: a claim, how it is measured, how wrong it may be, and what it must catch.

A check passes at error <= tolerance. Its control is the same probe made wrong on purpose, on the same
host; the check has to fail on it. Every tolerance is the expression that its derivation describes.
"""

from mxeon.conformance.checks import (
    emission,
    energy,
    hair,
    lobes,
    microfacets,
    thin_films,
    transmission,
    utilities,
)
from mxeon.conformance.checks import surface_shaders as surfaces
from mxeon.conformance.checks.check import Check

__all__ = ["CHECKS", "Check"]

CHECKS = (
    *lobes.CHECKS,
    *energy.CHECKS,
    *microfacets.CHECKS,
    *energy.COMBINED_CHECKS,
    *emission.CHECKS,
    *hair.CHECKS,
    *transmission.CHECKS,
    *thin_films.CHECKS,
    *utilities.CHECKS,
    *surfaces.CHECKS,
)
