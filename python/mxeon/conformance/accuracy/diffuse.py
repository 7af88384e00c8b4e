# SPDX-License-Identifier: Apache-2.0
"""Tolerances of rough diffuse nodes and of what pictures show, as the expressions that derivations describe.

The tests and the benchmarks that judge the same quantities import them.
"""

import math

from mxeon.conformance.samples.batch import LOBE_RIM, RIM
from mxeon.conformance.samples.edge_cases import TURNED
from mxeon.conformance.samples.measurement import absolute, mean_error, relative, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up
from mxeon.conformance.samples.uneven_environment import SKY_ROWS, SLOPE
from mxeon.shaders.facets import NARROWEST

HALF_ROUNDING = 2.0**-11  # of float16
ARC_SINE = 4e-4  # largest error of an engine's arc sine: llvmpipe's, of which others have a tenth
FILTER_STEP = 2.0**-8  # of a texel: engines keep the weights of filters in eight bits
FAST_ARC_COSINE = 4.6e-5  # largest error of OpenImageIO's fast_acos, by its source
HALF_CUT = 2.0**-10  # relative error of float16 where digits are cut off, as llvmpipe does
FACET_PIXELS = 7169  # of a picture of the polyhedron that lie in one facet and are judged
LOSS_FIT = 2.7e-7  # relative error of the fit of FON's loss H, see fits/


def ray_error(rim: float) -> float:
    """Relative error of f cos in a picture of Cycles, where both cosines are at least `rim`.

    A point is a ray's origin plus its length, both at most 2: three roundings of 2^-23 together. A
    ray that grazes divides them by its cosine, and cos(theta_i), relative to itself, by the other.
    The profile takes a roughness below 1e-5 for 0: another 1e-5.
    """
    return rounded_up(3.0 * 2.0 * ROUNDING / rim**2 + 1e-5)


def mean_noise(pixels: int) -> float:
    """Error of the mean of so many pixels of Cycles in an environment, of 256 samples each.

    Measured over seeds 0 to 15 at roughness 1 and reflectance 1: a pixel is off by 1.3e-3 rms, and
    the mean of 3212 pixels has a standard deviation of 3.1e-5, 1.34 times that of independent ones.
    """
    return rounded_up(4.0 * 1.4 * 1.3e-3 / math.sqrt(pixels))


def count_of(unit: str) -> Tolerance:
    """Tolerance of a count, of which there must be none."""
    return Tolerance(0.0, unit, absolute, "a count")


def difference_of(tolerance: Tolerance) -> Tolerance:
    """Tolerance of the difference of two values, relative to the largest such difference."""
    derivation = f"two values, each within {tolerance.value:.2g}, over a difference of 0.4"
    return Tolerance(rounded_up(2.0 * tolerance.value / 0.4), "relative", absolute, derivation)


def direction_of(sine_error: float) -> Tolerance:
    """Tolerance of sampled directions on an engine whose own sine is off by so much."""
    return Tolerance(
        rounded_up(16 * ROUNDING + 4.0 * sine_error),
        CONDITIONED,
        absolute,
        f"16 roundings of float32, 2^-24 each, and four times the error of the engine's own sine and "
        f"cosine, {sine_error:.1e}, which turn a direction twice; rounded up",
    )


VALUE = Tolerance(
    rounded_up(14 * 2.0 * ROUNDING + 2 * 0.5 * LOSS_FIT),
    "pi f cos",
    absolute,
    "14 roundings of float32, 2^-24 each, of numbers up to 2, and two fits of H, 2.7e-7 each, times "
    "the multiple-scattering part, at most 1/2; rounded up",
)
RECIPROCITY = Tolerance(VALUE.value, "pi f cos cos", absolute, VALUE.derivation)
INTEGRAL = Tolerance(
    VALUE.value, "albedo", absolute, "an average of values: no worse than the worst"
)
ENVIRONMENT = Tolerance(
    rounded_up((12 + 2 + 2) * 1.02 * ROUNDING),
    "albedo",
    absolute,
    "16 roundings of float32, 2^-24 each, of numbers up to 1.02: 12 in the longest chain, two in the "
    "cosine, and two for the fit of H, whose 2.7e-7 enters times 0.29; rounded up",
)
LOSS = Tolerance(
    rounded_up(LOSS_FIT + 12 * ROUNDING),
    "relative",
    relative,
    "the fit's 2.7e-7 and 12 roundings of float32, 2^-24 each; rounded up",
)
FRAME = Tolerance(
    rounded_up(2 * 14 * 2.0 * ROUNDING + 2 * 5 * (1.0 / TURNED[0] + 3.0 + 2.0) * ROUNDING),
    "pi f cos or albedo",
    absolute,
    "two values of 14 roundings each, 2^-24 of numbers up to 2; and in each of two cosines of at "
    "least 1/4 and at most 0.95 five more, two in unit vectors and three in a product, which enter "
    "times 4 by s / t, times 3 by a sine, and times 2 by s and the cosine itself; rounded up",
)
SURROUNDINGS = Tolerance(
    rounded_up(
        SLOPE * (math.sqrt(2.0) * math.pi / SKY_ROWS * FILTER_STEP + ARC_SINE) + HALF_ROUNDING
    ),
    "irradiance",
    absolute,
    "half floats, 2^-11, of numbers up to 1; and the slope of the map, 1/2, times 2^-8 of a texel, pi / 128 "
    "high and wide, whose middle is read, and times an engine's error of an arc sine, 4e-4; rounded up",
)
CONDITIONED = "over 1, the value, and its change with each argument"
PART = Tolerance(
    rounded_up(16 * ROUNDING),
    CONDITIONED,
    absolute,
    "16 roundings of float32, 2^-24 each; rounded up",
)
DENSITY = Tolerance(
    rounded_up(48 * ROUNDING),
    CONDITIONED,
    absolute,
    "48 roundings of float32, 2^-24 each: an inverse fourth power takes the 8 of an entry of a matrix "
    "four times, and 16 beside them; rounded up",
)
INVERSION = Tolerance(
    rounded_up(3 * 5e-7 + 12 * ROUNDING),
    "reflectance",
    absolute,
    "three constants of six decimals, 5e-7 each, and 12 roundings of float32, 2^-24 each, of numbers "
    "up to 1; rounded up",
)
ROUND_TRIP = Tolerance(
    2.0 * INVERSION.value,
    "albedo",
    absolute,
    "an albedo grows at most twice as fast as the reflectance",
)
LAMBERT = Tolerance(
    rounded_up(8 * ROUNDING), "pi f cos", absolute, "8 roundings of float32, 2^-24 each; rounded up"
)
ZERO = Tolerance(0.0, "pi f cos", absolute, "a product with 0 is 0 in any precision")
OPAQUE = Tolerance(0.0, "throughput", absolute, "a constant has no roundings")
LOBE = Tolerance(
    (16 / LOBE_RIM**2 + 32 + 4 * 48) * ROUNDING,
    "pi f cos",
    absolute,
    "480 roundings of float32, 2^-24 each: 16 in the position of a pixel's point, over the square of "
    "the smallest cosine judged, 1/4; 32 in the lobe; four in sums that other lobes make 48 times as "
    "large",
)
CYCLES_RAY = Tolerance(
    ray_error(RIM),
    "relative",
    relative,
    "float32 position of a pixel's point, three roundings of 2^-23, over the square of the smallest "
    "cosine judged, 0.05; 1e-5 for the roughness that is taken for 0; rounded up",
)
CYCLES_NOISE = Tolerance(
    mean_noise(12_836),
    "mean albedo",
    mean_error,
    "four standard errors of the mean of a picture's 12 836 pixels: 1.3e-3 a pixel with 256 samples, "
    "and 1.4 times as much as independent pixels have (both measured over seeds); rounded up",
)

EXACT = Tolerance(
    rounded_up(14 * 2.0 * ROUNDING + 2 * 5 * (1.0 / RIM + 2.0) * ROUNDING),
    "pi f cos",
    absolute,
    "14 roundings of float32, 2^-24 each, of numbers up to 2; and in each of two cosines five more, "
    "two in the unit normal and three in a product, which enter times 20 by s / t, where both cosines "
    "are at least 0.05, and times 2 by s and the cosine itself; rounded up",
)
EXACT_SURROUNDINGS = Tolerance(
    rounded_up((12 + 2 + 2 + 5) * 1.02 * ROUNDING),
    "albedo",
    absolute,
    "21 roundings of float32, 2^-24 each, of numbers up to 1.02: 12 in the longest chain, two in the "
    "surroundings, which are 1 in any format, two in a polynomial, and five in the cosine, times 1; "
    "rounded up",
)

# Pictures that are kept as half floats.
HALF = Tolerance(
    HALF_CUT + (28 + 2 * 5 * (1.0 / RIM + 2.0)) * ROUNDING,
    "relative",
    relative,
    "half floats, cut off, 2^-10; 14 roundings of float32, 2^-24 each, twice for numbers up to 2; and in "
    "each of two cosines five more, over the smallest judged, 0.05, and twice for s",
)
HALF_SURROUNDINGS = Tolerance(
    2.0 * HALF_CUT + EXACT_SURROUNDINGS.value,
    "albedo",
    absolute,
    "half floats, cut off, 2^-10, in the map of irradiances and in the picture; and 21 roundings of "
    "float32, 2^-24 each, of numbers up to 1.02",
)
HALF_LOBE = Tolerance(
    4.0 * 48.0 * HALF_CUT / 2.0 + LOBE.value,
    "pi f cos",
    absolute,
    "half floats, 2^-10, in four pictures, which other lobes make 48 times as large: two of them cut off "
    "alike, so that half of it counts; and the roundings of a lobe in float32",
)

FACETS = Tolerance(
    rounded_up(8 * 2.0 * math.sqrt(3.0) * ROUNDING / NARROWEST),
    "pi f cos",
    absolute,
    "the normal of a facet: three float32 vertices, each off by sqrt(3) 2^-24, over the narrowest edge, "
    "0.0245, twice for the edge's two ends; times 8, the largest slope of the diffuse models; rounded up",
)
COARSE_FACETS = Tolerance(
    rounded_up(2.0**-6 + 2.4e-3),
    "pi f cos or albedo",
    absolute,
    "EEVEE keeps light in 32 bits for three channels, of which blue has the fewest: five below the "
    "leading one, cut off, of numbers up to 1; and 2.4e-3 for its packed normals, measured; rounded up",
)
FACET_NOISE = Tolerance(
    rounded_up(4.0 * 0.0716 / math.sqrt(FACET_PIXELS)),
    "mean albedo",
    mean_error,
    "four standard errors of the mean of a picture's 7169 pixels, each of 64 paths: measured over 12 "
    "seeds, a pixel is off by 0.0716 rms in Mitsuba and 0.0625 in LuxCoreRender; rounded up",
)
FACET_PAIRS = Tolerance(
    rounded_up(16 * 2.5**2 * ROUNDING),
    "pi f cos",
    absolute,
    "16 roundings of float32, 2^-24 each, of numbers up to 25/4, the product of Burley's two factors; "
    "a coat of alpha 0.5 and index 1.5 has no more than 4, facets of alpha 0.5625 of which half are metal "
    "have no more than 3; rounded up",
)

CHI_SQUARE = Tolerance(
    5.0,
    "standard deviations",
    absolute,
    "a right sampler exceeds 5 standard deviations once in 3.5 million times",
)
OWN_DENSITY = Tolerance(
    rounded_up(48 * 2.0**3 * ROUNDING),
    "1/sr, relative above 1",
    scaled,
    "48 roundings of float32, 2^-24 each, as of any density; the differences in the transformed "
    "direction, whose fourth power it has, lose up to three bits; rounded up",
)

# Pictures of the other BSDF nodes of pbrlib. A ray's point is off by an angle, by which the logarithm
# of a lobe changes at most LOBE_SLOPE times as fast: twice 1 / alpha of a distribution, whose alpha is
# at least 0.4, and 3 for Fresnel's curve, shadowing and the cosine.
LOBE_SLOPE = 2.0 / 0.4 + 3.0


def drawn_of(value: Tolerance, cut: float = 0.0) -> Tolerance:
    """Tolerance of a node's picture with exact points: of its value or albedo, and of the pixels."""
    half = f"; half floats, cut off, {cut:.1e}" if cut else ""
    return Tolerance(
        rounded_up(value.value + LOBE_SLOPE * 2 * 5 / RIM * ROUNDING) + cut,
        value.unit,
        scaled,
        f"a number within {value.value:.2g}; in each of two cosines five roundings of float32, 2^-24, over "
        f"the smallest judged, 0.05, times 8: 5, twice over the least alpha, and 3; rounded up{half}",
    )
