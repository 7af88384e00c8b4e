# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of the hair node."""

import math

import numpy as np

from mxeon.conformance.nodes.hair import LEAST_SCALE, LEAST_VARIANCE, WIDE_SCALE, WIDE_VARIANCE
from mxeon.conformance.nodes.hair_regions import REGIONS, Region
from mxeon.conformance.samples.edge_cases import LEAST_TURNED
from mxeon.conformance.samples.measurement import absolute, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up
from mxeon.models.hair.formulas import SCALE, azimuthal, bessel_scaled

UNIT = "pi f, relative above 1"
LARGEST = 1e5  # of pi f, so that a lobe falls to 1 within REACH
REACH = math.sqrt(2.0 * math.log(LARGEST))  # times sqrt(v)
ANGLE, CHAIN = 12, 48  # roundings of an angle, and of all that follows
POINT, TURN = 4, 6  # roundings of the points between which M takes a distance, and of a tilt
MOST_SINE = 0.9  # largest sine of the views of REGIONS


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


def largest(variance: float, scale: float) -> float:
    """pi f of a lobe of one channel where it is largest, for a view whose sine is at most 0.9."""
    cosine2 = np.array(1.0 - MOST_SINE**2)
    M = bessel_scaled(cosine2 / variance) / (-variance * math.expm1(-2.0 / variance))
    N = azimuthal(np.zeros(1), np.array(scale))
    return float(math.pi * (M * N).max())


def _region(row: Region) -> Tolerance:
    """Tolerance of views whose lobes have a largest value: the error is that of the value or of 1."""
    variance, scale = row.variances[0], row.scales[0]
    peak = largest(variance, scale)
    reach = math.sqrt(2.0 * math.log(peak)) if peak > math.e**0.5 else peak * math.exp(-0.5)
    angle = POINT + TURN * (row.tilt > 0.0)
    most = min(peak, 1.0)
    error = angle * reach / math.sqrt(variance) + most * (ANGLE / (SCALE * scale) + CHAIN)
    return Tolerance(
        float(rounded_up(error * ROUNDING)),
        UNIT,
        scaled,
        f"of a lobe of at most {peak:.2g}: {angle} roundings of float32, 2^-24 each, in the place of M "
        f"times its slope, {reach:.2g} / sqrt({variance:g}), up to where the lobe falls to 1; and of "
        f"the value or of 1, {ANGLE} in the angle of N over {SCALE:.2f} {scale:g}, and {CHAIN}; "
        "rounded up",
    )


HAIR_REGIONS = {key: _region(row) for key, row in REGIONS.items()}
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
