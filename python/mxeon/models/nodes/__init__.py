# SPDX-License-Identifier: Apache-2.0
"""Table of pbrlib's BSDF nodes. Each row is a mode of a node, with functions of the inputs."""

from __future__ import annotations

from mxeon.models.core.arguments import checked_choice
from mxeon.models.nodes.lobes import LOBE_NODES
from mxeon.models.nodes.microfacets import MICROFACET_NODES
from mxeon.models.nodes.node import PbrNode

PBR_NODES = (*LOBE_NODES, *MICROFACET_NODES)


def node(name: str) -> PbrNode:
    rows = {row.name: row for row in PBR_NODES}
    return rows[checked_choice("node", name, rows)]
