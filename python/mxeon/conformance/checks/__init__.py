# SPDX-License-Identifier: Apache-2.0
"""All checks in the order of execution; each module has a table of them."""

from mxeon.conformance.check import Check
from mxeon.conformance.checks import (
    clients,
    lobes,
    microfacets,
    other_nodes,
    paths,
    states,
    surface_shaders,
    surface_texts,
)

# `mxeon.survey.checks` adds checks of renderers' own samplers.
# fmt: off
CHECKS: list[Check] = [
    *lobes.ROWS, *states.ROWS, *clients.ROWS, *microfacets.ROWS, *other_nodes.ROWS, *surface_shaders.ROWS,
    *surface_texts.ROWS, *paths.ROWS,
]
# fmt: on
