# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of the hair node."""

import math

from mxeon.conformance.checks.hair.regions import REGIONS
from mxeon.conformance.checks.hair.subjects import LEAST_SCALE, LEAST_VARIANCE
from mxeon.conformance.checks.measures import absolute, scaled
from mxeon.conformance.checks.special import LEAST_TURNED
from mxeon.conformance.checks.tolerance import ROUNDING, Tolerance, rounded_up
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
HAIR_REGIONS = {key: _value(row.variances[0], row.scales[0]) for key, row in REGIONS.items()}
HAIR_FRAME = Tolerance(
    error_of(LEAST_TURNED**2, LEAST_TURNED, 2 * (ANGLE + 5)),
    UNIT,
    scaled,
    "two values, in which five roundings of each product of turned vectors come to those of an "
    "angle; rounded up",
)
HAIR_ALBEDO = Tolerance(
    rounded_up(CHAIN * ROUNDING),
    "albedo",
    absolute,
    f"{CHAIN} roundings of float32, 2^-24 each, of numbers up to 1; rounded up",
)
