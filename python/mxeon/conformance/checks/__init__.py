# SPDX-License-Identifier: Apache-2.0
"""All checks in the order of execution. Each module of this package defines a table of checks."""

from mxeon.conformance.check import Check
from mxeon.conformance.checks import clients, lobes, microfacets, other_nodes, paths, states
from mxeon.conformance.checks.surface_shaders import ROWS as SURFACE_SHADERS

# `mxeon.survey.checks` adds checks of renderers' own samplers.
CHECKS: list[Check] = [
    *lobes.ROWS,
    *states.ROWS,
    *clients.ROWS,
    *microfacets.ROWS,
    *other_nodes.ROWS,
    *SURFACE_SHADERS,
    *paths.ROWS,
]
