# SPDX-License-Identifier: Apache-2.0
"""Probes of pbrlib's BSDF nodes, with the pairs and the quadratures that they need."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.transmission import TransmissionSubject
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts, directions, rounded
from mxeon.conformance.samples.edge_cases import LEAST_COLOR82, LEAST_TURNED, special_directions
from mxeon.models.sampling.visible_normals import ggx_pdf, ggx_sample

FIT_COSINE = 1e-4  # least cosine of the domain of the fits
LEAST_STRETCHED = 0.05  # alpha and cosine of anisotropic albedos: a sum over directions is coarse
LEAST_VIEW = 0.02  # cosine of their views
LEAST_INVERTED = 0.1  # index of a dielectric of which the inverse is taken
LEAST_INDEX = 1.05  # above 1, to which shaders fit their averages: tools/fits/ggx_cosine.py


class BsdfProbe(PairProbe):
    """A node of pbrlib on a host that evaluates any pairs."""

    usual: ClassVar[Counts] = Counts(pairs=1 << 12, few=1 << 10, diagnosed=1 << 11)
    least_cosine: ClassVar[float] = 0.0  # of a view whose albedo is asked

    subject: BsdfSubject

    @property
    def cosines(self) -> tuple[Batch, ...]:
        pairs, special, *_ = self.batches
        return tuple(
            batch.where(batch.wo[:, 2] >= self.least_cosine).first(self.counts.albedos)
            for batch in (pairs, special)
        )

    @cached_property
    def edges(self) -> Batch:
        """Exact directions and inputs on their edges, roughness and index 0 among them."""
        rng = np.random.default_rng(SEED)
        wo, wi = self._lit(special_directions(rng))
        inputs = self.subject.special_inputs(rng, len(wo))
        for name, start, step in (("roughness", 0, 4), ("ior", 0, 3), ("extinction", 1, 6)):
            if name in inputs:
                inputs[name][start::step] = 0.0
        return Batch(wo, wi, inputs)

    @cached_property
    def turned(self) -> Batch:
        """Pairs in frames of their own, with the light on the side of the node's."""
        batch = super().turned
        return replace(batch, wi=batch.wi * [1.0, 1.0, self._side])

    @cached_property
    def integrated(self) -> tuple[Batch, Array]:
        """Materials, each in nodes^2 directions of light, and the weights of their values.

        The weighted sum of pi f cos over a material's directions is its directional albedo.
        """
        rng, count = np.random.default_rng(SEED), self.counts.materials
        mu = LEAST_VIEW + (1.0 - LEAST_VIEW) * rng.random(count)
        radius, azimuth = np.sqrt(1.0 - mu * mu), 2.0 * np.pi * rng.random(count)
        wo = rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])
        inputs = self._integrable(self.subject.random_inputs(rng, count))
        wi, weights = self._nodes(wo, inputs)
        each = np.repeat(np.arange(count), wi.shape[1])
        spread = {name: values[each] for name, values in inputs.items()}
        return Batch(wo[each], wi.reshape(-1, 3), spread), weights

    @cached_property
    def integrals(self) -> Array:
        batch, weights = self.integrated
        return self.subject.integral(batch.where(np.arange(len(weights)) * weights.shape[1]))

    def _lit(self, pairs: tuple[Array, Array]) -> tuple[Array, Array]:
        wo, wi = pairs
        return wo, wi * [1.0, 1.0, self._side]

    @property
    def _side(self) -> float:
        return -1.0 if self.subject.row.transmits else 1.0

    def _integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        return inputs

    def _nodes(self, wo: Array, inputs: dict[str, Array]) -> tuple[Array, Array]:
        """Directions (M, K, 3) and weights (M, K) of a quadrature over each view's hemisphere."""
        # Gauss nodes, moved to the horizon and to the normal, and even azimuths.
        count = self.counts.nodes
        x, w = np.polynomial.legendre.leggauss(count)
        t = 0.5 * (x + 1.0)
        mu = t * t * (3.0 - 2.0 * t)  # dense at the horizon and around the normal
        slope = 6.0 * t * (1.0 - t) * 0.5 * w
        azimuth = np.arctan2(wo[:, 1], wo[:, 0])[:, np.newaxis, np.newaxis]
        phi = azimuth + 2.0 * np.pi * (np.arange(count) + 0.5) / count
        radius = np.sqrt(1.0 - mu * mu)[:, np.newaxis]
        columns = (
            radius * np.cos(phi),
            radius * np.sin(phi),
            self._side * mu[:, np.newaxis] + 0.0 * phi,
        )
        wi = rounded(columns).reshape(len(wo), -1, 3)
        weights = np.repeat(slope * 2.0 / count, count)
        return wi, np.broadcast_to(weights, wi.shape[:2])


class FittedProbe(BsdfProbe):
    """A sheen whose albedo a shader takes from a fit."""

    least_cosine: ClassVar[float] = FIT_COSINE


class MicrofacetProbe(BsdfProbe):
    """A node of microfacets, whose values are large near the mirror direction."""

    usual: ClassVar[Counts] = replace(BsdfProbe.usual, diagnosed=1 << 8)  # references take long
    least_cosine: ClassVar[float] = FIT_COSINE

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        return self._evaluate(batch, "transmission", irradiance=radiance)

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Those of any node, and pairs near the mirror direction."""
        return (*super().batches, self.mirrored[0])

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Few of the random pairs, the special ones, and few near the mirror direction."""
        return (*super().few, self.mirrored[0].first(self.counts.few))

    @property
    def cosines(self) -> tuple[Batch, ...]:
        return tuple(replace(batch, inputs=simple(batch.inputs)) for batch in super().cosines)

    @cached_property
    def stretched(self) -> tuple[Batch, Array]:
        """Views of materials whose roughness has a direction, and the integrals of their values."""
        rng, count = np.random.default_rng(SEED), self.counts.materials
        inputs = simple(self.subject.random_inputs(rng, count))
        inputs["roughness"] = rounded(LEAST_STRETCHED ** rng.random((2, count)))
        batch = Batch(directions(rng, count), directions(rng, count), inputs)
        batch = batch.where(batch.wo[:, 2] >= LEAST_STRETCHED)
        return batch, self.subject.integral(batch)

    @cached_property
    def turned(self) -> Batch:
        """Pairs in frames of their own, none with a sharp lobe, whose place would be uncertain.

        Dielectrics are denser than air: at a critical angle their curve has an infinite slope.
        """
        batch = super().turned
        changes = {"roughness": np.maximum(batch.inputs["roughness"], LEAST_TURNED)}
        if "tint" in batch.inputs:
            index = np.maximum(batch.inputs["ior"], LEAST_INVERTED)
            changes["ior"] = np.maximum(index, 1.0 / index)
        return batch.altered(**changes)

    @cached_property
    def mirrored(self) -> tuple[Batch, Batch]:
        """Two lights near the mirror direction of each view, by normals that the view sees."""
        rng, count = np.random.default_rng(SEED), self.counts.mirrored
        wo, inputs = directions(rng, count), self.subject.random_inputs(rng, count)
        first, second = (
            reflected(wo, inputs["roughness"], rng.random(count), rng.random(count))
            for _ in range(2)
        )
        above = (np.minimum(first[:, 2], second[:, 2]) > 0.0) & (wo[:, 2] > 0.0)
        pair = Batch(wo, first, inputs).where(above), Batch(wo, second, inputs).where(above)
        return pair

    def _integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        return simple(inputs)

    def _nodes(self, wo: Array, inputs: dict[str, Array]) -> tuple[Array, Array]:
        """Directions and weights of a quadrature over the normals that each view sees."""
        # Gauss nodes of the height of visible normals, and even azimuths.
        nodes = self.counts.nodes
        x, w = np.polynomial.legendre.leggauss(nodes)
        height, around = np.meshgrid(0.5 * (x + 1.0), (np.arange(nodes) + 0.5) / nodes)
        count = height.size
        views, alpha = (np.repeat(each, count, axis=0) for each in (wo, inputs["roughness"]))
        u = np.tile(height.ravel(), len(wo)), np.tile(around.ravel(), len(wo))
        wi = reflected(views, alpha, *u)
        lit = wi[:, 2] > 0.0
        wi[~lit] = (0.0, 0.0, 1.0)
        density = np.where(lit, ggx_pdf(views, wi, alpha), np.inf)
        weights = np.tile(np.meshgrid(0.5 * w, np.ones(nodes))[0].ravel() / nodes, len(wo))
        return wi.reshape(len(wo), count, 3), (weights / (np.pi * density)).reshape(len(wo), count)


def simple(inputs: Mapping[str, Array]) -> dict[str, Array]:
    """Inputs whose albedo is that of the lobe and can be integrated.

    The roughness is the same in both directions. The index of a dielectric is 1, where nothing is
    reflected, or LEAST_INDEX and more: the fits of shaders begin there (docs/loading.md says how far off
    they are between), and nodes^2 directions do not resolve a critical angle. Deep dips at 82 degrees,
    which turn F negative, are left out.
    """
    changed = dict(inputs)
    changed["roughness"] = np.repeat(inputs["roughness"][:, :1], 2, axis=1)
    if np.ndim(inputs.get("ior", ())) == 1 and np.size(inputs.get("ior", ())):
        index = np.asarray(inputs["ior"])
        changed["ior"] = np.where(index > 1.0, np.maximum(index, LEAST_INDEX), 1.0)
    if "color82" in inputs:
        changed["color82"] = np.maximum(inputs["color82"], LEAST_COLOR82)
    return changed


def reflected(wo: Array, alpha: Array, height: Array, around: Array) -> Array:
    """Mirror images of views about normals that they see, float32 numbers, (N, 3)."""
    return rounded(ggx_sample(wo, np.stack([height, around], axis=-1), alpha)[0].T)


class CombinedProbe(BsdfProbe):
    """A node that combines two lobes, whose weights stay 1."""

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs and special ones; those outside are asked of the lobes."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        wo, wi = directions(rng, count), directions(rng, count)
        special = special_directions(rng)
        return (
            Batch(wo, wi, self.subject.random_inputs(rng, count)),
            Batch(*special, self.subject.random_inputs(rng, len(special[0]))),
        )


class TransmissionProbe(MicrofacetProbe):
    """A node that transmits, on a host that evaluates any pairs."""

    subject: TransmissionSubject

    @cached_property
    def reflection(self) -> MicrofacetProbe:
        return MicrofacetProbe(self.host, self.subject.reflection, self.library, self.counts)
