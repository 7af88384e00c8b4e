# SPDX-License-Identifier: Apache-2.0
"""Probes of the other BSDF nodes of pbrlib on hosts that make pictures."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

from mxeon.conformance.nodes.bsdf import MICROFACET_KINDS, BsdfSubject
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.bsdf import BSDF_PROBES
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.pictures import PictureProbe, PlaneProbe
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Batch

# Values of the inputs that a node has, of the two materials that stand for it.
MATERIALS: tuple[Mapping[str, Any], ...] = (
    {
        "color": (0.2, 0.5, 0.8),
        "tint": (0.2, 0.5, 0.8),
        "color0": (0.1, 0.4, 0.9),
        "color82": (0.5, 0.7, 0.8),
        "color90": (0.9, 0.8, 0.6),
        "exponent": 5.0,
        "extinction": (3.9, 2.5, 1.8),
    },
    {
        "color": (0.8, 0.4, 0.1),
        "tint": (0.9, 0.6, 0.3),
        "color0": (0.8, 0.5, 0.2),
        "color82": (1.0, 1.0, 1.0),
        "color90": (1.0, 1.0, 1.0),
        "exponent": 3.0,
        "extinction": (0.5, 1.0, 4.0),
        "weight": 0.5,
    },
)
SIZE = 64  # of pictures
ROUGHNESSES = (0.8, 0.4)  # of both
INDICES = (1.5, 1.2)
METALS = ((0.2, 0.9, 1.1), (1.5, 0.6, 2.0))


class BsdfPictureProbe(PictureProbe):
    """A node of pbrlib on a sphere."""

    kind: ClassVar[str] = "bsdf pictures"
    size: ClassVar[int] = SIZE

    subject: BsdfSubject

    @property
    def _inputs(self) -> list[dict[str, Any]]:
        return materials(self.subject)


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
    def _inputs(self) -> list[dict[str, Any]]:
        return materials(self.subject)


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


def materials(subject: BsdfSubject) -> list[dict[str, Any]]:
    """Inputs of the materials that stand for a subject."""
    names = {"weight", *subject.row.inputs}
    materials = []
    for colors, roughness, index, metal in zip(
        MATERIALS, ROUGHNESSES, INDICES, METALS, strict=True
    ):
        alpha = (roughness, roughness) if subject.anisotropic else roughness
        ior = metal if "extinction" in names else index
        inputs = {**colors, "roughness": alpha, "ior": ior}
        materials.append({name: value for name, value in inputs.items() if name in names})
    return materials
