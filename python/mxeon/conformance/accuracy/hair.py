# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of the hair node."""

import math

from mxeon.conformance.nodes.hair import LEAST_SCALE, LEAST_VARIANCE, WIDE_SCALE, WIDE_VARIANCE
from mxeon.conformance.samples.edge_cases import LEAST_TURNED
from mxeon.conformance.samples.measurement import absolute, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up
from mxeon.models.hair.formulas import SCALE

UNIT = "pi f, relative above 1"
LARGEST = 1e5  # of pi f, so that a lobe falls to 1 within REACH
REACH = math.sqrt(2.0 * math.log(LARGEST))  # times sqrt(v)
ANGLE, CHAIN = 12, 48  # roundings of an angle, and of all that follows


def error_of(variance: float, scale: float, angle: float = ANGLE) -> float:
    """Error of pi f of lobes that are no narrower, where an angle has so many roundings.

    The logarithm of M changes by at most REACH / sqrt(v) in an angle, and that of N by 1 / s'.
    """
    slope = REACH / math.sqrt(variance) + 1.0 / (SCALE * scale)
    return float(rounded_up((slope * angle + CHAIN) * ROUNDING))


def _value(variance: float, scale: float) -> Tolerance:
    return Tolerance(
        error_of(variance, scale),
        UNIT,
        scaled,
        f"{CHAIN} roundings of float32, 2^-24 each, of the value or of 1; and {ANGLE} in an angle, times "
        f"the slope of the logarithm: {REACH:.1f} / sqrt({variance:g}) of M, which falls from 1e5 to 1 "
        f"within as many sqrt(v), and 1 / ({SCALE:.2f} {scale:g}) of N; rounded up",
    )


HAIR_VALUE = _value(LEAST_VARIANCE, LEAST_SCALE)

BESSEL_FIT = 5e-7  # of the shader's I_0, relative: [AbramowitzStegun1964], 9.8.1 and 9.8.2
HAIR_REGION = Tolerance(
    rounded_up(BESSEL_FIT + (12 + 4) * ROUNDING),
    "pi f and its slopes",
    absolute,
    "relative to pi f, or 0.01, and its slopes in both inclinations and both azimuths: the fit of I_0, "
    "5e-7; twelve roundings of float32, 2^-24 each, of factors and exponents; and four in each angle; "
    "rounded up",
)
HAIR_FRAME = Tolerance(
    error_of(LEAST_TURNED**2, LEAST_TURNED, 2 * (ANGLE + 5)),
    UNIT,
    scaled,
    "two values, in which five roundings of each product of turned vectors come to those of an "
    "angle; rounded up",
)
# Mean slopes of the logarithms of a Gaussian and of a logistic function.
MEAN_SLOPE = math.sqrt(2.0 / (math.pi * WIDE_VARIANCE)) + 0.5 / (SCALE * WIDE_SCALE)
HAIR_MEAN = Tolerance(
    float(rounded_up((MEAN_SLOPE * ANGLE + CHAIN) * ROUNDING)),
    UNIT,
    scaled,
    f"of an integral: {CHAIN} roundings of float32, 2^-24 each, and {ANGLE} in an angle, times the mean "
    f"slope of the logarithm, sqrt(2 / pi v) of M and 1 / 2 s' of N, of lobes from v = {WIDE_VARIANCE:g} "
    f"and s = {WIDE_SCALE:g} on; rounded up",
)
HAIR_ALBEDO = Tolerance(
    rounded_up(CHAIN * ROUNDING),
    "albedo",
    absolute,
    f"{CHAIN} roundings of float32, 2^-24 each, of numbers up to 1; rounded up",
)
