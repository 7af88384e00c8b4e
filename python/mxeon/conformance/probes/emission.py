# SPDX-License-Identifier: Apache-2.0
"""Probes of the EDF nodes: views of an emitting surface, from the front and from the back."""

from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.emission import SURFACE_COLOR, EmissionSubject, SurfaceSubject
from mxeon.conformance.nodes.media import MediumSubject
from mxeon.conformance.probes.pictures import Mask
from mxeon.conformance.probes.probe import Probe, ValueProbe
from mxeon.conformance.samples.batch import (
    RIM,
    SEED,
    Array,
    Batch,
    Counts,
    Values,
    directions,
    float32,
    rounded,
)
from mxeon.conformance.samples.edge_cases import GRID, turned_directions, turned_frames
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts.base import Host
from mxeon.models.media.emission import cone_cosine, cone_width
from mxeon.models.media.shading import surface_radiance
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

EDGE = 1e-3  # cosine from a hard edge: within it the engine's own cosine decides
CONES = ("inner", "outer")
NO_IMPLEMENTATION = "Could not find a matching implementation"


def implementation(host: Host, text: str, library: str) -> Shader | None:
    """Shader of a document; None where the target has no implementation of one of its nodes."""
    try:
        return host.compile(text, library=library)[0]
    except DocumentError as error:
        if NO_IMPLEMENTATION not in str(error):
            raise
        return None


class NodeProbe(Probe):
    """A node of which a host is asked whether it has it."""

    def missing(self, text: str) -> bool:
        return implementation(self.host, text, self.library) is None

    @cached_property
    def shader(self) -> Shader:
        return self.shader_of({})

    def shader_of(self, inputs: Values) -> Shader:
        """Shader of the subject's document with some inputs.

        Raise NotRun if the target has no implementation of the node.
        """
        shader = implementation(self.host, self.subject.document(inputs), self.library)
        if shader is None:
            raise NotRun(f"{self.host.target}: no implementation of {self.subject.node}")
        return shader


class EmissionProbe(NodeProbe, ValueProbe):
    """An EDF node on a host that evaluates its radiance for any view."""

    usual: ClassVar[Counts] = Counts(1 << 12, 1 << 10, materials=128, nodes=16)

    subject: EmissionSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random views from the front, and cosines from 1 to grazing."""
        rng = np.random.default_rng(SEED)
        mu = np.repeat(GRID, 64)
        radius = np.sqrt(1.0 - mu * mu)
        special = rounded([radius, 0.0 * mu, mu])
        return (self._views(rng, directions(rng, self.counts.pairs)), self._views(rng, special))

    @property
    def few(self) -> tuple[Batch, ...]:
        return (self.batches[0].first(self.counts.few),)

    @cached_property
    def backs(self) -> Batch:
        rng = np.random.default_rng(SEED)
        return self._views(rng, directions(rng, self.counts.few) * [1.0, 1.0, -1.0])

    @cached_property
    def integrated(self) -> tuple[Batch, Array]:
        """Emissions at the nodes of a quadrature, and weights of their radiance.

        The weighted sum over the views of a material is its exitance over pi.
        """
        rng, count = np.random.default_rng(SEED), self.counts.materials
        inputs = self.subject.random_inputs(rng, count)
        mu, weights = _nodes(self._stops(inputs), self.counts.nodes)
        azimuth = 2.0 * np.pi * rng.random(mu.shape)
        radius = np.sqrt(1.0 - mu * mu)
        wo = rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu]).reshape(-1, 3)
        each = np.repeat(np.arange(count), mu.shape[1])
        return Batch(wo, wo, {name: value[each] for name, value in inputs.items()}), weights

    def direct(self, batch: Batch) -> Array:
        wo = batch.world(batch.wo)
        evaluate = self.host.evaluate
        values = evaluate(self.shader, wo, wo, batch.inputs, "emission", output="radiance")
        return np.asarray(values, np.float64)

    def _views(self, rng: np.random.Generator, wo: Array) -> Batch:
        return Batch(wo, wo, self.subject.random_inputs(rng, len(wo)))

    def _stops(self, inputs: dict[str, Array]) -> Array:
        """Cosines between which the radiance is smooth, (M, 1 + pieces)."""
        return np.broadcast_to([0.0, 1.0], (self.counts.materials, 2))


class ConeProbe(EmissionProbe):
    """An emission inside a cone, whose axis is an input."""

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Those of any emission; views near both edges; and views of turned axes."""
        rng = np.random.default_rng(SEED)
        return (*super().batches, self._at_edges(rng), self._turned(rng))

    def condition(self, batch: Batch) -> Array:
        """1 and the slope of the falloff in the cosine, (N, 1)."""
        inner, outer = (batch.inputs[f"{name}_angle"] for name in CONES)
        width = np.where(outer > inner, cone_width(inner, outer), np.inf)
        t = np.clip((np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(outer)) / width, 0.0, 1.0)
        return np.asarray(1.0 + 6.0 * t * (1.0 - t) / width)[:, np.newaxis]

    def _views(self, rng: np.random.Generator, wo: Array) -> Batch:
        return _away(super()._views(rng, wo))

    def _at_edges(self, rng: np.random.Generator) -> Batch:
        """Views a little inside and outside of the cones."""
        count = self.counts.few
        inputs = self.subject.random_inputs(rng, count)
        angle = np.where(np.arange(count) % 2, inputs["inner_angle"], inputs["outer_angle"])
        step = np.where(rng.random(count) < 0.5, -2.0, 2.0) * EDGE
        mu = np.clip(cone_cosine(angle) + step, 0.0, 1.0)
        wo = rounded([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu])
        return _away(Batch(wo, wo, inputs))

    def _turned(self, rng: np.random.Generator) -> Batch:
        """Views in frames whose normals are the axes."""
        frames = turned_frames(rng, self.counts.few)
        wo = turned_directions(rng, len(frames))
        inputs = self.subject.random_inputs(rng, len(frames))
        inputs["normal"] = rounded(frames[:, :, 2].T)
        return _away(Batch(wo, wo, inputs, frame=frames))

    def _stops(self, inputs: dict[str, Array]) -> Array:
        inner, outer = (np.clip(cone_cosine(inputs[f"{name}_angle"]), 0.0, 1.0) for name in CONES)
        ends = np.zeros((len(inner), 2)) + [0.0, 1.0]
        return np.sort(np.column_stack([ends, inner, np.minimum(inner, outer)]), axis=1)


def _away(batch: Batch) -> Batch:
    """Views of a batch that are not at the hard edge of a cone."""
    hard = batch.inputs["outer_angle"] <= batch.inputs["inner_angle"]
    edge = cone_cosine(batch.inputs["inner_angle"])
    return batch.where(~hard | (np.abs(np.maximum(batch.wo[:, 2], 0.0) - edge) >= EDGE))


def _nodes(stops: Array, count: int) -> tuple[Array, Array]:
    """Cosines and weights, (M, K), of integrals of 2 mu over the pieces between stops."""
    x, w = np.polynomial.legendre.leggauss(count)
    low, high = stops[:, :-1, np.newaxis], stops[:, 1:, np.newaxis]
    t = 0.5 * (x + 1.0)  # high - mu = t^2 (high - low): dense at the upper end, where powers root
    mu = high - t * t * (high - low)
    mu = float32(mu)
    weights = 2.0 * mu * (high - low) * w * t
    return mu.reshape(len(stops), -1), weights.reshape(len(stops), -1)


DARK = Scene("dark", size=32)
SMALL = Scene("dark", size=8)
OPACITIES = (0.0, 0.25, 1.0)


class EmissionPictureProbe(NodeProbe, ValueProbe):
    """An EDF node on a sphere in the dark."""

    shown: ClassVar[str] = kinds.EMISSION_PICTURE

    subject: EmissionSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points away from the rim, for each material."""
        wo, mask = _views()
        return tuple(Batch(wo[mask], wo[mask], each, DARK) for each in self.subject.materials)

    def direct(self, batch: Batch) -> Array:
        image = self.host.picture(self.shader_of(batch.inputs), DARK)
        return np.asarray(image[sphere(DARK.size).mask][_views()[1]], np.float64)


def _views() -> tuple[Array, Mask]:
    """Directions to the viewer at the points of the sphere, and which are away from its rim."""
    points = sphere(DARK.size)
    wo = local_directions(points.normal[points.mask], VIEW)
    return wo, wo[:, 2] >= RIM


class SurfaceEmissionProbe(NodeProbe):
    """A surface on a host that draws it in the dark, one picture for each opacity."""

    subject: SurfaceSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The points of the sphere, for each of OPACITIES."""
        points = sphere(SMALL.size)
        wo = local_directions(points.normal[points.mask], VIEW)
        return tuple(Batch(wo, wo, {"opacity": each}, SMALL) for each in OPACITIES)

    def expected(self, batch: Batch) -> Array:
        radiance = surface_radiance(SURFACE_COLOR, (0.0, 0.0, 0.0), batch.inputs["opacity"])
        return np.broadcast_to(radiance, batch.wo.shape)

    def direct(self, batch: Batch) -> Array:
        shader = self.host.compile(self.subject.document(batch.inputs), library=self.library)[0]
        image = self.host.picture(shader, SMALL)
        return np.asarray(image[sphere(SMALL.size).mask], np.float64)


class MediumProbe(NodeProbe, ValueProbe):
    """A VDF node on a host that evaluates what a surface over it lets through."""

    usual: ClassVar[Counts] = Counts(1 << 8)

    subject: MediumSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random views, and random inputs of the node."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        wo = directions(rng, count)
        inputs = self.subject.random_inputs(rng, count)
        return (Batch(wo, wo * [1.0, 1.0, -1.0], inputs),)

    def direct(self, batch: Batch) -> Array:
        return self._evaluate(batch.altered(**{"top/weight": 0.0}), "throughput")

    @cached_property
    def through(self) -> Array:
        (batch,) = self.batches
        coefficients = (each for each in self.subject.inputs if np.shape(batch.inputs[each])[1:])
        clear = batch.altered(**dict.fromkeys(coefficients, (0.0, 0.0, 0.0)))
        with np.errstate(divide="ignore", invalid="ignore"):
            return self._evaluate(batch, "response") / self._evaluate(clear, "response")

    def _evaluate(self, batch: Batch, output: str) -> Array:
        evaluate = self.host.evaluate
        values = evaluate(
            self.shader, batch.wo, batch.wi, batch.inputs, "transmission", output=output
        )
        return np.asarray(values, np.float64)
