# SPDX-License-Identifier: Apache-2.0
"""Backends that measure the built-in nodes of renderers in pictures or for pairs of directions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import ClassVar, Protocol, cast

import numpy as np

from mxeon.conformance import backends, samples
from mxeon.conformance.backends import BACKENDS, Errors
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Mask
from mxeon.conformance.spec import Ability, Spec
from mxeon.conformance.specs.diffuse import PICTURE_INPUTS
from mxeon.conformance.tolerance import Term, mean_error, roundings, sum_in, sum_of
from mxeon.models import table as reference
from mxeon.shaders.scene import FURNACE, Scene, sphere
from mxeon.survey.facets import facet_points
from mxeon.survey.specs import Material, RendererSpec

FACET_PIXELS = 7169  # number of a picture's pixels that each lie within a single facet
FEW_CALLS = samples.Counts(1 << 13)  # number of calls of a renderer's function
SHORTEST = 2.0**-10  # least |wo + wi| of special pairs, since Fresnel formulas square cosines
EXACT_INPUTS: tuple[samples.Values, ...] = (  # dark and bright colors, from rough to smooth
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.02, 0.05, 0.1), "roughness": 1.0},
    {"color": (1.0, 0.8, 0.0), "roughness": 0.75},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5},
    {"color": (0.5, 0.2, 1.0), "roughness": 0.1},
)
# EEVEE stores three channels of light in 32 bits. The blue channel has the fewest bits.
COARSE_FACETS = sum_in(
    Quantity.VALUE_OR_ALBEDO,
    Term(2.0**-6, "five bits below the leading bit, truncated"),
    Term(2.4e-3, "packed normals, measured"),
)
FACET_NOISE = sum_of(
    Term(
        4.0 * 0.0716 / math.sqrt(FACET_PIXELS),
        "four standard errors of the mean of 7169 pixels of 64 paths, rms error 0.0716 each",
    ),
    quantity=Quantity.MEAN_ALBEDO,
    metric=mean_error,
)
# The product of the two factors in Burley's model is at most 25/4.
FACET_PAIRS = sum_in(Quantity.DIFFERENCE, roundings(16 * 2.5**2, "of numbers up to 25/4"))


class Renderer(Protocol):
    """Functions of an engine with built-in nodes. An engine may lack some of these functions."""

    def node(self, material: Material, scene: Scene) -> Array:
        """Render the sphere or the polyhedron with a material; see `Host.picture`."""

    def pairs(
        self, material: Material, wo: Array, wi: Array, color: Array, roughness: Array
    ) -> Array:
        """Values of f cos(theta_i) in 1/sr, (N, 3), for unit vectors, the normal +z and inputs."""

    def sample(self, wo: Array, u: Array, roughness: Array) -> Array:
        """Directions (N, 3) that the renderer draws for EON, given numbers u (N, 2) in [0, 1)."""

    def density(self, wo: Array, wi: Array, roughness: Array) -> Array:
        """Density of the directions that `sample` draws, per solid angle, (N,)."""


class Native(backends.CyclesPictures):
    """A built-in node of a renderer, rendered on a sphere."""

    abilities = Ability.OWN | Ability.LIGHT

    @property
    def renderer(self) -> Renderer:
        return cast(Renderer, self.host)

    @property
    def node(self) -> RendererSpec:
        assert isinstance(self.spec, RendererSpec), f"{self.spec.title} is no renderer's"
        return self.spec

    @property
    def claims(self) -> tuple[str, str]:
        """Titles of the claimed model and of the published form that the checks use."""
        return self.node.claimed, reference.diffuse_model(self.node.model).title

    def image(self, inputs: samples.Values, scene: Scene) -> Array:
        color, roughness = np.asarray(inputs["color"]), float(np.asarray(inputs["roughness"]))
        return self.renderer.node(self.node.made(color.tolist(), roughness), scene)


class Exact(Native):
    """A node rendered on a sphere, if the renderer's points and light are exact up to rounding."""

    engine_errors: ClassVar[Errors] = {
        "value": backends.EXACT,
        "albedo": backends.EXACT_ALBEDO,
        "lambert": backends.EXACT,
    }

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Pictures for a negative control, for which the first material is enough."""
        return self.batches[:: len(EXACT_INPUTS)]

    @property
    def size(self) -> int:
        return backends.PICTURE_SIZE // 2

    @property
    def materials(self) -> Sequence[samples.Values]:
        return EXACT_INPUTS

    def judged(self) -> Spec:
        """The spec of the published form that is nearest to the measured values."""
        if not self.node.forms:
            return self.node
        batch = self.batches[0]
        values = self.direct(batch)
        errors = {
            form: float(np.abs(values - form.value(batch)).max())
            for form in (self.node.of_model(each) for each in self.node.forms)
        }
        return min(errors, key=errors.__getitem__)


class Facets(Exact):
    """A node rendered on the polyhedron. Pictures under an environment have noise."""

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        """Points in a white environment, with only two materials to save time."""
        scene = replace(FURNACE, size=self.size)
        names = ("color", "roughness")
        return tuple(
            self.batch(scene, {name: inputs[name] for name in names}) for inputs in PICTURE_INPUTS
        )

    @property
    def size(self) -> int:
        return backends.PICTURE_SIZE

    def points(self, scene: Scene) -> backends.Pairs:
        return facet_pairs(scene)

    def pixels(self, scene: Scene) -> Mask:
        return facet_points(scene.size).mask


class CoarseFacets(Facets):
    """A node rendered on the polyhedron by a renderer that stores light in few bits."""

    engine_errors: ClassVar[Errors] = {"value": COARSE_FACETS, "albedo": COARSE_FACETS}


class FacetPairs(Facets):
    """A node that is evaluated for any pair of directions. Only environments need pictures."""

    engine_errors: ClassVar[Errors] = {
        "value": FACET_PAIRS,
        "albedo": FACET_NOISE,
        "reciprocity": FACET_PAIRS,
    }

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs, special pairs, and pairs outside the domain."""
        rng, spec, count = samples.generator(), self.node, FEW_CALLS.pairs
        random = samples.directions(rng, count), samples.directions(rng, count)
        special = Batch(*samples.special_directions(rng), {})
        half = np.linalg.norm(special.wo + special.wi, axis=1)
        special = special.where((special.wo[:, 2] > 0.0) & (half >= SHORTEST))
        outside = Batch(*samples.outside_directions(rng), {})
        return (
            Batch(*random, spec.random_inputs(rng, count)),
            special.altered(**spec.random_inputs(rng, len(special.wo), edged=True)),
            outside.altered(**spec.random_inputs(rng, len(outside.wo))),
        )

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        return self.batches[:2]

    def portrait(self, scene: Scene) -> tuple[Array, Array, Mask, Mask]:
        return *backends.Backend.points(self, scene), sphere(scene.size).mask

    def direct(self, batch: Batch) -> Array:
        count = len(batch.wo)
        color = np.broadcast_to(batch.inputs["color"], (count, 3))
        roughness = np.broadcast_to(batch.inputs["roughness"], count)
        values = self.renderer.pairs(self.node.material, batch.wo, batch.wi, color, roughness)
        return np.pi * values.astype(np.float64)


@lru_cache(maxsize=8)
def facet_pairs(scene: Scene) -> backends.Pairs:
    """Pairs of directions at the pixels that lie within one facet of the polyhedron."""
    points = facet_points(scene.size)
    return backends.lit_pairs(points.normal[points.mask], scene)


BACKENDS |= {
    "native": (Native,),
    "exact": (Exact,),
    "coarse facets": (CoarseFacets,),
    "facet pairs": (FacetPairs,),
}
