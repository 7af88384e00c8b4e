# SPDX-License-Identifier: Apache-2.0
"""Probes of a node on hosts that make pictures: the lit points of a sphere are its pairs."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.subject import LobeSubject
from mxeon.conformance.probes.probe import LobeProbe
from mxeon.conformance.samples.batch import RIM, Array, Batch, Values
from mxeon.hosts import front_lit_only
from mxeon.hosts.base import Host
from mxeon.shaders.scene import BACK, FRONT, FURNACE, SIDE, VIEW, Scene, local_directions, sphere

if TYPE_CHECKING:
    from mxeon.shaders.generation import Shader


from collections.abc import Mapping
from typing import cast

from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.diffuse import DiffuseLobe
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.samples.batch import LOBE_RIM, Changes
from mxeon.shaders.document.values import Plain
from mxeon.shaders.generation import Shader

# Colors and roughnesses of the pictures that stand for a node on hosts that only make pictures.
PICTURE_INPUTS: tuple[Values, ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5, "weight": 0.5},
)


PICTURE_SIZE = 128
Mask: TypeAlias = NDArray[np.bool_]
Pairs: TypeAlias = tuple[Array, Array, Mask]  # wo, wi, and which of them are judged


class PictureProbe(LobeProbe):
    """A node on a host that makes pictures: the lit points of a sphere are its pairs."""

    shown: ClassVar[str] = kinds.PICTURE
    scenes: ClassVar[tuple[Scene, ...]] = (SIDE, FRONT, BACK)
    size: ClassVar[int] = PICTURE_SIZE

    subject: LobeSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The lit points away from rim and terminator, for each light and PICTURE_INPUTS."""
        batches = (
            self._batch(replace(scene, size=self.size), inputs)
            for scene in self.scenes
            for inputs in self._inputs
        )
        return tuple(batch for batch in batches if len(batch.wo))

    @cached_property
    def cosines(self) -> tuple[Batch, ...]:
        """The points in a white environment."""
        scene = replace(FURNACE, size=self.size)
        return tuple(self._batch(scene, inputs) for inputs in self._inputs)

    def direct(self, batch: Batch) -> Array:
        return self._picture(batch)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Values in an environment, (N, 3), which is the batch's own."""
        return self._picture(batch)

    @property
    def _inputs(self) -> Sequence[Values]:
        names = {"color", "roughness", *self.subject.inputs}
        return [
            {name: value for name, value in inputs.items() if name in names}
            for inputs in PICTURE_INPUTS
        ]

    def _batch(self, scene: Scene, inputs: Values) -> Batch:
        wo, wi, mask = self.points(scene)
        return Batch(wo[mask], wi[mask], inputs, scene)

    def points(self, scene: Scene) -> Pairs:
        """Directions at the points of a picture, and the mask of the points to judge."""
        wo, wi, mask = picture_pairs(scene)
        return wo, wi, mask & self._mask(wo, wi)

    def _mask(self, wo: Array, wi: Array) -> Mask:
        """Mask of the pairs for which the host has a closure that can be the model."""
        if not front_lit_only(self.host.name, self.subject.model):
            return np.ones(len(wo), dtype=bool)
        return wo[:, 0] * wi[:, 0] + wo[:, 1] * wi[:, 1] >= 0.0

    def _picture(self, batch: Batch) -> Array:
        scene = scene_of(batch)
        values = self.host.picture(self._shader(batch.inputs), scene)[sphere(scene.size).mask]
        return values[self.points(scene)[2]].astype(np.float64)

    def _shader(self, inputs: Values) -> Shader:
        return _compile(self.host, self.subject.document(inputs), self.library)


@lru_cache(maxsize=8)  # a check makes many pictures of a few documents
def _compile(host: Host, text: str, library: str) -> Shader:
    from mxeon.shaders.generation import ApproximationWarning  # which loads MaterialX

    with warnings.catch_warnings():  # approximations are not judged: see _mask
        warnings.simplefilter("ignore", ApproximationWarning)
        return host.compile(text, library=library)[0]


def scene_of(batch: Batch) -> Scene:
    assert batch.scene is not None
    return batch.scene


@lru_cache(maxsize=8)
def picture_pairs(scene: Scene) -> Pairs:
    """Directions at the points of the sphere, and the mask of the points to judge."""
    points = sphere(scene.size)
    return lit_pairs(points.normal[points.mask], scene)


def lit_pairs(normal: Array, scene: Scene) -> Pairs:
    """Directions at points with normals in a picture, and the mask of the points to judge."""
    wo = local_directions(normal, VIEW)
    wi = wo if scene.light is None else local_directions(normal, scene.light)
    return wo, wi, (wo[:, 2] >= RIM) & (wi[:, 2] >= RIM)


SIZE = 64  # of pictures


class BsdfPictureProbe(PictureProbe):
    """A node of pbrlib on a sphere."""

    shown: ClassVar[str] = kinds.BSDF_PICTURE
    size: ClassVar[int] = SIZE

    subject: BsdfSubject

    @property
    def _inputs(self) -> Sequence[Values]:
        return self.subject.materials


class DiffuseLobeProbe(PictureProbe):
    """The diffuse lobe of a surface shader, told apart from what lies over it.

    A black lobe leaves the other lobes, and a white one at roughness 0, which is Lambert in every
    model, shows how much of the light reaches the lobe and comes back.
    """

    shown: ClassVar[str] = kinds.LOBE
    size: ClassVar[int] = PICTURE_SIZE // 4  # the shaders are long

    subject: DiffuseLobe

    def _mask(self, wo: Array, wi: Array) -> Mask:
        """Mask of the pairs far from the rim, where an error in position is divided twice."""
        mask: Mask = np.minimum(wo[:, 2], wi[:, 2]) >= LOBE_RIM
        return mask

    def _picture(self, batch: Batch) -> Array:
        picture = super()._picture
        others = picture(batch.altered(color=(0.0, 0.0, 0.0)))
        lambert = picture(batch.altered(color=(1.0, 1.0, 1.0), roughness=0.0)) - others
        return (picture(batch) - others) / lambert * batch.wi[:, 2:]

    def _shader(self, inputs: Values) -> Shader:
        """One shader for all inputs: long as it is, it is compiled once."""
        shader = super()._shader(PICTURE_INPUTS[0])
        values = {self.subject.color: inputs["color"], self.subject.roughness: inputs["roughness"]}
        ports = (
            replace(port, value=cast(Plain, values.get(port.path.rsplit("/", 1)[-1], port.value)))
            for port in shader.inputs
        )
        return replace(shader, inputs=tuple(ports))


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
