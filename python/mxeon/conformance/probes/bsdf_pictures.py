# SPDX-License-Identifier: Apache-2.0
"""Probes of the other BSDF nodes of pbrlib on hosts that make pictures."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.probes.pictures import PictureProbe, PlaneProbe
from mxeon.conformance.samples.batch import Batch, Values

SIZE = 64  # of pictures


class BsdfPictureProbe(PictureProbe):
    """A node of pbrlib on a sphere."""

    shown: ClassVar[str] = "bsdf pictures"
    size: ClassVar[int] = SIZE

    subject: BsdfSubject

    @property
    def _inputs(self) -> Sequence[Values]:
        return self.subject.materials


class BsdfPlaneProbe(BsdfPictureProbe, PlaneProbe):
    """A node of pbrlib on a plane."""

    shown: ClassVar[str] = "bsdf planes"

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points of the plane; of a node that transmits, with the light below it."""
        if not self.subject.row.transmits:
            return super().batches
        lights = [(scene, scene.light) for scene in self.scenes if scene.light]
        return tuple(
            self._batch(replace(scene, size=self.size, light=(x, y, -z)), inputs)
            for scene, (x, y, z) in lights
            for inputs in self._inputs
        )
