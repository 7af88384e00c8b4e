# SPDX-License-Identifier: Apache-2.0
"""All checks, in the order in which they are made: each module adds its own."""

from mxeon.conformance.check import CHECKS as CHECKS
from mxeon.conformance.check import Check as Check

# isort: off
from mxeon.conformance.checks import lobes as lobes
from mxeon.conformance.checks import states as states
from mxeon.conformance.checks import microfacets as microfacets
from mxeon.conformance.checks import other_nodes as other_nodes
from mxeon.conformance.checks import surface_shaders as surface_shaders
from mxeon.conformance.checks import paths as paths
