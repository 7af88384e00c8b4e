# SPDX-License-Identifier: Apache-2.0
"""Subjects and probes of the node `surface` with an emission, and nodes that no target has."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from mxeon.conformance.samples.batch import (Array, Batch)
from mxeon.conformance.probes.emission import NodeProbe
from mxeon.conformance.nodes.emission import (ABSENT, EMITTER, SURFACES, AbsentSubject)
from mxeon.models.shading import surface_radiance
from mxeon.shaders.nodes import document_text, input_text, node_text
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

DARK = Scene("dark", size=8)
COLOR = (0.2, 0.5, 2.0)  # radiance
OPACITIES = (0.0, 0.25, 1.0)
BLACK = '  <oren_nayar_diffuse_bsdf name="lobe" type="BSDF" />\n'
EMISSION = '    <input name="edf" type="EDF" nodename="emission" />\n'


@dataclass(frozen=True)
class SurfaceSubject:
    """The node `surface` with an emission, in the dark.

    Attributes
    ----------
    title : str
        Name in reports.
    lit : bool
        Whether it has a BSDF beside.
    """

    title: str
    lit: bool

    flag = None
    node, kind, model = "surface", SURFACES, SURFACES
    libraries = ("stock",)  # no library of ours has one

    def document(self, inputs: Mapping[str, Any] | None = None) -> str:
        """MaterialX text of the surface, with this opacity."""
        emission = node_text("uniform_edf", "EDF", "emission", input_text("color", "color3", COLOR))
        lobe = '    <input name="bsdf" type="BSDF" nodename="lobe" />\n' if self.lit else ""
        opacity = input_text("opacity", "float", (inputs or {}).get("opacity", 1.0))
        surface = node_text("surface", "surfaceshader", "shading", lobe + EMISSION + opacity)
        return document_text((BLACK if self.lit else "") + emission + surface)


@dataclass(frozen=True, eq=False)
class SurfaceEmissionProbe(NodeProbe):
    """A surface on a host that draws it in the dark, one picture for each opacity."""

    kind: ClassVar[str] = SURFACES

    subject: SurfaceSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points of the sphere, for each of OPACITIES."""
        points = sphere(DARK.size)
        wo = local_directions(points.normal[points.mask], VIEW)
        return tuple(Batch(wo, wo, {"opacity": each}, DARK) for each in OPACITIES)

    @property
    def few(self) -> tuple[Batch, ...]:
        """The same: they are few."""
        return self.batches

    def expected(self, batch: Batch) -> Array:
        """Radiance at each point, (N, 3)."""
        radiance = surface_radiance(COLOR, (0.0, 0.0, 0.0), batch.inputs["opacity"])
        return np.broadcast_to(radiance, batch.wo.shape)

    def direct(self, batch: Batch) -> Array:
        """Radiance at each point in the picture, (N, 3)."""
        shader = self.host.compile(self.subject.document(batch.inputs), library=self.library)[0]
        image = self.host.picture(shader, replace(DARK))
        return np.asarray(image[sphere(DARK.size).mask], np.float64)


ABSENT_NODES = (
    AbsentSubject(
        "measured_edf", "measured_edf", node_text("measured_edf", "EDF", "emission") + EMITTER
    ),
)
SURFACE_NODES = (
    SurfaceSubject("surface, an EDF alone", lit=False),
    SurfaceSubject("surface, a BSDF and an EDF", lit=True),
)


@dataclass(frozen=True, eq=False)
class AbsentProbe(NodeProbe):
    """A node that is only asked for."""

    kind: ClassVar[str] = ABSENT
