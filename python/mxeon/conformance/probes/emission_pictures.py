# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes that emit light on hosts that make pictures: a sphere in the dark."""

from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes.emission import PICTURES, EmissionSubject
from mxeon.conformance.probes.emission import NodeProbe, implementation
from mxeon.conformance.probes.pictures import Mask
from mxeon.conformance.probes.probe import ValueProbe
from mxeon.conformance.samples.batch import RIM, Array, Batch
from mxeon.errors import NotRun
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

DARK = Scene("dark", size=32)


class EmissionPictureProbe(NodeProbe, ValueProbe):
    """An EDF node on a sphere in the dark."""

    shown: ClassVar[str] = PICTURES

    subject: EmissionSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points away from the rim, for each material."""
        wo, mask = _views()
        return tuple(Batch(wo[mask], wo[mask], each, DARK) for each in self.subject.materials)

    def direct(self, batch: Batch) -> Array:
        """Radiance at each point, (N, 3).

        Raises
        ------
        NotRun
            If the target has no implementation of the node.
        """
        shader = implementation(self.host, self.subject.document(batch.inputs), self.library)
        if shader is None:
            raise NotRun(f"{self.host.target}: no implementation of {self.subject.node}")
        image = self.host.picture(shader, DARK)
        return np.asarray(image[sphere(DARK.size).mask][_views()[1]], np.float64)


def _views() -> tuple[Array, Mask]:
    """Directions to the viewer at the points of the sphere, and which are away from its rim."""
    points = sphere(DARK.size)
    wo = local_directions(points.normal[points.mask], VIEW)
    return wo, wo[:, 2] >= RIM
