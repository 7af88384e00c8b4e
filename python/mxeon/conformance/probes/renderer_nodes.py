# SPDX-License-Identifier: Apache-2.0
"""Probes of nodes that a renderer has of its own, by its pictures of a sphere."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.renderer_nodes import RendererNode
from mxeon.conformance.probes.cases import BLACK
from mxeon.conformance.probes.pictures import (
    PICTURE_INPUTS,
    PICTURE_SIZE,
    Mask,
    Pairs,
    PictureProbe,
    lit_pairs,
    scene_of,
)
from mxeon.conformance.results import Claims
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts, Values, directions
from mxeon.conformance.samples.edge_cases import outside_directions, special_directions
from mxeon.hosts.base import RendererHost
from mxeon.models import table as reference
from mxeon.shaders.facets import facet_points
from mxeon.shaders.scene import FURNACE, Scene, sphere

EXACT_INPUTS: tuple[Values, ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.02, 0.05, 0.1), "roughness": 1.0},
    {"color": (1.0, 0.8, 0.0), "roughness": 0.75},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5},
    {"color": (0.5, 0.2, 1.0), "roughness": 0.1},
)


class NativeProbe(PictureProbe):
    """A node that a renderer has of its own, on a sphere."""

    host: RendererHost  # type: ignore[assignment]  # in place of a host of generated shaders
    subject: RendererNode

    @property
    def claims(self) -> Claims:
        """Titles of the model that the node claims, and of the form of it that is judged."""
        claimed, *_ = self.subject.forms or (self.subject.model,)
        title, own = (reference.model(name).title for name in (claimed, self.subject.model))
        return {"claimed": title, "model": own}

    def _picture(self, batch: Batch) -> Array:
        scene, inputs = scene_of(batch), batch.inputs
        image = self.host.node(self.subject.node, inputs["color"], inputs["roughness"], scene)
        return image[self._seen(scene)][self.points(scene)[2]].astype(np.float64)

    def _seen(self, scene: Scene) -> Mask:
        return sphere(scene.size).mask


class ExactProbe(NativeProbe):
    """A node of a renderer's own, on a sphere whose points and light have no error but rounding."""

    shown: ClassVar[str] = kinds.EXACT
    size: ClassVar[int] = PICTURE_SIZE // 2

    @property
    def _inputs(self) -> Sequence[Values]:
        """EXACT_INPUTS, from dark to white and from rough to smooth."""
        return EXACT_INPUTS

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        return self.batches[:: len(EXACT_INPUTS)]

    def nearest_form(self) -> "ExactProbe":
        """The probe of the published form of the model that is nearest to what is measured."""
        if not self.subject.forms:
            return self
        batch = self.batches[0]
        values = self.direct(batch)
        errors = {
            form: float(np.abs(values - batch.expected(form)).max()) for form in self.subject.forms
        }
        nearest = min(errors, key=errors.__getitem__)
        return self.of(replace(self.subject, model=nearest))


SHORTEST = 2.0**-10  # wo + wi of special pairs: Fresnel's formulas square its cosine, and round it


class FacetProbe(ExactProbe):
    """A node of a renderer's own on a polyhedron, with noise under an environment."""

    shown: ClassVar[str] = kinds.FACET
    size: ClassVar[int] = PICTURE_SIZE

    @cached_property
    def cosines(self) -> tuple[Batch, ...]:
        """The points in a white environment, for two of the inputs: they take long."""
        scene = replace(FURNACE, size=self.size)
        names = ("color", "roughness")
        return tuple(
            self._batch(scene, {name: inputs[name] for name in names}) for inputs in PICTURE_INPUTS
        )

    def points(self, scene: Scene) -> Pairs:
        return facet_pairs(scene)

    def _picture(self, batch: Batch) -> Array:
        """Values at the points of a batch, without those of a black lobe where others lie beside it."""
        values = super()._picture(batch)
        if self.subject.others:
            values = values - super()._picture(batch.altered(color=BLACK))
        return values

    def _seen(self, scene: Scene) -> Mask:
        return facet_points(scene.size).mask


class CoarseFacetProbe(FacetProbe):
    """A node on the polyhedron, by a renderer that keeps light in a few bits."""

    shown: ClassVar[str] = kinds.COARSE_FACET


class FacetPairProbe(FacetProbe):
    """A node that its renderer evaluates for any pairs; the polyhedron shows its environment."""

    shown: ClassVar[str] = kinds.FACET_PAIR
    usual: ClassVar[Counts] = Counts(1 << 13)  # a renderer's own function is called for each

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs, a quarter of each direction grazing; special ones; and outside ones."""
        rng, subject, count = np.random.default_rng(SEED), self.subject, self.counts.pairs
        random = directions(rng, count), directions(rng, count)
        special = Batch(*special_directions(rng), {})
        half = np.linalg.norm(special.wo + special.wi, axis=1)
        special = special.where((special.wo[:, 2] > 0.0) & (half >= SHORTEST))
        outside = Batch(*outside_directions(rng), {})
        return (
            Batch(*random, subject.random_inputs(rng, count)),
            special.altered(**subject.special_inputs(rng, len(special.wo))),
            outside.altered(**subject.random_inputs(rng, len(outside.wo))),
        )

    @property
    def few(self) -> tuple[Batch, ...]:
        return self.batches[:2]

    def direct(self, batch: Batch) -> Array:
        count = len(batch.wo)
        color = np.broadcast_to(batch.inputs["color"], (count, 3))
        roughness = np.broadcast_to(batch.inputs["roughness"], count)
        values = self.host.pairs(self.subject.node, batch.wo, batch.wi, color, roughness)
        return np.pi * values.astype(np.float64)

    def density(self, batch: Batch) -> Array:
        roughness = np.broadcast_to(batch.inputs["roughness"], len(batch.wo))
        return self.host.density(batch.wo, batch.wi, roughness).astype(np.float64)

    def sample(self, batch: Batch, u: Array) -> Array:
        roughness = np.broadcast_to(batch.inputs["roughness"], len(batch.wo))
        return self.host.sample(batch.wo, u, roughness).astype(np.float64)


@lru_cache(maxsize=8)
def facet_pairs(scene: Scene) -> Pairs:
    """Those of `mxeon.conformance.probes.pictures.picture_pairs`, of the pixels within a facet."""
    points = facet_points(scene.size)
    return lit_pairs(points.normal[points.mask], scene)
