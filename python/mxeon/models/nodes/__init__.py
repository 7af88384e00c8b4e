# SPDX-License-Identifier: Apache-2.0
"""The BSDF nodes of pbrlib, one row for each mode, as functions of the values of their inputs."""

from __future__ import annotations

import numpy as np

from mxeon.models import table
from mxeon.models.core.arguments import checked_choice
from mxeon.models.core.arrays import Array
from mxeon.models.nodes.lobes import LOBE_NODES
from mxeon.models.nodes.microfacets import MICROFACET_NODES
from mxeon.models.nodes.node import Inputs, PbrNode

NODES = (*LOBE_NODES, *MICROFACET_NODES)


def node(name: str) -> PbrNode:
    """The row of NODES with this name."""
    rows = {row.name: row for row in NODES}
    return rows[checked_choice("node", name, rows)]


def diffuse_node(name: str, category: str) -> PbrNode:
    """A model of `mxeon.models.table` as the row of a node.

    >>> row, up = diffuse_node("lambert", "oren_nayar_diffuse_bsdf"), np.array([[0.0, 0.0, 1.0]])
    >>> inputs = {"color": np.full((1, 3), 0.5), "roughness": np.zeros(1)}
    >>> (np.pi * row.value(up, up, inputs)).tolist(), row.albedo(up, inputs).tolist()
    ([[0.5, 0.5, 0.5]], [[0.5, 0.5, 0.5]])
    """
    model = table.model(name)
    names = ("roughness",) if model.parameter else ()

    def value(wo: Array, wi: Array, inputs: Inputs) -> Array:
        return model.brdf(wo, wi, inputs["color"], *(inputs[each] for each in names))

    def albedo(wo: Array, inputs: Inputs) -> Array:
        mu = np.minimum(wo[:, 2], 1.0)
        return model.closed_albedo_dir(mu, inputs["color"], *(inputs[each] for each in names))

    return PbrNode(name, model.title, category, ("color", "roughness"), value, albedo)
