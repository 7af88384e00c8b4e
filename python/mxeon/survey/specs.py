# SPDX-License-Identifier: Apache-2.0
"""Specs of the built-in nodes of renderers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypeAlias

from mxeon.conformance.samples import Values
from mxeon.conformance.specs.diffuse import DiffuseModelSpec, inputs_of, model_row
from mxeon.models.nodes.node import PbrNode
from mxeon.models.table import OTHERS, diffuse_model

Material: TypeAlias = Mapping[str, Any]  # properties of a renderer's material

BOTH = ("color", "roughness")
COLOR = ("color",)  # input of a Lambert node
PUBLISHED = ("eon", "eon_fitted")  # the paper's two forms of EON: exact albedo, or a fit


@dataclass(frozen=True, eq=False, kw_only=True)
class RendererSpec(DiffuseModelSpec):
    """A built-in node of a renderer, and the model that the renderer documents.

    In `material`, "{color}" and "{roughness}" are placeholders for the inputs. Only the diffuse
    lobe may depend on these inputs.
    """

    material: Material = field(default_factory=dict)
    forms: tuple[str, ...] = ()  # published forms, of which the nearest form is judged
    sampled: bool = False  # whether the node's sampling function can be called

    @property
    def claimed(self) -> str:
        """Title of the claimed model, or of the model's first published form."""
        return diffuse_model((*self.forms, self.model)[0]).title

    def of_model(self, model: str) -> Self:
        """A copy of this node that is judged as another model."""
        return replace(self, model=model, row=_row(model, self.node))

    def document(self, inputs: Values | None = None) -> str:
        """An empty text, because a renderer's built-in node has no document."""
        return ""

    def made(self, color: Sequence[float], roughness: float) -> Material:
        """The material with input values in place of the placeholders."""
        inputs = {"{color}": tuple(map(float, color)), "{roughness}": float(roughness)}
        return {
            name: inputs.get(value, value) if isinstance(value, str) else value
            for name, value in self.material.items()
        }


def node(
    title: str, model: str, material: Material, ports: tuple[str, ...] = BOTH, **more: Any
) -> RendererSpec:
    return RendererSpec(
        title=title,
        node=title,
        model=model,
        row=_row(model, title),
        material=material,
        inputs=inputs_of(*ports),
        **more,
    )


def _row(model: str, node: str) -> PbrNode:
    """The row of a renderer's node. Only one of the two Burley models is among the variants."""
    name = model if model.startswith("burley") else "burley"
    left_out = {"burley", "burley_lambert"} - {name}
    variants = tuple(each for each in OTHERS if each.name not in left_out)
    return model_row(model, node, variants)
