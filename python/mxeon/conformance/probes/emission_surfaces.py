# SPDX-License-Identifier: Apache-2.0
"""Probes of the node `surface` with an emission, and of nodes that no target has."""

from dataclasses import replace
from functools import cached_property

import numpy as np

from mxeon.conformance.nodes.emission_surfaces import COLOR, SurfaceSubject
from mxeon.conformance.probes.emission import NodeProbe
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.models.media.shading import surface_radiance
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

DARK = Scene("dark", size=8)
OPACITIES = (0.0, 0.25, 1.0)


class SurfaceEmissionProbe(NodeProbe):
    """A surface on a host that draws it in the dark, one picture for each opacity."""

    subject: SurfaceSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points of the sphere, for each of OPACITIES."""
        points = sphere(DARK.size)
        wo = local_directions(points.normal[points.mask], VIEW)
        return tuple(Batch(wo, wo, {"opacity": each}, DARK) for each in OPACITIES)

    def expected(self, batch: Batch) -> Array:
        """Radiance at each point, (N, 3)."""
        radiance = surface_radiance(COLOR, (0.0, 0.0, 0.0), batch.inputs["opacity"])
        return np.broadcast_to(radiance, batch.wo.shape)

    def direct(self, batch: Batch) -> Array:
        """Radiance at each point in the picture, (N, 3)."""
        shader = self.host.compile(self.subject.document(batch.inputs), library=self.library)[0]
        image = self.host.picture(shader, replace(DARK))
        return np.asarray(image[sphere(DARK.size).mask], np.float64)
