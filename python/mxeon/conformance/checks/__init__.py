# SPDX-License-Identifier: Apache-2.0
"""All checks, in the order in which they are made."""

from importlib import import_module

from mxeon.conformance.check import CHECKS as CHECKS
from mxeon.conformance.check import Check as Check

for _name in (  # each adds its own
    *("lobes", "states", "domains", "microfacets", "combinations", "emission", "hair"),
    *("utilities", "surface_shaders"),
):
    import_module(f"{__name__}.{_name}")
