# SPDX-License-Identifier: Apache-2.0
"""Specs of BSDF nodes, one spec per mode of a node, and error terms that several nodes share."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from mxeon.conformance import samples, spec
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import TURNED, Array, Batch, Candidate, Counts, Values, directions_at
from mxeon.conformance.tolerance import Term, Tolerance, roundings, sum_in, sum_of
from mxeon.models.hair import TINTS
from mxeon.models.nodes import node
from mxeon.models.nodes.node import ABSORBING, COLORED, Inputs, PbrNode, Scattering
from mxeon.shaders.nodes import material_text

COUNTS = Counts(pairs=1 << 12, few=1 << 10, diagnosed=1 << 11)
LEAST_VIEW = 0.02  # smallest cosine of views whose values are integrated
WEIGHT = spec.Input("weight", change=0.5, materials=(1.0, 0.5))
ROUGHNESS = spec.Input(
    "roughness", low=samples.LEAST_SHEEN, edges=(0.01, 0.05, 1.0), change=0.3, materials=(0.8, 0.4)
)
COLOR = spec.color("color", (0.2, 0.5, 0.8), (0.8, 0.4, 0.1))
NORMAL = spec.Input("normal", "vector3", change=(0.0, 0.6, 0.8))

FLAT_FRAME = sum_of(roundings(15 / TURNED[0], "of three cosines of at least 1/4, five in each"))


def lobe_errors(
    value: Tolerance, albedo: Tolerance, throughput: Tolerance, frame: Tolerance, quadrature: float
) -> dict[str, Tolerance]:
    """Tolerances of a lobe. An albedo integrated from exact values has the error `quadrature`."""
    sums = Term(quadrature, "the quadrature of the equations")
    integral = sum_in(Quantity.ALBEDO, value.term("an average of values"), sums)
    light = integral.term("an albedo"), throughput.term("a throughput")
    return {
        **dict.fromkeys(("value", "reciprocity"), value),
        "albedo": albedo,
        "throughput": throughput,
        "frame": frame,
        "integral": integral,
        "light": sum_in(Quantity.LIGHT, *light),
    }


@dataclass(frozen=True, eq=False, kw_only=True)
class ScatteringSpec(spec.RowSpec[Scattering], spec.LobeSpec):
    """A node whose scattered light is defined by the equations of `row`."""

    row: PbrNode

    @property
    def black(self) -> Values:
        """Inputs that make the node scatter nothing, or {} without such inputs."""
        names = ("color", "tint", "color0", "color90", *TINTS)
        return {name: (0.0, 0.0, 0.0) for name in names if name in self.row.inputs}

    @property
    def side(self) -> float:
        return -1.0 if self.row.transmits else 1.0

    def document(self, inputs: Values | None = None) -> str:
        return material_text(self.node, {**self.mode, **(inputs or {})}, self.node, self.types)

    def values(self, function: Scattering, batch: Batch) -> Array:
        """Values pi f |cos(theta_i)|, times weight and occlusion, (N, 3). Unlit sides are 0."""
        wi = batch.wi.copy()
        wi[:, 2] = self.side * np.abs(wi[:, 2])
        lit = (batch.wi[:, 2:] < 0.0) == self.row.transmits
        cosine = np.where(lit, np.minimum(np.abs(wi[:, 2:]), 1.0), 0.0)
        factor = batch.strength
        if not self.row.transmits:  # an occlusion reduces only light from above
            factor = factor * np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
        value = function(batch.wo, wi, spec.broadcast_inputs(batch))
        return np.asarray(np.pi * value * cosine * factor)

    def albedo(self, batch: Batch) -> Array:
        return _albedo(self.row.albedo, batch)

    def throughput(self, batch: Batch) -> Array:
        return _throughput(batch, self.row.taken or self.row.albedo)

    def sky(self, batch: Batch) -> Array:
        return samples.sky(self.side * batch.normal)

    def integral(self, batch: Batch) -> Array:
        """Integral of the values over all light directions, including the weight, (N, 3)."""
        return _albedo(self.row.integral or self.row.albedo, batch)

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        variants = (
            Candidate(each.title, partial(_albedo, each.albedo), each.permitted)
            for each in self.row.variants
            if each.albedo and not each.above
        )
        return (Candidate(self.row.title, self.albedo), *variants, spec.ZERO)

    @property
    def throughput_candidates(self) -> tuple[Candidate, ...]:
        """Candidates for a throughput: 1 minus the albedo of each model, or 1."""
        candidates = [Candidate(self.row.title, self.throughput)]
        if any(name in ABSORBING for name in self.row.inputs):
            colored = partial(_throughput, albedo=self.row.albedo, colored=True)
            candidates.append(Candidate(COLORED, colored, permitted=True))
        for each in self.row.variants:
            if each.albedo:
                values = partial(_throughput, albedo=each.albedo, colored=each.above)
                candidates.append(Candidate(each.title, values, each.permitted))
        return (*candidates, Candidate("all light passes", lambda batch: np.ones_like(batch.wo)))

    def random_inputs(self, rng: samples.Rng, count: int, edged: bool = False) -> dict[str, Array]:
        return spec.draw(rng, count, self.drawn, edged)

    def integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        """Inputs for which a quadrature is accurate. By default, inputs stay unchanged."""
        return inputs

    def integrated(
        self, counts: Counts, adapt: Callable[[dict[str, Array]], dict[str, Array]]
    ) -> tuple[Batch, Array]:
        """Random materials lit from all directions of a quadrature, and the quadrature's weights.

        `adapt` limits the inputs to values that a backend supports.
        """
        rng, count = samples.generator(), counts.materials
        mu = LEAST_VIEW + (1.0 - LEAST_VIEW) * rng.random(count)
        inputs = self.random_inputs(rng, count)
        if self.row.mirror:  # errors of the compensation are largest for a rough mirror
            mu[0] = 0.1
            for name, value in {**self.row.mirror, "roughness": 1.0}.items():
                inputs[name][0] = value
        wo = directions_at(mu, 2.0 * np.pi * rng.random(count))
        return self.lit(Batch(wo, wo, adapt(self.integrable(inputs))), counts.nodes)

    def lit(self, views: Batch, count: int) -> tuple[Batch, Array]:
        """Each view, lit from all directions of a quadrature, with the weights of the directions.

        The weighted sum of pi f cos over a view's directions is the view's directional albedo.
        """
        wi, weights = self.nodes(views.wo, dict(views.inputs), count)
        pairs = views.where(np.repeat(np.arange(len(wi)), wi.shape[1]))
        return replace(pairs, wi=wi.reshape(-1, 3)), weights

    @abstractmethod
    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        """Directions (M, K, 3) and weights (M, K) of a quadrature over each view's hemisphere."""


class Mode(spec.Names):
    """Fields of a spec that a row of the models' table determines."""

    row: PbrNode


def mode_of(row: PbrNode, title: str = "") -> Mode:
    """Fields of a spec for `row`. The default title lists the inputs that select the mode."""
    words = [row.category, *(f"{name} {value}" for name, value in row.fixed.items())]
    return {**spec.named(row, title or ", ".join(words)), "row": row}


@dataclass(frozen=True, eq=False, kw_only=True)
class PbrSpec(ScatteringSpec):
    """One mode of a BSDF node of pbrlib."""

    requires = spec.Ability.LOBE
    coarse = 2

    counts: Counts = COUNTS

    least_cosine: float = 0.0  # smallest cosine of views whose albedos are compared

    @property
    def bounded(self) -> tuple[spec.Input, ...]:
        """Inputs that are also tested outside their ranges."""
        return tuple(each for each in self.drawn if each.beyond)

    @property
    def mode(self) -> Values:
        return self.row.fixed

    @property
    def others(self) -> tuple[Candidate, ...]:
        """Functions that may explain values: zero and, for a transmitting lobe, the reflection."""
        if not self.row.transmits:
            return (spec.ZERO,)
        opaque = replace(self, row=replace(self.row, transmits=False))

        def mirrored(wo: Array, wi: Array, inputs: Inputs) -> Array:
            return self.row.value(wo, wi * [1.0, 1.0, -1.0], inputs)

        def reflection(batch: Batch) -> Array:
            return opaque.values(mirrored, batch.altered(occlusion=1.0))

        return Candidate("a reflection instead", reflection), spec.ZERO

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        least = self.least_cosine
        views = (batch.where(batch.wo[:, 2] >= least) for batch in batches[:2])
        return tuple(batch.first(counts.albedos) for batch in views)

    def edges(self, counts: Counts) -> Batch:
        """Special and opposite directions, with extreme inputs such as an IOR of 0."""
        rng = samples.generator()
        wo, wi = samples.special_directions(rng)
        inputs = self.random_inputs(rng, len(wo), edged=True)
        # Only some of the pairs with an extinction of 0 have an IOR of 0.
        zeros = ("roughness", 0, 4), ("ior", 0, 3), ("extinction", 0, 6), ("extinction", 1, 6)
        for name, start, step in zeros:
            if name in inputs:
                inputs[name][start::step] = 0.0
        wi = wi * [1.0, 1.0, self.side]
        wi[5::12] = -wo[5::12]
        return Batch(wo, wi, inputs)

    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        # Use uniform azimuths. Gauss nodes in the cosine are dense at the horizon and the normal.
        x, w = np.polynomial.legendre.leggauss(count)
        t = 0.5 * (x + 1.0)
        mu = t * t * (3.0 - 2.0 * t)
        slope = 6.0 * t * (1.0 - t) * 0.5 * w
        azimuth = np.arctan2(wo[:, 1], wo[:, 0])[:, np.newaxis, np.newaxis]
        phi = azimuth + 2.0 * np.pi * (np.arange(count) + 0.5) / count
        wi = directions_at(self.side * mu[:, np.newaxis], phi).reshape(len(wo), -1, 3)
        weights = np.repeat(slope * 2.0 / count, count)
        return wi, np.broadcast_to(weights, wi.shape[:2])


def uncolored(batch: Batch) -> Batch:
    """Replace all colors that only absorb light by white."""
    return batch.altered(**{each: samples.WHITE for each in ABSORBING if each in batch.inputs})


def _albedo(albedo: Callable[[Array, Inputs], Array], batch: Batch) -> Array:
    """A directional albedo times the weight, (N, 3)."""
    return batch.strength * albedo(batch.wo, spec.broadcast_inputs(batch))


def _throughput(
    batch: Batch, albedo: Callable[[Array, Inputs], Array], colored: bool = False
) -> Array:
    """max(1 - albedo, 0), (N, 3). Unless `colored`, colors that only absorb light are white."""
    return np.maximum(1.0 - _albedo(albedo, batch if colored else uncolored(batch)), 0.0)


BURLEY_VALUE = sum_of(
    roundings(2 * 17 + 7, "of max(value, 1): 17 in each factor, 7 in the products")
)
FLAT_ALBEDO = sum_of(roundings(32, "of max(albedo, 1)"), quantity=Quantity.ALBEDO)
FLAT_ERRORS = lobe_errors(BURLEY_VALUE, FLAT_ALBEDO, FLAT_ALBEDO, FLAT_FRAME, quadrature=1e-8)


WHOLE_ROUGHNESS = replace(ROUGHNESS, low=0.0, edges=(0.0, 0.05, 1.0))
BURLEY, TRANSLUCENT = (
    PbrSpec(**mode_of(row), inputs=inputs, errors=FLAT_ERRORS, flat=True)
    for row, inputs in (
        (node("burley"), (WEIGHT, COLOR, WHOLE_ROUGHNESS, NORMAL)),
        (node("translucent"), (WEIGHT, COLOR, NORMAL)),
    )
)
