# SPDX-License-Identifier: Apache-2.0
"""Probes: values and albedos of one node on a host, over batches of pairs.

A host that evaluates takes any pairs, a host that only makes pictures takes the points of a sphere;
both answer in the same form, so a check is written once.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.samples.batch import (FEW, PAIRS, RIM, SEED, Array, Batch, directions, rounded)
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.diffuse import (Subject, Surface)
from mxeon.conformance.samples.edge_cases import (diffuse_edges, node_inputs, outside_directions, special_directions, turned_directions, turned_frames)
from mxeon.shaders.hosts import front_lit_only
from mxeon.shaders.hosts.base import Host
from mxeon.shaders.plane import LIGHTS, plane_pairs
from mxeon.shaders.scene import BACK, FRONT, FURNACE, SIDE, VIEW, Scene, local_directions, sphere

if TYPE_CHECKING:
    from mxeon.shaders.generation import Shader

# Colors and roughnesses of the pictures that stand for a node on hosts that only make pictures.
PICTURE_INPUTS: tuple[dict[str, Any], ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5, "weight": 0.5},
)
PICTURE_SIZE = 128
TURNED = 1 << 12  # pairs in frames of their own

Draw: TypeAlias = Callable[[np.random.Generator, int], dict[str, Array]]
Mask: TypeAlias = NDArray[np.bool_]
Pairs: TypeAlias = tuple[Array, Array, Mask]  # wo, wi, and which of them are judged


@dataclass(frozen=True, eq=False)
class PairProbe:
    """A node on a host that evaluates any pairs."""

    kind: ClassVar[str] = "pairs"

    host: Host
    subject: Subject | BsdfSubject
    library: str

    @cached_property
    def _shader(self) -> Shader:
        return self.host.compile(self.subject.document(), library=self.library)[0]

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """PAIRS random pairs, a quarter of each direction grazing; special ones; and outside ones."""
        rng = np.random.default_rng(SEED)
        pairs = directions(rng, PAIRS), directions(rng, PAIRS)
        return (
            self._batch(rng, pairs, self.subject.random_inputs),
            self._batch(rng, special_directions(rng), self.subject.special_inputs),
            self._batch(rng, outside_directions(rng), self.subject.random_inputs),
        )

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """FEW of the random pairs and the special ones; both directions are above the horizon."""
        pairs, special, _ = self.batches
        return pairs.first(FEW), special

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """Directions for the environment branch, which does not depend on `wi`."""
        return (*self.few, self.batches[-1])

    @cached_property
    def albedos(self) -> tuple[Array, ...]:
        """Directional albedos of `cosines`."""
        return tuple(map(self.subject.albedo, self.cosines))

    @property
    def edges(self) -> Batch:
        """Pairs and inputs at the edges of the domain."""
        return diffuse_edges()

    @cached_property
    def turned(self) -> Batch:
        """TURNED pairs in frames of their own; half of the normals face away from the viewer."""
        rng = np.random.default_rng(SEED)
        frames = turned_frames(rng, TURNED)
        count = len(frames)
        wo, wi = turned_directions(rng, count), turned_directions(rng, count)
        facing = np.where(np.arange(count) % 2, 1.0, -1.0)[:, np.newaxis]
        normal = facing * rounded(frames[:, :, 2].T)
        axes = {"normal": normal, "tangent": rounded(frames[:, :, 0].T)}
        inputs = {**self.subject.random_inputs(rng, count), **axes}
        return Batch(wo, wi, inputs, frame=frames)

    def direct(self, batch: Batch) -> Array:
        """pi f cos(theta_i), (N, 3)."""
        return np.pi * self._evaluate(batch, "direct")

    def albedo(self, batch: Batch, irradiance: Array | None = None) -> Array:
        """Values of the environment branch, (N, 3); the environment is uniform unless given."""
        return self._evaluate(batch, "environment", irradiance=irradiance)

    def throughput(self, batch: Batch, branch: str) -> Array:
        """The share of the light from below that passes the node, in one of BRANCHES, (N, 3)."""
        return self._evaluate(batch, branch, output="throughput")

    def _batch(self, rng: np.random.Generator, pairs: tuple[Array, Array], inputs: Draw) -> Batch:
        """Pairs with random inputs, weights and occlusions."""
        wo, wi = pairs
        return Batch(wo, wi, {**inputs(rng, len(wo)), **node_inputs(rng, len(wo))})

    def _evaluate(self, batch: Batch, branch: str, **options: Any) -> Array:
        inputs = self.subject.with_flag(batch.inputs)
        wo, wi = batch.world(batch.wo), batch.world(batch.wi)
        values = self.host.evaluate(self._shader, wo, wi, inputs, branch, **options)
        return values.astype(np.float64)


@dataclass(frozen=True, eq=False)
class PictureProbe:
    """A node on a host that makes pictures: the lit points of a sphere are its pairs."""

    kind: ClassVar[str] = "pictures"
    scenes: ClassVar[tuple[Scene, ...]] = (SIDE, FRONT, BACK)
    size: ClassVar[int] = PICTURE_SIZE

    host: Host
    subject: Subject | Surface | BsdfSubject
    library: str

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The lit points away from rim and terminator, for each light and PICTURE_INPUTS."""
        batches = (
            self._batch(replace(scene, size=self.size), inputs)
            for scene in self.scenes
            for inputs in self._inputs
        )
        return tuple(batch for batch in batches if len(batch.wo))

    @property
    def few(self) -> tuple[Batch, ...]:
        """The same: they are few."""
        return self.batches

    @cached_property
    def cosines(self) -> tuple[Batch, ...]:
        """The points in a white environment."""
        scene = replace(FURNACE, size=self.size)
        return tuple(self._batch(scene, inputs) for inputs in self._inputs)

    @cached_property
    def albedos(self) -> tuple[Array, ...]:
        """Directional albedos of `cosines`."""
        return tuple(map(self.subject.albedo, self.cosines))

    def direct(self, batch: Batch) -> Array:
        """pi f cos(theta_i), (N, 3)."""
        return self._picture(batch)

    albedo = direct

    @property
    def _inputs(self) -> list[dict[str, Any]]:
        """PICTURE_INPUTS without a weight where the node has none."""
        names = {"color", "roughness", *self.subject.inputs}
        return [
            {name: value for name, value in inputs.items() if name in names}
            for inputs in PICTURE_INPUTS
        ]

    def _batch(self, scene: Scene, inputs: Mapping[str, Any]) -> Batch:
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
        """Values at the points of a batch."""
        scene = scene_of(batch)
        values = self._radiance(self._shader(batch.inputs), scene)
        return values[self.points(scene)[2]].astype(np.float64)

    def _shader(self, inputs: Mapping[str, Any]) -> Shader:
        return _compile(self.host, self.subject.document(inputs), self.library)

    def _radiance(self, shader: Shader, scene: Scene) -> NDArray[Any]:
        """The host's values at all points of a picture."""
        return self.host.picture(shader, scene)[sphere(scene.size).mask]


@dataclass(frozen=True, eq=False)
class PlaneProbe(PictureProbe):
    """A node on a plane: every pixel is another direction of view."""

    kind: ClassVar[str] = "planes"
    scenes: ClassVar[tuple[Scene, ...]] = tuple(
        Scene(f"plane{degrees:.0f}", light=(np.sin(polar), 0.0, np.cos(polar)))
        for degrees in LIGHTS
        for polar in [np.radians(degrees)]
    )

    def points(self, scene: Scene) -> Pairs:
        wo, wi = plane_pairs(scene)
        return wo, wi, self._mask(wo, wi)

    def _radiance(self, shader: Shader, scene: Scene) -> NDArray[Any]:
        return self.host.plane(shader, scene)


@lru_cache(maxsize=8)  # a check makes many pictures of a few documents
def _compile(host: Host, text: str, library: str) -> Shader:
    from mxeon.shaders.generation import ApproximationWarning  # which loads MaterialX

    with warnings.catch_warnings():  # approximations are not judged: see _mask
        warnings.simplefilter("ignore", ApproximationWarning)
        return host.compile(text, library=library)[0]


def scene_of(batch: Batch) -> Scene:
    """The picture of a batch of a probe that makes pictures."""
    assert batch.scene is not None
    return batch.scene


@lru_cache(maxsize=8)
def picture_pairs(scene: Scene) -> Pairs:
    """Directions at the points of the sphere, and the mask of the points to judge.

    Returns
    -------
    wo, wi : ndarray, shape (N, 3)
        One row per pixel on the sphere; wi is wo where there is no distant light.
    mask : ndarray of bool, shape (N,)
        True where both cosines are at least RIM.
    """
    points = sphere(scene.size)
    normal = points.normal[points.mask]
    wo = local_directions(normal, VIEW)
    wi = wo if scene.light is None else local_directions(normal, scene.light)
    return wo, wi, (wo[:, 2] >= RIM) & (wi[:, 2] >= RIM)
