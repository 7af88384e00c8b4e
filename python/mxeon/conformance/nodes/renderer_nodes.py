# SPDX-License-Identifier: Apache-2.0
"""Nodes that a renderer has of its own, as subjects: the rows of `mxeon.hosts` tell them."""

from dataclasses import dataclass

from mxeon import hosts
from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.models.table import OTHERS, Model


@dataclass(frozen=True)
class RendererNode(DiffuseSubject):
    """A node of a renderer's own, and the model that its documentation claims."""

    forms: tuple[str, ...] = ()  # as those of `mxeon.hosts.OwnNode`
    others: bool = False
    sampled: bool = False

    @property
    def _others(self) -> tuple[Model, ...]:
        """Models of renderers' own nodes; Burley's with the albedo that the node's own has."""
        name = self.model if self.model.startswith("burley") else "burley"
        left_out = {"burley", "burley_lambert"} - {name}
        return tuple(row for row in OTHERS if row.name not in left_out)


def renderer_nodes(host: str) -> tuple[RendererNode, ...]:
    """The nodes of a host's own that are judged; none for a host of generated shaders."""
    own = (each for row in hosts.HOSTS if row.name == host for each in row.nodes)
    return tuple(
        RendererNode(
            each.title, None, each.model, each.inputs, each.forms, each.others, each.sampled
        )
        for each in own
    )


def all_renderer_nodes() -> tuple[RendererNode, ...]:
    return tuple(node for row in hosts.HOSTS for node in renderer_nodes(row.name))
