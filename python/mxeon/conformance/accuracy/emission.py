# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of nodes that emit light, by kind of probe, with those of the engine's own functions."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.emission import EXPONENTS
from mxeon.conformance.nodes.media import MediumSubject
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.samples.batch import RIM, SEED, Array
from mxeon.conformance.samples.measurement import scaled
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up
from mxeon.hosts.base import Host

UNIT, EXITANCE = "radiance", "exitance / pi"
QUADRATURE = 1e-6  # of the weighted sum on the equations
CONE_QUADRATURE = 3e-8  # of that of cones, at cosines of 24 bits
COUNT = 1 << 14
FUNCTIONS = """float mxeon_power(float x, float y)
{
    return pow(x, y);
}
float mxeon_exponential(float x, float y)
{
    return exp(-x) + 0.0 * y;
}
"""


UNIFORM_RADIANCE = Tolerance(
    rounded_up(6 * ROUNDING),
    UNIT,
    scaled,
    "six roundings of float32, 2^-24 each: three of each emission and its factor; rounded up",
)
POWER_RADIANCE = Tolerance(
    rounded_up((8 + EXPONENTS[1]) * ROUNDING),
    UNIT,
    scaled,
    "eight roundings of float32, 2^-24 each, and one to the power of 8; and the error of the engine's "
    "own power; rounded up",
)
CONE_RADIANCE = Tolerance(
    rounded_up(12 * ROUNDING),
    "radiance and its slope",
    scaled,
    "twelve roundings of float32, 2^-24 each, relative to 1 and the slope of the falloff in the cosine: "
    "ten of 1 - cos of both angles, of which a view takes 1 - mu in all, three of mu, and two of "
    "differences; the eight of the step count against 1; rounded up",
)
PICTURE_RADIANCE = Tolerance(
    rounded_up(5 * 6 * ROUNDING / RIM + 8 * ROUNDING),
    UNIT,
    scaled,
    "three roundings of 2^-23 in the position of a pixel's point, over the smallest cosine judged, 0.05, "
    "times the largest slope of the materials' radiance, 5; and eight roundings beside; rounded up",
)
TRANSMITTANCE = Tolerance(
    rounded_up(12 * ROUNDING),
    "transmittance",
    scaled,
    "twelve roundings of float32, 2^-24 each: of the exponential of a rounded sum, of a product and of "
    "the quotient of two such values; and twice the error of the engine's own exponential, and of its power "
    "where two media are combined; rounded up",
)
OPACITY = Tolerance(
    rounded_up(3 * ROUNDING),
    UNIT,
    scaled,
    "a product and two sums with 0 of float32, 2^-24 each; rounded up",
)
RADIANCES = {
    kinds.EMISSION: UNIFORM_RADIANCE,
    kinds.POWER_EMISSION: POWER_RADIANCE,
    kinds.CONE_EMISSION: CONE_RADIANCE,
}
CONE_EXITANCE = Tolerance(
    rounded_up((8 + 2 * 10 * 0.25) * ROUNDING + CONE_QUADRATURE),
    EXITANCE,
    scaled,
    "an average of radiances, each of eight roundings of float32, 2^-24 each; ten of the cosine of an "
    "angle, which shift the falloff by 1 - mu of them at a slope of 2 mu; and the error of the "
    f"quadrature on the equations, {CONE_QUADRATURE:.0e}; rounded up",
)
EXITANCES = {
    kind: Tolerance(
        rounded_up(tolerance.value + QUADRATURE),
        EXITANCE,
        scaled,
        f"an average of radiances, each within {tolerance.value:.2g}, and the error of the quadrature "
        f"on the equations, {QUADRATURE:.0e}; rounded up",
    )
    for kind, tolerance in RADIANCES.items()
} | {kinds.CONE_EMISSION: CONE_EXITANCE}


def widen_for_functions(tolerance: Tolerance, subject: Subject, kind: str, host: Host) -> Tolerance:
    """Tolerance of an emission on a host, with the errors of the engine's own functions."""
    if kind == kinds.POWER_EMISSION:
        return replace(tolerance, value=rounded_up(tolerance.value + power_error(host)))
    if kind == kinds.MEDIUM:
        error = 2.0 * exponential_error(host)
        if isinstance(subject, MediumSubject) and subject.combined:
            error += 2.0 * power_error(host)
        return replace(tolerance, value=rounded_up(tolerance.value + error))
    return tolerance


@lru_cache(maxsize=16)
def power_error(host: Host) -> float:
    """Error of the engine's own power of numbers in [0, 1], beside its rounding."""
    rng = np.random.default_rng(SEED)
    base, exponent = (
        each.astype(np.float32).astype(np.float64)
        for each in (rng.random(COUNT), rng.uniform(*EXPONENTS, COUNT))
    )
    return _beside(base**exponent, host.execute(FUNCTIONS, "mxeon_power", base, exponent)[:, 0])


@lru_cache(maxsize=16)
def exponential_error(host: Host) -> float:
    """Error of the engine's own exp(-x) for x in [0, 8], beside its rounding."""
    depth = np.linspace(0.0, 8.0, COUNT).astype(np.float32).astype(np.float64)
    return _beside(np.exp(-depth), host.execute(FUNCTIONS, "mxeon_exponential", depth, depth)[:, 0])


def _beside(exact: Array, values: Array) -> float:
    """Largest error beside one rounding of 1."""
    return max(float(np.abs(values - exact).max()) - ROUNDING, 0.0)
