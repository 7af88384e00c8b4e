# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes that emit light on hosts that make pictures: a sphere in the dark."""

from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.emission import SURFACE_COLOR, EmissionSubject, SurfaceSubject
from mxeon.conformance.probes.emission import NodeProbe
from mxeon.conformance.probes.pictures import Mask
from mxeon.conformance.probes.probe import ValueProbe
from mxeon.conformance.samples.batch import RIM, Array, Batch
from mxeon.models.media.shading import surface_radiance
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

DARK = Scene("dark", size=32)
SMALL = Scene("dark", size=8)
OPACITIES = (0.0, 0.25, 1.0)


class EmissionPictureProbe(NodeProbe, ValueProbe):
    """An EDF node on a sphere in the dark."""

    shown: ClassVar[str] = kinds.EMISSION_PICTURE

    subject: EmissionSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points away from the rim, for each material."""
        wo, mask = _views()
        return tuple(Batch(wo[mask], wo[mask], each, DARK) for each in self.subject.materials)

    def direct(self, batch: Batch) -> Array:
        """Radiance at each point, (N, 3)."""
        image = self.host.picture(self.shader_of(batch.inputs), DARK)
        return np.asarray(image[sphere(DARK.size).mask][_views()[1]], np.float64)


def _views() -> tuple[Array, Mask]:
    """Directions to the viewer at the points of the sphere, and which are away from its rim."""
    points = sphere(DARK.size)
    wo = local_directions(points.normal[points.mask], VIEW)
    return wo, wo[:, 2] >= RIM


class SurfaceEmissionProbe(NodeProbe):
    """A surface on a host that draws it in the dark, one picture for each opacity."""

    subject: SurfaceSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points of the sphere, for each of OPACITIES."""
        points = sphere(SMALL.size)
        wo = local_directions(points.normal[points.mask], VIEW)
        return tuple(Batch(wo, wo, {"opacity": each}, SMALL) for each in OPACITIES)

    def expected(self, batch: Batch) -> Array:
        """Radiance at each point, (N, 3)."""
        radiance = surface_radiance(SURFACE_COLOR, (0.0, 0.0, 0.0), batch.inputs["opacity"])
        return np.broadcast_to(radiance, batch.wo.shape)

    def direct(self, batch: Batch) -> Array:
        """Radiance at each point in the picture, (N, 3)."""
        shader = self.host.compile(self.subject.document(batch.inputs), library=self.library)[0]
        image = self.host.picture(shader, SMALL)
        return np.asarray(image[sphere(SMALL.size).mask], np.float64)
