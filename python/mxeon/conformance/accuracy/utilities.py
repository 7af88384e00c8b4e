# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of the utility nodes, by output.

An error is relative to the largest component where that exceeds 1; of an artistic index it is in units
in which its roundings are alike, see `measures`.
"""

from mxeon.conformance.samples.measurement import absolute, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up

UNIT = "relative above 1"
ALPHA = Tolerance(
    rounded_up((12 + 0.25 / 0.02) * ROUNDING),
    "alpha",
    absolute,
    "12 roundings of float32, 2^-24 each, and that of 0.98, half of one, over 2 (1 - 0.98) in the "
    "aspect; the least alpha, 1e-8, is less than either; rounded up",
)
DUAL = Tolerance(
    rounded_up(2 * ROUNDING),
    "alpha",
    absolute,
    "two roundings of float32, 2^-24 each, of numbers up to 1; rounded up",
)
INDEX = Tolerance(
    rounded_up(16 * ROUNDING),
    "n (1 - sqrt(r))^2",
    absolute,
    "in n_max four roundings, 2^-24 each, over 1 - sqrt(r), and six beside it, six in the mix, each of "
    "n_max, which is 1 in this unit at most; rounded up",
)
EXTINCTION = Tolerance(
    rounded_up((8 + 16 + 4) * ROUNDING),
    "k^2 (1 - r) / (n_max + 1)^2",
    absolute,
    "eight roundings, 2^-24 each, of the terms whose difference k^2 is, 16 of n, times a slope of 1 in "
    "this unit, and four of 1 - r and of the root; rounded up",
)
ROUND_TRIP = Tolerance(
    rounded_up(16 * ROUNDING),
    "reflectance",
    absolute,
    "k^2 makes up for the error of n, so that 16 roundings, 2^-24 each, of terms that are 1 at most "
    "are left; rounded up",
)
BLACKBODY_FIT = 1.9e-4  # see tools/fits/blackbody.py
BLACKBODY = Tolerance(
    rounded_up(BLACKBODY_FIT),
    UNIT,
    scaled,
    "what eonlib's fits of X and Z, 2.6e-5 and 6.7e-5, make in red, 1.2e-4, and in a luminance of "
    "channels that are clipped, 7e-5; rounded up",
)
OSL_BLACKBODY = Tolerance(
    4e-3,
    UNIT,
    scaled,
    "OSL's function blackbody() has an observer from 380 nm to 780 nm, a table over the temperature and "
    "primaries of its own, which differ by 3.5e-3 at 973 K, where green enters, and by 2e-3 above 1100 K",
)
TOLERANCES = {
    "roughness_anisotropy": ALPHA,
    "roughness_dual": DUAL,
    "glossiness_anisotropy": ALPHA,
    "artistic_ior, ior": INDEX,
    "artistic_ior, extinction": EXTINCTION,
}


def power_tolerance(error: float) -> Tolerance:
    """Tolerance of the roughnesses of hair, with the error of the engine's own 20th power."""
    return Tolerance(
        rounded_up(24 * ROUNDING + 1.5 * error),
        UNIT,
        scaled,
        f"24 roundings of float32, 2^-24 each, and the error of the engine's own power, {error:.1e}, "
        "times 2 x 3.7 / 5.24; rounded up",
    )


def melanin_tolerance(error: float) -> Tolerance:
    """Tolerance of the absorption of melanin, with the error of the engine's own logarithm."""
    return Tolerance(
        rounded_up(16 * ROUNDING + 14.0 * error),
        UNIT,
        scaled,
        f"16 roundings of float32, 2^-24 each, and the error of the engine's own logarithm, {error:.1e}, "
        "times the other factor, 9.2 of the concentration and 4.6 of the colors; rounded up",
    )


def color_tolerance(error: float) -> Tolerance:
    """Tolerance of the absorption of a color, with the error of the engine's own logarithm."""
    return Tolerance(
        rounded_up(2 * 12 * ROUNDING + 2.0 * error),
        UNIT,
        scaled,
        f"a square of 12 roundings of float32, 2^-24 each, and the error of the engine's own logarithm, "
        f"{error:.1e}, times 2 x 6.9 / 3.4^2; rounded up",
    )
