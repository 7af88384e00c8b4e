# SPDX-License-Identifier: Apache-2.0
"""Probe of the hair node: pairs of the whole sphere, pairs in its lobes, and lobes apart."""

from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes.hair import WIDE_SCALE, WIDE_VARIANCE, HairSubject
from mxeon.conformance.nodes.hair_regions import REGIONS
from mxeon.conformance.probes.bsdf import BsdfProbe
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts, directions, rounded
from mxeon.conformance.samples.edge_cases import LEAST_TURNED, special_directions
from mxeon.models.hair import ROUGHNESSES
from mxeon.models.hair.formulas import SCALE, section

STEP = 1e-6  # of an angle, by which slopes are measured
LEAST = 0.01  # value of which errors count relative, where there is less


class HairProbe(BsdfProbe):
    """The hair node on a host that evaluates any pairs."""

    usual: ClassVar[Counts] = replace(BsdfProbe.usual, diagnosed=1 << 9)

    subject: HairSubject

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs, as many in the lobes, and special ones, with roughness above 0."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        wo, inputs = directions(rng, count), self.subject.random_inputs(rng, count)
        free = directions(rng, count) * _sides(rng, count)
        view, light = special_directions(rng)
        return (
            Batch(wo, free, {**inputs, "occlusion": np.round(rng.random(count), 2)}),
            Batch(wo, aimed(rng, wo, inputs), inputs),
            Batch(view, light * _sides(rng, len(view)), self.subject.random_inputs(rng, len(view))),
        )

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        return tuple(batch.first(self.counts.few) for batch in self.batches[:2])

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """Views of fibers without tilt, whose albedo has a closed form."""
        return tuple(batch.altered(cuticle_angle=0.5) for batch in super().cosines)

    @cached_property
    def edges(self) -> Batch:
        """Exact directions, those along the fiber among them, and inputs on their edges."""
        rng = np.random.default_rng(SEED)
        along = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        pairs = np.repeat(along, 4, axis=0), np.tile(along, (4, 1))
        wo, wi = (np.concatenate(each) for each in zip(special_directions(rng), pairs, strict=True))
        wi = wi * _sides(rng, len(wi))
        return Batch(wo, wi, self.subject.special_inputs(rng, len(wo)))

    @cached_property
    def turned(self) -> Batch:
        """Pairs in frames of their own, none with a narrow lobe, whose place would be uncertain."""
        batch = super().turned
        wide = {
            name: np.maximum(batch.inputs[name], [LEAST_TURNED**2, LEAST_TURNED])
            for name in ROUGHNESSES
        }
        sides = _sides(np.random.default_rng(SEED), len(batch.wi))
        return replace(batch.altered(**wide), wi=batch.wi * sides)

    def region(self, key: str) -> Batch:
        """Pairs in the lobes of a row of REGIONS, with each lobe in a channel of its own."""
        rng, row, count = np.random.default_rng(SEED), REGIONS[key], self.counts.few
        sine = 0.9 * (2.0 * rng.random(count) - 1.0)
        low, high = row.azimuths
        azimuth = (low + (high - low) * rng.random(count)) * rng.choice([-1.0, 1.0], count)
        cosine = np.sqrt(1.0 - sine * sine)
        wo = rounded([sine, cosine * np.sin(azimuth), cosine * np.cos(azimuth)])
        inputs = self.subject.random_inputs(rng, count)
        inputs["cuticle_angle"] = 0.5 + 2.0 * row.tilt * (inputs["cuticle_angle"] - 0.5)
        if row.ior:
            least, most = row.ior
            inputs["ior"] = rounded([np.linspace(least, most, count)])[:, 0]
        for name in ROUGHNESSES:
            inputs[name] = rounded(
                low * (high / low) ** rng.random(count) for low, high in (row.variances, row.scales)
            )
        return Batch(wo, aimed(rng, wo, inputs), {**inputs, **row.tints})

    def condition(self, batch: Batch) -> Array:
        """The values, or LEAST, and their slopes in inclination and azimuth of both directions."""
        total = np.maximum(self.expected(batch), LEAST)
        for step in np.eye(4) * STEP:
            up, down = (
                self.expected(
                    replace(batch, wo=_turned(batch.wo, *turn[:2]), wi=_turned(batch.wi, *turn[2:]))
                )
                for turn in (step, -step)
            )
            total += np.abs(up - down) / (2.0 * STEP)
        return total

    def _integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        """Wide lobes without tilt."""
        least = WIDE_VARIANCE, WIDE_SCALE
        wide = {name: np.maximum(inputs[name], least) for name in ROUGHNESSES}
        return {**inputs, **wide, "cuticle_angle": np.full(len(inputs["ior"]), 0.5)}

    def _nodes(self, wo: Array, inputs: dict[str, Array]) -> tuple[Array, Array]:
        """Directions (M, K, 3) and weights (M, K) of a quadrature over all lights."""
        count = self.counts.nodes
        x, w = np.polynomial.legendre.leggauss(count)
        phi = np.pi * (np.arange(2 * count) + 0.5) / count
        sine, angle = (each.ravel() for each in np.meshgrid(x, phi))
        cosine = np.sqrt(1.0 - sine * sine)
        wi = rounded([sine, cosine * np.cos(angle), cosine * np.sin(angle)])
        weights = np.tile(w, 2 * count) / count
        shape = (len(wo), *wi.shape)
        return np.broadcast_to(wi, shape), np.broadcast_to(weights, shape[:2])


def _turned(direction: Array, inclination: float, azimuth: float) -> Array:
    """Directions turned by two angles, (N, 3)."""
    x, y, z = direction.T
    theta, phi = np.arctan2(x, np.hypot(y, z)) + inclination, np.arctan2(y, z) + azimuth
    cosine = np.cos(theta)
    return np.stack([np.sin(theta), cosine * np.sin(phi), cosine * np.cos(phi)], axis=-1)


def _sides(rng: np.random.Generator, count: int) -> Array:
    """Factors of directions, (count, 3), by which half change the side of the surface."""
    return np.stack([np.ones(count), np.ones(count), rng.choice([-1.0, 1.0], count)], axis=-1)


def aimed(rng: np.random.Generator, wo: Array, inputs: dict[str, Array]) -> Array:
    """Directions of light in one of the lobes R, TT and TRT of each view, float32 numbers, (N, 3)."""
    count = len(wo)
    lobe, chosen = rng.integers(0, 3, count), np.arange(count)
    v, s = (np.stack([inputs[name] for name in ROUGHNESSES])[lobe, chosen]).T
    # Draw the longitudinal angle around the one that the cuticle sends it to.
    view, _ = section(wo.T, inputs["ior"])
    tilt = (2.0 - 3.0 * lobe) * np.pi * (inputs["cuticle_angle"] - 0.5)
    theta = -np.arcsin(np.clip(view.sin_o, -1.0, 1.0)) - tilt
    theta = theta + np.sqrt(np.minimum(v, 1.0)) * rng.standard_normal(count)
    # Draw the azimuth from its logistic distribution.
    u = 1e-3 + 0.998 * rng.random(count)
    exit_angle = 2.0 * lobe * view.gamma_t - 2.0 * view.gamma_o + lobe * np.pi
    phi = np.arctan2(wo[:, 2], wo[:, 1]) + exit_angle + SCALE * s * np.log(u / (1.0 - u))
    cosine = np.abs(np.cos(theta))
    return rounded([np.sin(theta), cosine * np.cos(phi), cosine * np.sin(phi)])
