# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes on hosts that draw a document on a mesh, in which every pixel is an exact point."""

from collections.abc import Mapping
from typing import ClassVar

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.diffuse import DiffuseLobe
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.bsdf_pictures import BsdfPictureProbe
from mxeon.conformance.probes.diffuse_lobes import DiffuseLobeProbe
from mxeon.conformance.probes.pictures import Pairs, PictureProbe
from mxeon.conformance.samples.batch import RIM, Changes, Values
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene

LATER_INPUTS = ("retroreflective",)  # than MaterialX 1.39.3, which Storm has


class DrawnProbe(PictureProbe):
    """A node on a sphere whose points and light have no error but rounding."""

    # Word for that of the host's pixels, with which its kinds of probes begin.
    precision: ClassVar[str] = "drawn"

    @classmethod
    def kind_of(cls, subject: Subject) -> str:
        return kinds.drawn_kind(cls.precision, subject.kind)


class HalfProbe(DrawnProbe):
    """The same on a host that keeps colors as half floats."""

    precision: ClassVar[str] = "half"


class DrawnBsdfProbe(DrawnProbe, BsdfPictureProbe):
    """A node of pbrlib on such a sphere, lit from below where it transmits."""

    subject: BsdfSubject

    def points(self, scene: Scene) -> Pairs:
        wo, wi, mask = super().points(scene)
        if self.subject.row.transmits and scene.light is not None:
            mask = (wo[:, 2] >= RIM) & (wi[:, 2] <= -RIM)
        return wo, wi, mask


class HalfBsdfProbe(HalfProbe, DrawnBsdfProbe):
    """The same in half floats."""

    @property
    def changes(self) -> Mapping[str, Changes]:
        """Those of the inputs that Storm's MaterialX has."""
        changes = super().changes
        return {name: changes[name] for name in changes if name not in LATER_INPUTS}


class DrawnLobeProbe(DrawnProbe, DiffuseLobeProbe):
    """The diffuse lobe of a surface shader on such a sphere."""

    subject: DiffuseLobe

    def _shader(self, inputs: Values) -> Shader:
        """A shader for each inputs: the host reads them from its document."""
        return PictureProbe._shader(self, inputs)


class HalfLobeProbe(HalfProbe, DrawnLobeProbe):
    """The same in half floats."""
