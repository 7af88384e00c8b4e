# SPDX-License-Identifier: Apache-2.0
"""Kinds of probes on a host that tells closures."""

from mxeon.conformance.nodes.bsdf import COMBINED, FILM_PAIRS, HAIR, KINDS, NESTED, SUBSURFACE
from mxeon.conformance.nodes.surface_shaders import WHOLE
from mxeon.conformance.nodes.transmission import KINDS as TRANSMISSION_KINDS

# Kinds of what scatters light. A closure has its arguments to the last bit, and no fit of a shader's, so
# that its tolerances are others.
DIFFUSE = "pairs"
SCATTERING = (
    DIFFUSE,
    *KINDS,
    HAIR,
    SUBSURFACE,
    COMBINED,
    NESTED,
    FILM_PAIRS,
    *TRANSMISSION_KINDS,
    WHOLE,
)


def closure_kind(kind: str) -> str:
    """Kind of a node's probe on such a host, by its kind on one that evaluates."""
    return f"{kind} of closures" if kind in SCATTERING else kind
