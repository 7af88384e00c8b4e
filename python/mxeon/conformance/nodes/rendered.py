# SPDX-License-Identifier: Apache-2.0
"""Kinds of probes on a host that evaluates the closures of a renderer."""

from mxeon.conformance.nodes.bsdf import (
    CLOSED,
    COMBINED,
    FITTED,
    MICROFACET,
    NESTED,
    SCHLICK,
    SHEEN,
    SUBSURFACE,
)
from mxeon.conformance.nodes.closures import DIFFUSE

LOBES = "lobes"  # of surface shaders
RENDERED = (
    DIFFUSE,
    CLOSED,
    SHEEN,
    FITTED,
    MICROFACET,
    SCHLICK,
    SUBSURFACE,
    COMBINED,
    NESTED,
    LOBES,
)


def rendered_kind(kind: str) -> str:
    """Kind of a node's probe on such a host, by its kind on one that evaluates shaders."""
    return f"rendered {kind}" if kind in RENDERED else kind
