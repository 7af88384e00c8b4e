# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: surface shaders, each with all of its lobes."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.ports import draw
from mxeon.conformance.nodes.surface_inputs import GLTF, OPEN_PBR, PREVIEW, STANDARD, Inputs
from mxeon.conformance.samples.batch import Array, Values
from mxeon.shaders.nodes import document_text, node_text


@dataclass(frozen=True)
class SurfaceShader:
    """A surface shader with every lobe on."""

    node: str  # category
    table: Inputs  # its inputs

    libraries: ClassVar[tuple[str, ...]] = ()
    closure: ClassVar[bool] = True
    kind: ClassVar[str] = kinds.SURFACE_SHADER

    @property
    def title(self) -> str:
        return f"{self.node}, every lobe"

    @property
    def model(self) -> str:
        """Name of its equations: its own."""
        return self.node

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs that its lobes may depend on."""
        return tuple(self.table.changed)

    def with_flag(self, inputs: Values) -> Values:
        return inputs

    def document(self, inputs: Values | None = None) -> str:
        """MaterialX text of a material that is this shader alone."""
        return document_text(node_text(self.node, "surfaceshader", "shading"))

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values of the inputs whose lobes have a reference, float32 numbers."""
        return draw(rng, count, self.table.judged)

    def every_input(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values of all inputs of its lobes."""
        return draw(rng, count, (*self.table.judged, *self.table.others))


SHADERS = (
    SurfaceShader("standard_surface", STANDARD),
    SurfaceShader("open_pbr_surface", OPEN_PBR),
    SurfaceShader("gltf_pbr", GLTF),
    SurfaceShader("UsdPreviewSurface", PREVIEW),
)
