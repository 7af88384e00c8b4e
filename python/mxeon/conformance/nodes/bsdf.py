# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the other BSDF nodes of pbrlib, in each of their modes."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from mxeon.conformance.nodes.subject import Changes
from mxeon.conformance.samples.batch import Array, Batch, Candidate
from mxeon.conformance.samples.edge_cases import LEAST_SHEEN
from mxeon.conformance.samples.uneven_environment import sky
from mxeon.models import pbrlib
from mxeon.models.pbrlib.node import Inputs, PbrNode
from mxeon.shaders.nodes import input_types, material_text

# Kinds of probes; see `mxeon.conformance.probes.bsdf`.
CLOSED, SHEEN, FITTED, MICROFACET, SCHLICK = KINDS = (
    "closed pairs",
    "sheen pairs",
    "fitted pairs",
    "microfacet pairs",
    "Schlick pairs",
)
MICROFACET_KINDS = (MICROFACET, SCHLICK)
HAIR = "hair pairs"  # of the hair node
COMBINED = "combined pairs"  # of a node that combines lobes
NESTED = "nested pairs"  # of a node that combines a sum
FILM = "film pairs"  # of microfacets under a thin film
QUADRATURES = {  # largest error of a probe's integrals of the equations
    CLOSED: 1e-8,
    SHEEN: 1e-8,
    FITTED: 2e-4,
    MICROFACET: 6e-4,
    SCHLICK: 6e-4,
    HAIR: 1e-4,
}
SELECTORS = ("mode", "scatter_mode", "distribution")  # inputs that are words, fixed in a document
COLORS = ("color", "tint", "color0", "color82", "color90")
EDGES: dict[str, tuple[float, ...]] = {  # of half of an input's special values
    **dict.fromkeys(COLORS, (0.0, 1e-3, 1.0)),
    "ior": (1.0, 1.5, 3.0),
    "extinction": (0.2, 3.0),
    "exponent": (1.0, 5.0),
}
RANGES: dict[str, tuple[float, float]] = {  # of an input's random values
    **dict.fromkeys(COLORS, (0.0, 1.0)),
    "ior": (0.5, 3.0),
    "extinction": (0.2, 6.0),
    "exponent": (1.0, 8.0),
    "thinfilm_thickness": (0.0, 1000.0),
    "thinfilm_ior": (1.0, 2.5),
}
CHANGES: dict[str, Changes] = {
    "weight": ({}, {"weight": 0.5}),
    **{name: ({}, {name: (0.9, 0.1, 0.6)}) for name in COLORS},
    "roughness": ({}, {"roughness": (0.3, 0.3)}),
    "ior": ({}, {"ior": (0.9, 1.1, 1.6)}),
    "extinction": ({}, {"extinction": (0.9, 2.1, 3.6)}),
    "exponent": ({}, {"exponent": 2.5}),
    "retroreflective": ({}, {"retroreflective": True}),
    "thinfilm_thickness": ({}, {"thinfilm_thickness": 400.0}),
    "thinfilm_ior": (
        {"thinfilm_thickness": 400.0},
        {"thinfilm_thickness": 400.0, "thinfilm_ior": 2.0},
    ),
    "normal": ({}, {"normal": (0.0, 0.6, 0.8)}),
    "tangent": ({"roughness": (0.1, 0.4)}, {"roughness": (0.1, 0.4), "tangent": (0.6, 0.8, 0.0)}),
}
BLACK = ("color", "tint", "color0", "color90")

NOTHING = Candidate("zero", lambda batch: np.zeros((len(batch.wo), 3)))
LEAST_ALPHA = 1e-3  # of random pairs
ROUGH_EDGES = (1e-4, 0.01, 1.0)  # special values of alpha
SHEEN_EDGES = (0.01, 0.05, 1.0)  # special roughnesses of a lobe that has one


@dataclass(frozen=True)
class BsdfSubject:
    """A mode of a node of `mxeon.models.pbrlib`.

    Attributes
    ----------
    row : PbrNode
    """

    row: PbrNode

    libraries: ClassVar[tuple[str, ...]] = ()
    closure: ClassVar[bool] = True

    @property
    def title(self) -> str:
        """Name in reports."""
        words = [f"{name} {value}" for name, value in self.row.fixed.items()]
        return ", ".join([self.row.category, *words])

    @property
    def node(self) -> str:
        """Category of the node."""
        return self.row.category

    @property
    def model(self) -> str:
        """Name of its row."""
        return self.row.name

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the node's inputs but those that select a mode."""
        return tuple(name for name in input_types(self.node) if name not in SELECTORS)

    @property
    def kind(self) -> str:
        """Kind of its probe; see `mxeon.conformance.probes.bsdf`."""
        if self.anisotropic:
            return SCHLICK if "color82" in self.row.inputs else MICROFACET
        if self.row.fitted:
            return FITTED
        return SHEEN if self.row.category == "sheen_bsdf" else CLOSED

    @property
    def changes(self) -> dict[str, Changes]:
        """For each input: inputs without and with a change of it alone, which must be seen."""
        changes = {name: CHANGES[name] for name in self.inputs}
        kinds = input_types(self.node)
        for name in ("roughness", "ior"):
            if kinds.get(name) == "float":  # one of the components that other nodes have
                changes[name] = ({}, {name: np.asarray(CHANGES[name][1][name])[-1]})
        return changes

    @property
    def black(self) -> dict[str, Any]:
        """Inputs with which it scatters no light; none where it always scatters some."""
        return {name: (0.0, 0.0, 0.0) for name in BLACK if name in self.row.inputs}

    @property
    def anisotropic(self) -> bool:
        """Whether the roughness has a direction."""
        return input_types(self.node).get("roughness") == "vector2"

    def with_flag(self, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        """The inputs."""
        return inputs

    def document(self, inputs: Mapping[str, Any] | None = None) -> str:
        """MaterialX text of a material that is this node alone, with these inputs."""
        return material_text(self.node, {**(inputs or {}), **self.row.fixed}, self.node)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values of the inputs of the row, float32 numbers."""
        return {name: self._random(rng, count, name) for name in self.row.inputs}

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values of which half lie on an edge."""
        inputs = self.random_inputs(rng, count)
        edges = {**EDGES, "roughness": ROUGH_EDGES if self.anisotropic else SHEEN_EDGES}
        for name, values in inputs.items():
            if name in edges:
                picked = rng.choice(edges[name], values.shape)
                mixed = np.where(rng.random(values.shape) < 0.5, picked, values)
                inputs[name] = mixed.astype(np.float32).astype(np.float64)
        return inputs

    def expected(self, batch: Batch) -> Array:
        """pi f |cos(theta_i)| with weight and occlusion, (N, 3); 0 on the other side."""
        return _expected(self.row, self.row.value, batch)

    def albedo(self, batch: Batch) -> Array:
        """Directional albedo with weight, (N, 3)."""
        return _albedo(self.row.albedo, batch)

    def integral(self, batch: Batch) -> Array:
        """Integral of the values with weight, (N, 3)."""
        return _albedo(self.row.integral or self.row.albedo, batch)

    def sky(self, batch: Batch) -> Array:
        """Mean of the uneven sky that it scatters, (N, 3): of the side from which light comes."""
        return sky(-batch.normal if self.row.transmits else batch.normal)

    def passed(self, batch: Batch) -> Array:
        """Throughput, (N, 3): the share of the light from below that passes."""
        if not self.row.layerable:
            return np.zeros((len(batch.wo), 3))
        return np.maximum(1.0 - self.albedo(batch), 0.0)

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """The row's own function of directions, and its variants."""
        own = Candidate(self.row.title, partial(_expected, self.row, self.row.value))
        others = (
            Candidate(each.title, partial(_expected, self.row, each.value), each.permitted)
            for each in self.row.variants
            if each.value
        )
        return (own, *others, *_wrong_side(self.row), NOTHING)

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        """The row's own albedo, and its variants."""
        own = Candidate(self.row.title, partial(_albedo, self.row.albedo))
        others = (
            Candidate(each.title, partial(_albedo, each.albedo), each.permitted)
            for each in self.row.variants
            if each.albedo
        )
        return (own, *others, NOTHING)

    def _random(self, rng: np.random.Generator, count: int, name: str) -> Array:
        components = {"float": (), "vector2": (2,)}.get(input_types(self.node)[name], (3,))
        values = rng.random((count, *components))
        if name == "roughness":
            values = self._roughness(values)
        else:
            low, high = RANGES[name]
            values = low + (high - low) * np.clip(1.25 * values - 0.125, 0.0, 1.0)
        return values.astype(np.float32).astype(np.float64)

    def _roughness(self, uniform: Array) -> Array:
        """Roughness of numbers in [0, 1]: half of the anisotropic ones are the same twice."""
        if not self.anisotropic:
            return np.clip(1.25 * uniform - 0.125, LEAST_SHEEN, 1.0)
        alpha = LEAST_ALPHA ** (1.0 - uniform)
        alpha[::2] = alpha[::2, :1]
        return alpha


def _wrong_side(row: PbrNode) -> Iterator[Candidate]:
    """A lobe that transmits, taken for one that reflects."""
    if row.transmits:

        def mirrored(wo: Array, wi: Array, inputs: Inputs) -> Array:
            return row.value(wo, wi * [1.0, 1.0, -1.0], inputs)

        def reflection(batch: Batch) -> Array:
            broadcast_inputs = batch.altered(occlusion=1.0)  # as of light through the base
            return _expected(replace(row, transmits=False), mirrored, broadcast_inputs)

        yield Candidate("a reflection in its place", reflection)


def _albedo(albedo: Callable[[Array, Inputs], Array], batch: Batch) -> Array:
    """A directional albedo with weight, (N, 3)."""
    return batch.strength * albedo(batch.wo, broadcast_inputs(batch))


def _expected(row: PbrNode, value: Callable[[Array, Array, Inputs], Array], batch: Batch) -> Array:
    """pi f |cos(theta_i)| of a function of `wo, wi, inputs` on the row's side of the horizon."""
    side = np.where(batch.wi[:, 2:] < 0.0, -1.0, 1.0) * (-1.0 if row.transmits else 1.0)
    wi = batch.wi * np.concatenate([np.ones((len(side), 2)), side], axis=1)
    occlusion = np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
    factor = batch.strength * (1.0 if row.transmits else occlusion)
    lit = np.where(side < 0.0, 0.0, np.clip(np.abs(wi[:, 2:]), 0.0, 1.0))
    return np.asarray(np.pi * value(batch.wo, wi, broadcast_inputs(batch)) * lit * factor)


def broadcast_inputs(batch: Batch) -> dict[str, Array]:
    """The inputs with a row for each pair."""
    count = len(batch.wo)
    return {
        name: np.broadcast_to(values, (count, *np.shape(values)[-1:]))
        if np.shape(values)[:1] != (count,)
        else values
        for name, values in batch.inputs.items()
    }


BSDFS = tuple(BsdfSubject(row) for row in pbrlib.NODES)
