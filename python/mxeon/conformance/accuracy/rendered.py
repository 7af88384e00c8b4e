# SPDX-License-Identifier: Apache-2.0
"""Tolerances of a renderer's closures, for pairs that a camera and a light show."""

import math

from mxeon.conformance.accuracy.diffuse import FAST_ARC_COSINE
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.samples.batch import RIM
from mxeon.conformance.samples.edge_cases import LEAST_TURNED
from mxeon.conformance.samples.measurement import absolute, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, SCALED, Tolerance, rounded_up
from mxeon.hosts.base import Host
from mxeon.hosts.pairs import DISTANCE, JITTER, PIXEL
from mxeon.hosts.testrender.scenes import EYE, NEAREST

FLAT_KINDS = (kinds.DIFFUSE, kinds.CLOSED, kinds.SUBSURFACE)  # of lobes without a peak
ANGLE = 3.0 * EYE / NEAREST * ROUNDING  # of a point, which float32 holds along its ray
FLAT = Tolerance(
    rounded_up(8.0 * ANGLE + FAST_ARC_COSINE),
    SCALED,
    scaled,
    "three roundings of float32, 2^-24 each, of a point at the distance 40, seen from a light as near as 1/2, "
    "times 8, the largest slope of the diffuse models; 4.6e-5 for OpenImageIO's fast arc cosine; rounded up",
)
SHARP = Tolerance(
    rounded_up((2.0 / LEAST_TURNED + 3.0) * ANGLE + FAST_ARC_COSINE),
    SCALED,
    scaled,
    "the same angle times 23: 20, twice over the least alpha, 0.1, and 3 for Fresnel's curve, shadowing and "
    "the cosine; 4.6e-5 for OpenImageIO's fast functions; rounded up",
)
TURN = (
    JITTER * PIXEL / (RIM * DISTANCE)
)  # of a light, seen from a point of a triangle that is steep
TRACED_FLAT = Tolerance(
    rounded_up(8.0 * TURN),
    SCALED,
    scaled,
    "a point lies up to 0.007 pixels of 1/32 beside the middle of its pixel, and 20 times as far along the ray "
    "where the cosine of the view is 0.05, seen from a light at the distance 256, times 8, the largest slope "
    "of the diffuse models; rounded up",
)
TRACED_SHARP = Tolerance(
    rounded_up((2.0 / LEAST_TURNED + 3.0) * TURN),
    SCALED,
    scaled,
    "the same angle times 23: 20, twice over the least alpha, 0.1, and 3 for Fresnel's curve, shadowing and "
    "the cosine; rounded up",
)
BELOW = Tolerance(
    rounded_up(4.0 * 16.0 * ANGLE + FAST_ARC_COSINE),
    SCALED,
    scaled,
    "the same angle times 16, by the lobes above, in four values; and the fast arc cosine; rounded up",
)
VIEWS, PIXELS = 8, 1 << 12  # of a probe, and of a picture of them
NOISE = Tolerance(
    rounded_up(5.0 * 0.01 / math.sqrt(PIXELS / VIEWS)),
    "albedo",
    absolute,
    "five standard errors of the mean of 512 pixels, each of 64 paths: measured, a pixel of the noisiest "
    "material is off by 0.01 rms; rounded up",
)
PASSED = Tolerance(
    2e-3,
    "albedo",
    absolute,
    "testrender reads albedos from tables: measured, a white dielectric's is off by 1e-3",
)
INTEGRAL = Tolerance(
    rounded_up(SHARP.value + 1.2e-3),
    "albedo",
    absolute,
    "an average of values, no worse than the worst; and 1.2e-3, by which 32 x 32 nodes miss the integral of "
    "the equations, with those next to the view moved by up to 0.08; rounded up",
)
LIGHT = Tolerance(
    rounded_up(INTEGRAL.value + PASSED.value),
    "albedo",
    absolute,
    "an integral of values, and a throughput",
)


def widen_for_place(tolerance: Tolerance, subject: Subject, kind: str, host: Host) -> Tolerance:
    """Tolerance of values of microfacets, which a point beside the middle of its pixel has as well."""
    traced = kind.startswith(kinds.TRACED)
    return max(tolerance, TRACED_SHARP, key=lambda each: each.value) if traced else tolerance
