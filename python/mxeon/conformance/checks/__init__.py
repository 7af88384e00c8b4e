# SPDX-License-Identifier: Apache-2.0
"""All checks, in the order in which they are made."""

from mxeon.conformance.check import CHECKS as CHECKS
from mxeon.conformance.check import Check as Check

from mxeon.conformance.checks import (  # isort: skip  # each adds its own, in this order
    lobes,
    states,
    energy,
    domains,
    microfacets,
    combinations,
    emission,
    hair,
    transmission,
    thin_films,
    utilities,
    surface_shaders,
)

__all__ = [
    "CHECKS",
    "Check",
    "combinations",
    "domains",
    "emission",
    "energy",
    "hair",
    "lobes",
    "microfacets",
    "states",
    "surface_shaders",
    "thin_films",
    "transmission",
    "utilities",
]
