# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of nodes that emit light, by kind of probe."""

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.emission import EXPONENTS
from mxeon.conformance.samples.batch import RIM
from mxeon.conformance.samples.measurement import scaled
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up

UNIT, EXITANCE = "radiance", "exitance / pi"
QUADRATURE = 1e-6  # of the weighted sum on the equations
CONE_QUADRATURE = 3e-8  # of that of cones, at cosines of 24 bits

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
