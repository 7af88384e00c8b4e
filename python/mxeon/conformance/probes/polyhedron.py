# SPDX-License-Identifier: Apache-2.0
"""Probes of renderers that show their own nodes on a polyhedron."""

from dataclasses import replace
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.probes.cases import BLACK
from mxeon.conformance.probes.pictures import PICTURE_INPUTS, PICTURE_SIZE, Mask, Pairs, lit_pairs
from mxeon.conformance.probes.renderer_nodes import ExactProbe
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts, directions
from mxeon.conformance.samples.edge_cases import outside_directions, special_directions
from mxeon.shaders.facets import facet_points
from mxeon.shaders.scene import FURNACE, Scene

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
        """Those above the horizon."""
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
