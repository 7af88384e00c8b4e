# SPDX-License-Identifier: Apache-2.0
"""Tolerances of pbrlib's BSDF nodes: Burley, sheens, microfacets, and what combines or transmits."""

import math

from mxeon.conformance.nodes import kinds
from mxeon.conformance.samples.edge_cases import LEAST_COLOR82, LEAST_SHEEN, LEAST_TURNED, TURNED
from mxeon.conformance.samples.measurement import absolute, mean_error, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, SCALED, Tolerance, rounded_up

LEAST_ALPHA = 0.05  # of values whose tangent is turned: what rounds is divided by it
LEAST_COSINE = 0.1  # of the same

# Largest errors of the fits that shaders are held to, each found by its script in fits/.
ESS_FIT = 5e-4  # ggx_albedo.py: albedo of GGX where every facet reflects everything, E_ss
SMOOTH_ESS_FIT = 5.3e-5  # the same of smooth lobes, from a cosine of 0.05 on
FRESNEL_FIT = 3.6e-4  # fresnel_average.py: mean of a Fresnel curve, F_ss
LOBE_FIT = 3.2e-3  # ggx_cosine.py: albedo of GGX with a Fresnel curve
DIP_FIT = 5.9e-3  # ggx_cosine.py: what a full dip at 82 degrees adds to it
CONTY_KULLA_FIT = 1.5e-3  # conty_kulla_albedo.py: albedo of the Conty-Kulla sheen
SUM_OF_DIRECTIONS = 1.7  # error of a sum over N directions of an environment, times N: see sum_of
# Largest slope of a Fresnel curve in the cosine, 0.05 from a critical angle: at index 1.02, cosine 0.05.
FRESNEL_SLOPE = 7.3
LEAST_ESS = 1.0 - math.log(2.0)  # E_ss at alpha 1 along the normal
# Largest v / E_ss, v the value pi f cos of facets that reflect everything, or 1 if that is less, as
# errors of a compensation count: at alpha 0.58 and a cosine of 0.6.
SEEN_ESS = 1.58


def sum_of(directions: int) -> float:
    """Error of a sum over so many directions of an environment, drawn for a microfacet lobe.

    Measured on pictures of brushed metal in a furnace: 2.5e-2 of 64 directions, 5.1e-3 of 256, 1.4e-3 of
    1024.
    """
    return SUM_OF_DIRECTIONS / directions


def power_of(power_error: float, exponent: float) -> Tolerance:
    """Tolerance of a sheen's values, which are powers, on an engine whose own power is off by so much."""
    return Tolerance(
        rounded_up((32 + exponent) * ROUNDING + power_error),
        SCALED,
        scaled,
        f"32 roundings of float32, 2^-24 each, and one to the power of {exponent:.0f}, of the value or "
        f"of 1; and the error of the engine's own power in it, {power_error:.1e}; rounded up",
    )


DIFFUSE_VALUE = Tolerance(
    rounded_up((2 * 17 + 7) * ROUNDING),
    SCALED,
    scaled,
    "41 roundings of float32, 2^-24 each, of the value or of 1: 17 in each factor of Burley's, ten of "
    "them in the cosine of the half vector, and seven in the products; rounded up",
)
ZELTNER_VALUE = Tolerance(
    rounded_up(48 * ROUNDING),
    SCALED,
    scaled,
    "48 roundings of float32, 2^-24 each, of the value or of 1: an inverse fourth power takes the 8 of "
    "a length four times, and 16 beside them; rounded up",
)
CONTY_KULLA_VALUE = Tolerance(
    rounded_up((32 + 4 * 0.5 / LEAST_SHEEN) * ROUNDING),
    SCALED,
    scaled,
    "32 roundings of float32, 2^-24 each, and four in the logarithm of a sine, which enter times half "
    "the inverse of the roughness, at least 0.01; rounded up",
)
EXCHANGED = Tolerance(
    rounded_up(32 * ROUNDING),
    SCALED,
    scaled,
    "32 roundings of float32, 2^-24 each: the half vector has the same digits, and so has its power; rounded "
    "up",
)
# Error of a compensation in an albedo, of which E_ss is a factor.
COMPENSATION_ALBEDO = ESS_FIT / LEAST_ESS + FRESNEL_FIT * (1.0 - LEAST_ESS)
ROUGH_SUM = 5e-4  # error of a sum over 1024 directions for alpha from 0.3 on: measured as `sum_of`
COMPENSATION = (ESS_FIT + FRESNEL_FIT * (1.0 - LEAST_ESS)) / LEAST_ESS  # its error, relative
MICROFACET_VALUE = Tolerance(
    rounded_up(ESS_FIT * SEEN_ESS + FRESNEL_FIT * (SEEN_ESS - 1.0)),
    SCALED,
    scaled,
    "the fits of E_ss, 5e-4, and of F_ss, 3.6e-4, in 1 + F_ss (1 - E_ss) / E_ss: E_ss is least where "
    "values are small, so that at most 1.58 of the first and 0.58 of the second count; rounded up",
)
MICROFACET_MEAN = Tolerance(
    rounded_up(COMPENSATION),
    "albedo",
    absolute,
    "the same errors, relative, where E_ss is least, 1 - ln 2 = 0.31; rounded up",
)
CLOSED_ALBEDO = Tolerance(
    rounded_up(32 * ROUNDING),
    "albedo",
    scaled,
    "32 roundings of float32, 2^-24 each, of the albedo or of 1: 20 in the exponent of a Gaussian, "
    "times the largest t exp(-t^2 / 2), 0.6, and 20 beside it; rounded up",
)
CONTY_KULLA_ALBEDO = Tolerance(
    CONTY_KULLA_FIT + CLOSED_ALBEDO.value,
    "albedo",
    absolute,
    "the fit's 1.5e-3, and the roundings of an albedo in closed form",
)
MICROFACET_ALBEDO = Tolerance(
    rounded_up(LOBE_FIT + ESS_FIT / LEAST_ESS),
    "albedo",
    absolute,
    "the fit of the lobe's albedo, 3.2e-3, and that of E_ss in its compensation, 5e-4 over the least "
    "E_ss, 0.31; rounded up",
)
SCHLICK_THROUGHPUT = Tolerance(
    rounded_up(LOBE_FIT + (1.0 - LEAST_COLOR82) * DIP_FIT + ESS_FIT / LEAST_ESS),
    "albedo",
    absolute,
    "the fit of the lobe's albedo, 3.2e-3, half of that of the dip at 82 degrees, 5.9e-3, and that of "
    "E_ss in its compensation, 5e-4 over the least E_ss, 0.31; rounded up",
)
DIP = Tolerance(
    rounded_up((1.0 - LEAST_COLOR82) * DIP_FIT),
    "albedo",
    absolute,
    "half of the fit of the dip at 82 degrees, 5.9e-3, in which compensation is part; of what is white "
    "besides, fits have no effect; rounded up",
)
UNFITTED = Tolerance(
    0.78,
    "albedo",
    absolute,
    "the largest error of a cosine that is fitted to indices from 1.03 on, as docs/loading.md has it",
)
SMOOTH_PASSED = Tolerance(
    rounded_up(SMOOTH_ESS_FIT + (4 * FRESNEL_SLOPE + 16) * ROUNDING),
    "albedo",
    absolute,
    "the fit of E_ss of smooth lobes, 5.3e-5; four roundings of a cosine, 2^-24 each, times the largest "
    "slope of a Fresnel curve, 7.3; and 16 beside them; rounded up",
)
MICROFACET_ENVIRONMENT = Tolerance(
    rounded_up(max(sum_of(1024), COMPENSATION_ALBEDO + ROUGH_SUM)),
    "albedo",
    absolute,
    "the sum over 1024 directions of an environment, 1.7e-3, of lobes that lose little; of others the fits "
    "of E_ss, 5e-4 over the least, 0.31, and of F_ss, 3.6e-4 of 0.69, and the sum, 5e-4 from alpha 0.3 "
    "on; rounded up",
)
MICROFACET_PICTURE = Tolerance(
    rounded_up(COMPENSATION_ALBEDO + sum_of(256)),
    "albedo",
    absolute,
    "the fits of E_ss, 5e-4 over the least, 0.31, and of F_ss, 3.6e-4 of 0.69, and the sum over 256 "
    "directions of an environment, 6.7e-3; rounded up",
)
ANISOTROPIC_ALBEDO = Tolerance(
    rounded_up(COMPENSATION_ALBEDO + sum_of(1024)),
    "albedo",
    scaled,
    "the fits of E_ss, 5e-4 over the least, 0.31, and of F_ss, 3.6e-4 of 0.69, and the sum over 1024 "
    "directions of an environment, 1.7e-3; rounded up",
)
FLAT_FRAME = Tolerance(
    rounded_up(3 * 5 / TURNED[0] * ROUNDING),
    SCALED,
    scaled,
    "five roundings in each of three cosines, 2^-24 each, over the least, 1/4; rounded up",
)
MICROFACET_FRAME = Tolerance(
    rounded_up(2 * 2 * 5 * ROUNDING / (2 * TURNED[0] * LEAST_TURNED)),
    SCALED,
    scaled,
    "five roundings of each of two directions in a frame, 2^-24 each, over twice the least cosine, 1/4, and "
    "the least alpha, 0.1, times 2, the largest slope of the distribution as in `anisotropy`; rounded up",
)
SHAPE = Tolerance(
    rounded_up(2 * 64 * ROUNDING),
    "relative",
    absolute,
    "two values of 64 roundings of float32 each, 2^-24: the half vector of exact directions has no "
    "others; rounded up",
)
RETROREFLECTION = Tolerance(
    DIFFUSE_VALUE.value,
    SCALED,
    scaled,
    "one function of the same numbers but for signs: the 41 roundings of a value",
)
ANISOTROPY = Tolerance(
    rounded_up(2 * 2 * 2 * ROUNDING / (2 * LEAST_COSINE * LEAST_ALPHA)),
    SCALED,
    scaled,
    "two roundings of each of two turned directions, 2^-24 each, over twice the least cosine, 0.1, and the "
    "least alpha, 0.05, times 2: q^-4 of q^2 = h_z^2 + (h_x / alpha_x)^2 + (h_y / alpha_y)^2 has no larger "
    "slope; rounded up",
)

RINGS = Tolerance(
    0.01,
    "pi f cos",
    absolute,
    "six circles in place of the profile's integral: 9.3e-3 at most, straight towards or away from the "
    "light, where a whole circle comes into light at once; rounded up",
)
RINGS_MEAN = Tolerance(
    0.003,
    "pi f cos, mean",
    mean_error,
    "the errors of six circles change their sign over a sphere: their mean over what is seen of it is "
    "1.4e-3 at most, of all mean free paths; twice that, rounded up",
)
COMBINED_VALUE = Tolerance(
    rounded_up(2 * ZELTNER_VALUE.value + CLOSED_ALBEDO.value),
    SCALED,
    scaled,
    "two values, and a throughput between them",
)
COMBINED_ALBEDO = Tolerance(
    rounded_up(3 * CLOSED_ALBEDO.value),
    "albedo",
    scaled,
    "two albedos, and a throughput between them; of a sum in a mix over a base too, since the slopes of "
    "its albedo by the two are at most 1 and 2",
)
NESTED_VALUE = Tolerance(
    COMBINED_VALUE.value + ZELTNER_VALUE.value + CLOSED_ALBEDO.value,
    SCALED,
    scaled,
    "three values, of which a throughput of two albedos multiplies one",
)
FACTOR = Tolerance(ROUNDING, SCALED, scaled, "the same products, of a factor that is exact")
WHITE_FURNACE = Tolerance(
    4e-3,
    "light",
    absolute,
    "the light that a repaired layer over white may gain or lose, of which the quadrature takes 6e-4",
)


# Largest error of a probe's integrals of the equations, by its kind.
QUADRATURES = {
    kinds.CLOSED: 1e-8,
    kinds.SHEEN: 1e-8,
    kinds.FITTED: 2e-4,
    kinds.MICROFACET: 6e-4,
    kinds.SCHLICK: 6e-4,
    kinds.HAIR: 5e-6,
}


def integral_of(value: Tolerance, quadrature: float) -> Tolerance:
    """Tolerance of an integral of values, by the error of its quadrature on the equations."""
    return Tolerance(
        rounded_up(value.value + quadrature),
        "albedo",
        absolute,
        f"an average of values, each within {value.value:.2g}, and the error of the quadrature on "
        f"the equations, {quadrature:.0e}; rounded up",
    )


def layer_of(integral: Tolerance, throughput: Tolerance) -> Tolerance:
    """Tolerance of the light of a lobe over a white base."""
    return Tolerance(
        rounded_up(integral.value + throughput.value),
        "light",
        absolute,
        f"an albedo within {integral.value:.2g}, and a throughput within {throughput.value:.2g}; "
        "rounded up",
    )


def clear_of(passed: Tolerance) -> Tolerance:
    """Tolerance of the light that microfacets reflect and transmit."""
    return Tolerance(
        rounded_up(MICROFACET_ENVIRONMENT.value + passed.value),
        "light",
        absolute,
        f"a reflected albedo within {MICROFACET_ENVIRONMENT.value:.2g}, and light that passes within "
        f"{passed.value:.2g}; rounded up",
    )
