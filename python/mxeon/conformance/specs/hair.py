# SPDX-License-Identifier: Apache-2.0
"""Spec of the hair node, with regions of views and roughnesses in which known shaders differ.

The longitudinal density M has the variance v, and the azimuthal density N has the scale s.
"""

import math
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from mxeon.conformance import samples
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import LEAST_TURNED, Array, Batch, Counts, Values, generator, rounded
from mxeon.conformance.spec import Ability, Input, broadcast_inputs, color
from mxeon.conformance.specs.lobes import NORMAL, PbrSpec, lobe_errors, mode_of
from mxeon.conformance.tolerance import Compared, Term, roundings, sum_in, sum_of
from mxeon.models.hair import ROUGHNESSES, SCALE, TINTS, chiang_hair_attenuation, section
from mxeon.models.nodes.lobes import BESSEL, CLAMPED, HAIR_NODE, UNIFORM
from mxeon.models.nodes.node import Scattering

COUNTS = replace(PbrSpec.counts, diagnosed=1 << 9)
LEAST_VARIANCE, LEAST_SCALE = 1e-4, 0.01  # smallest variance and scale of random lobes
WIDE_VARIANCE, WIDE_SCALE = 0.05, 0.3  # smallest variance and scale of lobes that are integrated
# Share of light that comes from the viewer's side: for R, for TT, for TRT, and for higher orders.
FRONT = np.array([1.0, 0.0, 1.0, 0.5])
STEP = 1e-6  # step of an angle, in radians, for finite differences
LEAST = 0.01  # errors are relative to max(value, 0.01)

# fmt: off
INPUTS = (
    *(color(name, edges=()) for name in TINTS),
    Input("ior", low=1.1, high=2.5, edges=(1.0, 1.55), change=1.3),
    *(
        Input(name, "vector2", (LEAST_VARIANCE, LEAST_SCALE), (100.0, 10.0),
              edges=(0.0, 1e-3, 1.0, 100.0), change=(0.3, 0.7), logarithmic=True)
        for name in ROUGHNESSES
    ),
    Input("cuticle_angle", change=0.55, often=0.5),
    Input("absorption_coefficient", "vector3", 0.0, 4.0, edges=(0.0,), change=(0.9, 0.1, 0.6)),
    NORMAL,
    # The default curve direction is the surface's tangent.
    Input("curve_direction", "vector3", change=(0.6, 0.8, 0.0), variable="tangent"),
)
# fmt: on

# Within an angle of REACH sqrt(v), a lobe of variance v falls from 1e5, the largest pi f, to 1.
REACH = math.sqrt(2.0 * math.log(1e5))
ANGLE, CHAIN = 12, 48  # roundings of an angle, and of all later operations


def lobe_terms(variance: float, scale: float, angle: float = ANGLE) -> tuple[Term, ...]:
    """Error terms of pi f for lobes wider than `variance` and `scale`.

    Each angle has `angle` roundings. The largest derivative with respect to an angle is
    REACH / sqrt(variance) for log M, and 1 / (SCALE scale) for log N.
    """
    slope = REACH / math.sqrt(variance) + 1.0 / (SCALE * scale)
    lobe = f"v {variance:g} and s {scale:g}"
    words = f"{angle} of an angle, times the slope of the logarithm for {lobe}"
    return roundings(slope * angle, f"({words})"), roundings(CHAIN)


VALUE = sum_of(*lobe_terms(LEAST_VARIANCE, LEAST_SCALE), quantity=Quantity.FULL_SPHERE)
# Values in a rotated frame are compared with values in the standard frame. The rotation adds five
# roundings to each angle.
TWO_LOBES = lobe_terms(LEAST_TURNED**2, LEAST_TURNED, 2 * (ANGLE + 5))
FRAME = sum_of(*TWO_LOBES, quantity=Quantity.FULL_SPHERE)
# Mean absolute slope of log M plus mean absolute slope of log N. M is a Gaussian density, and N is
# a logistic density.
MEAN_SLOPE = math.sqrt(2.0 / (math.pi * WIDE_VARIANCE)) + 0.5 / (SCALE * WIDE_SCALE)
MEAN = sum_of(
    roundings(MEAN_SLOPE * ANGLE, "(12 of an angle, times the mean slope of the logarithm)"),
    roundings(CHAIN),
    quantity=Quantity.FULL_SPHERE,
)
ALBEDO = sum_in(Quantity.ALBEDO, roundings(CHAIN, "of numbers up to 1"))
REGION = sum_in(
    Quantity.SLOPES,
    Term(5e-7, "the fit of I_0"),  # [AbramowitzStegun1964], 9.8.1 and 9.8.2
    roundings(12 + 4, "of factors and exponents, and of each angle"),
)

# Tints that put R, TT and TRT, or only R and TT, into separate channels.
LOBE_TINTS = {name: tuple(map(float, row)) for name, row in zip(TINTS, np.eye(3), strict=True)}
R_AND_TT: Values = {**LOBE_TINTS, "tint_TRT": (0.0, 0.0, 0.0)}


@dataclass(frozen=True)
class Region:
    """A check of the hair node in a range of views and roughnesses."""

    claim: str
    azimuths: tuple[float, float] = (0.3, 1.2)  # angles between view and normal, in radians
    variances: tuple[float, float] = (0.2, 1.0)
    scales: tuple[float, float] = (0.2, 1.0)
    tints: Values = field(default_factory=lambda: R_AND_TT)
    tilt: float = 0.05  # largest deviation of `cuticle_angle` from 1/2
    ior: tuple[float, float] | None = None  # range of the IOR; None for the range of INPUTS
    form: str = ""  # title of the permitted approximation in this region


NARROW = partial(Region, variances=(1e-3, 0.1), scales=(0.9, 1.0), form=BESSEL)
# fmt: off
# Regions of views and roughnesses. The key of a region is also the key of the region's check.
REGIONS = {
    "each_lobe": Region("Each lobe matches the equations: R, TT, and TRT with all higher orders.",
                        tints=LOBE_TINTS, form=UNIFORM),
    "narrow_lobes": NARROW("R and TT match the equations where they are narrow.", tilt=0.0),
    "tilted_lobes": NARROW("R and TT match the equations for every tilt of the cuticle.", tilt=0.5),
    "wide_lobes": Region("R and TT match the equations beyond a roughness of 1.",
                         variances=(1.0, 100.0), scales=(1.0, 10.0), form=CLAMPED),
    "straight_views": Region("R and TT match the equations for a view along the normal.",
                             azimuths=(0.0, 0.05), scales=(0.05, 0.2)),
    "low_index": Region("R and TT match the equations for an IOR below 1, including total reflection.",
                        ior=(0.6, 0.95)),
}
# fmt: on
ERRORS = {
    **lobe_errors(MEAN, ALBEDO, ALBEDO, FRAME, quadrature=5e-6),
    **dict.fromkeys(("value", "reciprocity"), VALUE),
    **dict.fromkeys(REGIONS, REGION),
}


@dataclass(frozen=True, eq=False, kw_only=True)
class HairSpec(PbrSpec):
    """The hair node, whose values include no cosine and are defined for light from all sides."""

    requires = Ability.LOBE | Ability.HAIR

    counts: Counts = COUNTS

    def values(self, function: Scattering, batch: Batch) -> Array:
        """Values pi f times the occlusion, (N, 3)."""
        occlusion = np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
        return np.asarray(np.pi * function(batch.wo, batch.wi, broadcast_inputs(batch)) * occlusion)

    def sky(self, batch: Batch) -> Array:
        """Mean of both sides of the sky, weighted by each side's share of the scattered light."""
        inputs = broadcast_inputs(batch)
        A = chiang_hair_attenuation(batch.wo, inputs["ior"], inputs["absorption_coefficient"])
        shares = A * np.stack([inputs[name] for name in (*TINTS, TINTS[-1])], axis=-1)
        front = shares @ FRONT / shares.sum(axis=-1)
        near, far = samples.sky(batch.normal), samples.sky(-batch.normal)
        return np.asarray(front * near + (1.0 - front) * far)

    def rescaled(self, compared: Compared) -> Compared:
        """Divide values by max(value, LEAST) plus the slopes along four angles."""
        batch = compared.batch
        total = np.maximum(self.value(batch), LEAST)
        for step in np.eye(4) * STEP:
            pairs = ((_turned(batch.wo, *x[:2]), _turned(batch.wi, *x[2:])) for x in (step, -step))
            up, down = (self.value(replace(batch, wo=wo, wi=wi)) for wo, wi in pairs)
            total += np.abs(up - down) / (2.0 * STEP)
        return compared.over(total)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs, the same number of pairs inside lobes, and special pairs."""
        rng, count = generator(), counts.pairs
        wo, inputs = samples.directions(rng, count), self.random_inputs(rng, count)
        free = samples.directions(rng, count) * _sides(rng, count)
        view, light = samples.special_directions(rng)
        return (
            Batch(wo, free, {**inputs, "occlusion": np.round(rng.random(count), 2)}),
            Batch(wo, in_lobes(rng, wo, inputs), inputs),
            Batch(view, light * _sides(rng, len(view)), self.random_inputs(rng, len(view))),
        )

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Views of fibers with untilted cuticles, whose albedo has a closed form."""
        return tuple(batch.altered(cuticle_angle=0.5) for batch in super().views(batches, counts))

    def edges(self, counts: Counts) -> Batch:
        """Special pairs and pairs along the axes, with inputs at the ends of the inputs' ranges."""
        rng = generator()
        along = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        pairs = np.repeat(along, 4, axis=0), np.tile(along, (4, 1))
        wo, wi = map(np.concatenate, zip(samples.special_directions(rng), pairs, strict=True))
        wi = wi * _sides(rng, len(wi))
        return Batch(wo, wi, self.random_inputs(rng, len(wo), edged=True))

    def turned(self, counts: Counts) -> Batch:
        """Pairs with individual frames. Lobes are wide, because rounding displaces narrow lobes."""
        batch = super().turned(counts)
        least = LEAST_TURNED**2, LEAST_TURNED
        wide = {name: np.maximum(batch.inputs[name], least) for name in ROUGHNESSES}
        sides = _sides(generator(), len(batch.wi))
        return replace(batch.altered(**wide), wi=batch.wi * sides)

    def region(self, key: str, count: int) -> Batch:
        """Pairs inside the lobes, for views and roughnesses in a region of REGIONS."""
        rng, row = generator(), REGIONS[key]
        sine = 0.9 * (2.0 * rng.random(count) - 1.0)
        low, high = row.azimuths
        azimuth = (low + (high - low) * rng.random(count)) * rng.choice([-1.0, 1.0], count)
        cosine = np.sqrt(1.0 - sine * sine)
        wo = rounded([sine, cosine * np.sin(azimuth), cosine * np.cos(azimuth)])
        inputs = self.random_inputs(rng, count)
        inputs["cuticle_angle"] = 0.5 + 2.0 * row.tilt * (inputs["cuticle_angle"] - 0.5)
        if row.ior:
            least, most = row.ior
            inputs["ior"] = rounded([np.linspace(least, most, count)])[:, 0]
        for name in ROUGHNESSES:
            inputs[name] = rounded(
                low * (high / low) ** rng.random(count) for low, high in (row.variances, row.scales)
            )
        return Batch(wo, in_lobes(rng, wo, inputs), inputs).altered(**row.tints)

    def integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        least = WIDE_VARIANCE, WIDE_SCALE
        wide = {name: np.maximum(inputs[name], least) for name in ROUGHNESSES}
        return {**inputs, **wide, "cuticle_angle": np.full(len(inputs["ior"]), 0.5)}

    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        # Cover the sphere by Gauss nodes in the sine of the inclination and by uniform azimuths.
        x, w = np.polynomial.legendre.leggauss(count)
        phi = np.pi * (np.arange(2 * count) + 0.5) / count
        sine, angle = (each.ravel() for each in np.meshgrid(x, phi))
        cosine = np.sqrt(1.0 - sine * sine)
        wi = rounded([sine, cosine * np.cos(angle), cosine * np.sin(angle)])
        weights = np.tile(w, 2 * count) / count
        shape = (len(wo), *wi.shape)
        return np.broadcast_to(wi, shape), np.broadcast_to(weights, shape[:2])


def _turned(direction: Array, inclination: float, azimuth: float) -> Array:
    x, y, z = direction.T
    theta, phi = np.arctan2(x, np.hypot(y, z)) + inclination, np.arctan2(y, z) + azimuth
    cosine = np.cos(theta)
    return np.stack([np.sin(theta), cosine * np.sin(phi), cosine * np.cos(phi)], axis=-1)


def _sides(rng: samples.Rng, count: int) -> Array:
    """Factors by which a random half of the directions is mirrored at the horizon, (count, 3)."""
    return np.stack([np.ones(count), np.ones(count), rng.choice([-1.0, 1.0], count)], axis=-1)


def in_lobes(rng: samples.Rng, wo: Array, inputs: dict[str, Array]) -> Array:
    """For each view, a light direction in a random lobe (R, TT or TRT), (N, 3)."""
    count = len(wo)
    lobe, chosen = rng.integers(0, 3, count), np.arange(count)
    v, s = (np.stack([inputs[name] for name in ROUGHNESSES])[lobe, chosen]).T
    # The inclination is normally distributed around an angle that the cuticle's tilt shifts.
    view, _ = section(wo.T, inputs["ior"])
    tilt = (2.0 - 3.0 * lobe) * np.pi * (inputs["cuticle_angle"] - 0.5)
    theta = -np.arcsin(np.clip(view.sin_o, -1.0, 1.0)) - tilt
    theta = theta + np.sqrt(np.minimum(v, 1.0)) * rng.standard_normal(count)
    # The azimuth has a logistic distribution.
    u = 1e-3 + 0.998 * rng.random(count)
    exit_angle = 2.0 * lobe * view.gamma_t - 2.0 * view.gamma_o + lobe * np.pi
    phi = np.arctan2(wo[:, 2], wo[:, 1]) + exit_angle + SCALE * s * np.log(u / (1.0 - u))
    cosine = np.abs(np.cos(theta))
    return rounded([np.sin(theta), cosine * np.cos(phi), cosine * np.sin(phi)])


HAIR = HairSpec(**mode_of(HAIR_NODE), inputs=INPUTS, errors=ERRORS)
