# SPDX-License-Identifier: Apache-2.0
"""Tolerances of surface shaders: the sums of those of their lobes."""

from mxeon.conformance.accuracy.bsdf import CONTY_KULLA_ALBEDO, MICROFACET_ALBEDO, MICROFACET_VALUE
from mxeon.conformance.samples.measurement import absolute, scaled
from mxeon.conformance.samples.tolerance import SCALED, Tolerance

# At most two lobes of microfacets lie over each other, each in a layer, with a sheen in another.
LAYERS = 2 * MICROFACET_ALBEDO.value + CONTY_KULLA_ALBEDO.value
VALUE = Tolerance(
    2 * MICROFACET_VALUE.value + LAYERS,
    SCALED,
    scaled,
    "two lobes of microfacets, each within 1e-3, and the throughputs of two of them, each within 5e-3, "
    "and of a sheen, within 1.6e-3, over bases of which no more than 1 comes out",
)
ALBEDO = Tolerance(
    2 * LAYERS,
    "albedo",
    absolute,
    "the albedos of two lobes of microfacets, each within 5e-3, and of a sheen, within 1.6e-3, and as "
    "much for their throughputs",
)
