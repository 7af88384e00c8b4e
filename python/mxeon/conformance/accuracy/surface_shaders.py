# SPDX-License-Identifier: Apache-2.0
"""Tolerances of surface shaders: what all fits of eonlib's lobes together change in them."""

from mxeon.conformance.accuracy.bsdf import sum_of
from mxeon.conformance.samples.measurement import absolute, mean_scaled, scaled
from mxeon.conformance.samples.tolerance import SCALED, Tolerance, rounded_up

# Largest errors by the fits of all lobes of a material, of 32 sets of the size that a check asks for, with
# the layer equation in float64: tools/fits/surface_shaders.py. They are a third of the sum of what each lobe's
# fits change at most, since no material has the worst of all.
FITTED_VALUE = 3.5e-3
FITTED_ALBEDO = 2.6e-3
FITTED_MEAN = 2.2e-4  # of 256 values, or of 64 albedos
VIEWS = 64  # of an environment, whose sums err independently of each other
VALUE = Tolerance(
    rounded_up(FITTED_VALUE),
    SCALED,
    scaled,
    "the fits of all lobes of a material, 3.5e-3 at most over 32 sets of 256 pairs; rounded up",
)
ALBEDO = Tolerance(
    rounded_up(FITTED_ALBEDO + sum_of(1024)),
    "albedo",
    absolute,
    "the fits of all lobes of a material, 2.6e-3 at most over 32 sets of 64 views; and the sum over 1024 "
    "directions, 1.7e-3 of all light; rounded up",
)
MEAN = Tolerance(
    rounded_up(FITTED_MEAN + sum_of(1024) / VIEWS**0.5),
    "pi f cos, relative above 1, or albedo, mean",
    mean_scaled,
    "the mean of the errors by fits, 2.2e-4 at most over the same sets; and that of the sums over 1024 "
    "directions, 1.7e-3 over the root of 64 views; rounded up",
)
