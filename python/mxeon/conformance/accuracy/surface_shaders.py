# SPDX-License-Identifier: Apache-2.0
"""Tolerances of surface shaders: the sums of those of their lobes, where these occur together."""

from mxeon.conformance.accuracy.bsdf import (
    COMPENSATION_ALBEDO,
    CONTY_KULLA_ALBEDO,
    ESS_FIT,
    LAYER_FIT,
    MICROFACET_VALUE,
    sum_of,
)
from mxeon.conformance.samples.measurement import absolute, mean_error, scaled
from mxeon.conformance.samples.tolerance import SCALED, Tolerance

# At most two lobes of microfacets lie over each other, each in a layer, with a sheen in another. The
# error of E_ss enters E by F (1 - F_ss), that of F by (1 - F0) (1 + F_ss k): at most 1 and 1.25.
PASSED = 1.25 * LAYER_FIT + ESS_FIT
LAYERS = 2 * PASSED + CONTY_KULLA_ALBEDO.value
VALUE = Tolerance(
    2 * MICROFACET_VALUE.value + LAYERS,
    SCALED,
    scaled,
    "two lobes of microfacets, each within 1e-3, and the throughputs of two of them, each within 2.9e-3, "
    "and of a sheen, within 1.6e-3, over bases of which no more than 1 comes out",
)
ALBEDO = Tolerance(
    sum_of(1024) + COMPENSATION_ALBEDO + LAYERS,
    "albedo",
    absolute,
    "the sum over 1024 directions, 1.7e-3 of all light; the compensation of the lobe that reflects most, "
    "1.9e-3; and the throughputs, each within 2.9e-3, and of a sheen, within 1.6e-3, which it reflects more "
    "or less as well",
)
MEAN = Tolerance(
    5e-4,
    "pi f cos or albedo, mean",
    mean_error,
    "the errors of fits and sums change their signs over views and materials: their means over 256 pairs "
    "and 64 views are 2.3e-4 at most; twice that, rounded up",
)
