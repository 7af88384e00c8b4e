# SPDX-License-Identifier: Apache-2.0
"""Specs of BSDF nodes of `mxeon.models.nodes`, one per mode, and the error terms they share."""

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
LEAST_VIEW = 0.02  # least cosine of views whose values are integrated
# Weights and normals have no random range here: batches bring their own weights and frames.
WEIGHT = spec.Input("weight", change=0.5, materials=(1.0, 0.5))
# Roughness of every lobe except microfacet lobes.
ROUGHNESS = spec.Input(
    "roughness", low=samples.LEAST_SHEEN, edges=(0.01, 0.05, 1.0), change=0.3, materials=(0.8, 0.4)
)
COLOR = spec.color("color", (0.2, 0.5, 0.8), (0.8, 0.4, 0.1))
NORMAL = spec.Input("normal", "vector3", change=(0.0, 0.6, 0.8))

# Three cosines have five roundings each, divided by the least cosine.
FLAT_FRAME = sum_of(roundings(15 / TURNED[0], "of three cosines of at least 1/4, five in each"))


def lobe_errors(
    value: Tolerance, albedo: Tolerance, throughput: Tolerance, frame: Tolerance, quadrature: float
) -> dict[str, Tolerance]:
    """Tolerances of a lobe; `quadrature` is the quadrature error for the exact equations."""
    sums = Term(quadrature, "the quadrature on the equations")
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
    """A node that scatters light, with the equations of `row`."""

    row: PbrNode

    @property
    def black(self) -> Values:
        """Inputs that make the node scatter nothing; empty if there are none."""
        names = ("color", "tint", "color0", "color90", *TINTS)
        return {name: (0.0, 0.0, 0.0) for name in names if name in self.row.inputs}

    @property
    def side(self) -> float:
        return -1.0 if self.row.transmits else 1.0

    def document(self, inputs: Values | None = None) -> str:
        return material_text(self.node, {**self.mode, **(inputs or {})}, self.node, self.types)

    def values(self, function: Scattering, batch: Batch) -> Array:
        """pi f |cos(theta_i)| with weight and occlusion, (N, 3); 0 on the unlit side."""
        side = np.where(batch.wi[:, 2:] < 0.0, -1.0, 1.0) * (-1.0 if self.row.transmits else 1.0)
        wi = batch.wi * np.concatenate([np.ones((len(side), 2)), side], axis=1)
        occlusion = np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
        factor = batch.strength * (1.0 if self.row.transmits else occlusion)
        lit = np.where(side < 0.0, 0.0, np.clip(np.abs(wi[:, 2:]), 0.0, 1.0))
        value = function(batch.wo, wi, spec.broadcast_inputs(batch))
        return np.asarray(np.pi * value * lit * factor)

    def albedo(self, batch: Batch) -> Array:
        return _albedo(self.row.albedo, batch)

    def throughput(self, batch: Batch) -> Array:
        """1 - E of the lobe without its color, at least 0, (N, 3)."""
        return np.maximum(1.0 - _albedo(self.row.taken or self.row.albedo, uncolored(batch)), 0.0)

    def sky(self, batch: Batch) -> Array:
        return samples.sky(self.side * batch.normal)

    def integral(self, batch: Batch) -> Array:
        """Integral of the values, including the weight, (N, 3)."""
        return _albedo(self.row.integral or self.row.albedo, batch)

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        own = Candidate(self.row.title, self.albedo)
        shown = (each for each in self.row.variants if not each.above)
        rows = ((each, each.albedo) for each in shown if each.albedo)
        variants = (Candidate(e.title, partial(_albedo, albedo), e.permitted) for e, albedo in rows)
        return (own, *variants, spec.ZERO)

    @property
    def throughput_candidates(self) -> tuple[Candidate, ...]:
        """Candidates for a throughput: 1 - E of each model, or 1."""

        def rest(batch: Batch, albedo: Callable[[Array, Inputs], Array], above: bool) -> Array:
            return np.maximum(1.0 - _albedo(albedo, batch if above else uncolored(batch)), 0.0)

        candidates = [Candidate(self.row.title, self.throughput)]
        if any(name in ABSORBING for name in self.row.inputs):
            colored = partial(rest, albedo=self.row.albedo, above=True)
            candidates.append(Candidate(COLORED, colored, permitted=True))
        variants = (
            Candidate(e.title, partial(rest, albedo=e.albedo, above=e.above), e.permitted)
            for e in self.row.variants
            if e.albedo
        )
        all_light = Candidate("all light passes", lambda batch: np.ones_like(batch.wo))
        return (*candidates, *variants, all_light)

    def random_inputs(self, rng: samples.Rng, count: int, edged: bool = False) -> dict[str, Array]:
        return spec.draw(rng, count, self.drawn, edged)

    def integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        """Change inputs where a quadrature would be inaccurate; by default, nowhere."""
        return inputs

    def integrated(
        self, counts: Counts, taken: Callable[[dict[str, Array]], dict[str, Array]]
    ) -> tuple[Batch, Array]:
        """Random materials, each lit from all directions of a quadrature, and the weights."""
        rng, count = samples.generator(), counts.materials
        mu = LEAST_VIEW + (1.0 - LEAST_VIEW) * rng.random(count)
        inputs = self.random_inputs(rng, count)
        if self.row.mirror:  # a rough mirror, where the fit of the compensation matters most
            mu[0] = 0.1
            for name, value in {**self.row.mirror, "roughness": 1.0}.items():
                inputs[name][0] = value
        wo = directions_at(mu, 2.0 * np.pi * rng.random(count))
        return self.lit(Batch(wo, wo, taken(self.integrable(inputs))), counts.nodes)

    def lit(self, views: Batch, count: int) -> tuple[Batch, Array]:
        """Repeat each view for all directions of a quadrature, and return their weights, too.

        The weighted sum of pi f cos over a view's directions is its directional albedo.
        """
        wi, weights = self.nodes(views.wo, dict(views.inputs), count)
        pairs = views.where(np.repeat(np.arange(len(wi)), wi.shape[1]))
        return replace(pairs, wi=wi.reshape(-1, 3)), weights

    @abstractmethod
    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        """Directions (M, K, 3) and weights (M, K) of a quadrature over each view's hemisphere."""


def named_mode(row: PbrNode, title: str = "") -> spec.Names:
    """Names of a mode's spec; by default, the title lists the inputs that select the mode."""
    words = [row.category, *(f"{name} {value}" for name, value in row.fixed.items())]
    return spec.named(row, title or ", ".join(words))


@dataclass(frozen=True, eq=False, kw_only=True)
class PbrSpec(ScatteringSpec):
    """A mode of a BSDF node: a row of `mxeon.models.nodes`."""

    requires = spec.Ability.LOBE
    coarse = 2

    counts: Counts = COUNTS

    least_cosine: float = 0.0  # least cosine of views whose albedos are compared

    @property
    def bounded(self) -> tuple[spec.Input, ...]:
        """Inputs that are measured outside their ranges, too."""
        return tuple(each for each in self.drawn if each.beyond)

    @property
    def mode(self) -> Values:
        return self.row.fixed

    @property
    def others(self) -> tuple[Candidate, ...]:
        """Other candidates for a diagnosis: zero and, for a transmitting lobe, a reflection."""
        if not self.row.transmits:
            return (spec.ZERO,)
        opaque = replace(self, row=replace(self.row, transmits=False))

        def mirrored(wo: Array, wi: Array, inputs: Inputs) -> Array:
            return self.row.value(wo, wi * [1.0, 1.0, -1.0], inputs)

        def reflection(batch: Batch) -> Array:
            return opaque.values(mirrored, batch.altered(occlusion=1.0))  # not occluded from below

        return Candidate("a reflection instead", reflection), spec.ZERO

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        least = self.least_cosine
        views = (batch.where(batch.wo[:, 2] >= least) for batch in batches[:2])
        return tuple(batch.first(counts.albedos) for batch in views)

    def edges(self, counts: Counts) -> Batch:
        """Exact directions, some with opposite light, and extreme inputs (roughness, index 0)."""
        rng = samples.generator()
        wo, wi = samples.special_directions(rng)
        inputs = self.random_inputs(rng, len(wo), edged=True)
        # Some extinctions of 0 meet an index of 0, others do not.
        zeros = ("roughness", 0, 4), ("ior", 0, 3), ("extinction", 0, 6), ("extinction", 1, 6)
        for name, start, step in zeros:
            if name in inputs:
                inputs[name][start::step] = 0.0
        wi = wi * [1.0, 1.0, self.side]
        wi[5::12] = -wo[5::12]
        return Batch(wo, wi, inputs)

    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        # Use Gauss nodes that are dense at the horizon and the normal, and uniform azimuths.
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
    """Replace the colors that only absorb by white."""
    return batch.altered(**{each: samples.WHITE for each in ABSORBING if each in batch.inputs})


def _albedo(albedo: Callable[[Array, Inputs], Array], batch: Batch) -> Array:
    """A directional albedo times the weight, (N, 3)."""
    return batch.strength * albedo(batch.wo, spec.broadcast_inputs(batch))


# Each factor of Burley's model has 17 roundings (ten in the cosine of wh); the products add 7.
BURLEY_ROUNDINGS = roundings(2 * 17 + 7, "of the value or 1: 17 in each factor, 7 in the products")
BURLEY_VALUE = sum_of(BURLEY_ROUNDINGS)
# Burley's albedo has a closed form; the albedo of other flat lobes is their color.
FLAT_ALBEDO = sum_of(roundings(32, "of the albedo or 1"), quantity=Quantity.ALBEDO)
FLAT_ERRORS = lobe_errors(BURLEY_VALUE, FLAT_ALBEDO, FLAT_ALBEDO, FLAT_FRAME, quadrature=1e-8)


WHOLE_ROUGHNESS = replace(ROUGHNESS, low=0.0, edges=(0.0, 0.05, 1.0))
BURLEY, TRANSLUCENT = (
    PbrSpec(**named_mode(row), row=row, inputs=inputs, errors=FLAT_ERRORS, flat=True)
    for row, inputs in (
        (node("burley"), (WEIGHT, COLOR, WHOLE_ROUGHNESS, NORMAL)),
        (node("translucent"), (WEIGHT, COLOR, NORMAL)),
    )
)
