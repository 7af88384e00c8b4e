# SPDX-License-Identifier: Apache-2.0
"""Tolerances of closures, whose arguments OSL prints and the models evaluate in float64."""

from mxeon.conformance.samples.measurement import scaled
from mxeon.conformance.samples.tolerance import ROUNDING, SCALED, Tolerance, rounded_up

ARGUMENTS = Tolerance(
    ROUNDING,
    SCALED,
    scaled,
    "nine digits tell a float32 to its last bit, so that arguments and weights are those of the document; "
    "the models round in float64, 2^-53, and the sharpest lobe, of alpha 1e-4, takes that 1e8 times: "
    "less than one rounding of float32, 2^-24",
)
GRAPH = Tolerance(
    rounded_up(4 * 16 * ROUNDING),
    SCALED,
    scaled,
    "16 roundings of float32, 2^-24 each, on the way from an input to an argument, times 4, as the logarithm "
    "of a distribution changes with that of alpha; rounded up",
)
