# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes that emit light on hosts that make pictures: a sphere in the dark."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from mxeon.conformance.nodes.emission import PICTURES, EmissionSubject
from mxeon.conformance.probes.emission import NodeProbe, implementation
from mxeon.conformance.probes.probe import ValueProbe
from mxeon.conformance.samples.batch import RIM, Array, Batch
from mxeon.errors import NotRun
from mxeon.models.pbrlib.emissions import AMOUNT, BASE, FACTOR, FIRST, SECOND
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

DARK = Scene("dark", size=32)
# Values of the inputs that a node has, of the two materials that stand for it. The falloff takes half
# of the sphere, so that it is not steep.
MATERIALS: tuple[Mapping[str, Any], ...] = (
    {
        **dict.fromkeys(("color", BASE, FIRST), (0.2, 0.5, 0.8)),
        SECOND: (0.9, 0.1, 0.3),
        AMOUNT: 0.25,
        FACTOR: (0.9, 0.6, 0.3),
        "color0": (0.1, 0.4, 0.9),
        "color90": (0.9, 0.8, 0.6),
        "exponent": 5.0,
        "inner_angle": 60.0,
        "outer_angle": 140.0,
    },
    {
        **dict.fromkeys(("color", BASE, FIRST), (2.0, 0.4, 0.1)),
        SECOND: (0.1, 0.2, 0.3),
        AMOUNT: 0.75,
        FACTOR: (0.5, 0.5, 0.5),
        "color0": (0.8, 0.5, 0.2),
        "color90": (1.0, 1.0, 1.0),
        "exponent": 2.0,
        "inner_angle": 0.0,
        "outer_angle": 150.0,
    },
)


class EmissionPictureProbe(NodeProbe, ValueProbe):
    """An EDF node on a sphere in the dark."""

    kind: ClassVar[str] = PICTURES

    subject: EmissionSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points away from the rim, for each of MATERIALS."""
        wo, mask = _views()
        return tuple(Batch(wo[mask], wo[mask], self._inputs(each), DARK) for each in MATERIALS)

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

    def _inputs(self, material: Mapping[str, Any]) -> dict[str, Any]:
        values = {name: material[name] for name in self.subject.row.inputs}
        if self.subject.row.name == "emission_multiply_float":
            values[FACTOR] = material[FACTOR][0]
        return values


def _views() -> tuple[Array, Any]:
    """Directions to the viewer at the points of the sphere, and which are away from its rim."""
    points = sphere(DARK.size)
    wo = local_directions(points.normal[points.mask], VIEW)
    return wo, wo[:, 2] >= RIM
