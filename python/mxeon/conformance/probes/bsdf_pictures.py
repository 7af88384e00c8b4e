# SPDX-License-Identifier: Apache-2.0
"""Probes of the other BSDF nodes of pbrlib on hosts that make pictures."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

from mxeon.conformance.nodes.bsdf import MICROFACET_KINDS, BsdfSubject
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.bsdf import BSDF_PROBES
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.pictures import PictureProbe, PlaneProbe
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Batch, Values

SIZE = 64  # of pictures


class BsdfPictureProbe(PictureProbe):
    """A node of pbrlib on a sphere."""

    kind: ClassVar[str] = "bsdf pictures"
    size: ClassVar[int] = SIZE

    subject: BsdfSubject

    @property
    def _inputs(self) -> Sequence[Values]:
        return self.subject.materials


class MicrofacetPictureProbe(BsdfPictureProbe):
    """A node of microfacets on a sphere."""

    kind: ClassVar[str] = "microfacet pictures"


class BsdfPlaneProbe(PlaneProbe):
    """A node of pbrlib on a plane."""

    kind: ClassVar[str] = "bsdf planes"
    size: ClassVar[int] = SIZE

    subject: BsdfSubject

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

    @property
    def _inputs(self) -> Sequence[Values]:
        return self.subject.materials


class MicrofacetPlaneProbe(BsdfPlaneProbe):
    """A node of microfacets on a plane."""

    kind: ClassVar[str] = "microfacet planes"


# By the hosts' own probes: those of a lobe without microfacets, and of one with them.
PICTURES = {
    PictureProbe: (BsdfPictureProbe, MicrofacetPictureProbe),
    PlaneProbe: (BsdfPlaneProbe, MicrofacetPlaneProbe),
}


def bsdf_probe_type(
    subject: Subject, probe: type[Probe]
) -> type[PairProbe] | type[PictureProbe] | None:
    """Class of a subject's probes on a host that has probes of a class; None if it has none."""
    if probe is PairProbe:
        return BSDF_PROBES[subject.kind]
    return PICTURES[probe][subject.kind in MICROFACET_KINDS] if probe in PICTURES else None
