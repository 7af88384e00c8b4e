# SPDX-License-Identifier: Apache-2.0
"""All checks, in the order in which they are made."""

from importlib import import_module

from mxeon.conformance.check import CHECKS as CHECKS
from mxeon.conformance.check import Check as Check

_NAMES = "lobes states microfacets other_nodes surface_shaders paths"
for _name in _NAMES.split():  # each adds its own
    import_module(f"{__name__}.{_name}")
