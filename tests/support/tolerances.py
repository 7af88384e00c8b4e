# SPDX-License-Identifier: Apache-2.0
"""The tolerances of the tests, each computed from its sources of error."""

from math import pi

# Unit roundoff of float64 and float32.
ROUNDING, ROUNDING_32 = 2.0**-53, 2.0**-24

# A call of a NumPy function counts as 8 roundings, because vectorized functions have errors of up
# to 4 ulp.
FUNCTION = 8

# --- models and albedos, float64 -------------------------------------------------------------

# Error of a BRDF divided by its largest term, which is 1 / pi times the larger of 1 and the largest
# |s / t| for the same cosines. The longest formula, full Oren-Nayar, has 60 roundings and four
# function calls.
BRDF = (60 + 4 * FUNCTION) * ROUNDING

# Relative error of FON's loss H(mu) and of FON's albedos, which are sums of two positive terms with
# 7 roundings and a function call.
LOSS = (7 + FUNCTION) * ROUNDING

# Absolute difference between a closed-form albedo <= 1.05 and a quadrature with 128 x 128 terms.
# Each term has 20 roundings, partial sums have 130 roundings, and each of 64 nodes and weights has
# an error of 1e-14.
QUADRATURE = (20 + 130) * ROUNDING * 1.05 + 64 * 1e-14

# Relative error of one rounding, for a number in [1/2, 1].
ONE_ROUNDING = 2.0 * ROUNDING

# Error of the sheen models and of Burley's model, divided by (value + 1 / pi) / roughness. The
# value has 40 roundings and two function calls. A power has an exponent of at most 0.5 / roughness
# and a base with 10 roundings.
SHEEN = (40 + 2 * FUNCTION + 10) * ROUNDING

# Error of a BRDF after a rotation about the normal. The rotation rounds each component three times,
# and the error of s grows by the 9 roundings of the product S_o S_i.
ROTATION = BRDF + 12.0 * ROUNDING

# Absolute errors of the approximate loss, [Portsmouth2025], Eq. (14), and of functions of the loss.
# eon_brdf_approx, in units of 1 / pi, contains the product of two losses, each at most
# c1 = 0.288, with the factor rho^2 r A (1 + c2 r) / ((c1 - c2) D) <= 3.61.
# fon_albedo_dir_approx contains one loss with the factor r A <= 0.777. eon_albedo_dir_approx
# contains one loss with the factor rho (1 - rho) r / D <= 0.213.
QUARTIC_LOSS = 6.03e-4
QUARTIC_BRDF = 2 * 3.61 * 0.288 * QUARTIC_LOSS
QUARTIC_FON_ALBEDO = 0.777 * QUARTIC_LOSS
QUARTIC_EON_ALBEDO = 0.213 * QUARTIC_LOSS

# Difference between eon_brdf_approx and Listing 1, in units of 1 / pi. Listing 1 clamps each
# 1 - E to at least 1e-7. One clamp changes the result by c1 / (c1 - c2) = 1.34 times 1e-7.
# Two clamps change the result by 1e-14 / (1 - <E>), where 1 - <E> exceeds 1.6e-6.
LISTING_EPSILON = 1.34 * 1e-7 + 1e-14 / 1.6e-6

# --- fits --------------------------------------------------------------------------------------

# Largest relative errors of fits, as stated next to the published coefficients and rounded up.
# EON_DENSITY is the larger error of the two fits in the exact sampler.
FIT_LOSS = 2.7e-7
FIT_LOSS_32 = 5.4e-7
FIT_ROOT = 1.8e-7
EON_DENSITY = 1.3e-5

# Documented excess of an exact sample's weight over 1, and documented relative variance of weights.
EON_WEIGHT = 5e-5
EON_VARIANCE = 1e-9

# Relative error of the arc tangent below tan(pi / 8). The first term is the error of the fit. The
# second term is caused by the eight decimals of the coefficients.
FIT_ANGLE = 1.9e-8 + 0.6e-8

# --- shader twins, float32 against float64 ---------------------------------------------------

TWIN_ALBEDO = 1e-6
TWIN_VALUE = 2e-6

# Error of a normal in Cycles (float32), times the cosine of the ray. A point of the sphere is the
# sum of a ray's origin and a vector along the ray, both of length <= 2, and has three roundings.
CYCLES_NORMAL = 3 * 2.0 * ROUNDING_32

# Relative error of a picture of EON where both cosines exceed 0.1. Six roundings are divided by the
# product of both cosines, and the roughness adds an error of 1e-5.
CYCLES_RIM = 0.1
CYCLES_EON_RELATIVE = 6 * ROUNDING_32 / CYCLES_RIM**2 + 1e-5

# Four standard deviations of the mean of 3212 pixels in an environment, rounded up.
CYCLES_FURNACE_MEAN = 2e-4

# Error of the mean of 208 pixels of a subsurface sphere under a uniform sky. The first term is the
# error of Cycles' inverted albedo, measured with 1024 samples. The second term is two standard
# deviations of the mean with 64 samples.
CYCLES_SUBSURFACE = 0.011 + 2 * 0.05 / 208**0.5

# --- sampling and inversion, float64 ---------------------------------------------------------

# Relative difference between a density and a product or sum with the same exact value.
PDF = 20.0 * ROUNDING

# Absolute error of the components and of the squared length of a sampled direction. Each component
# has 12 roundings, two function calls, and half the error of the length. The tolerance counts all
# errors twice.
DIRECTION = 72.0 * ROUNDING

# Error of directions sampled for a rotated view. Sampling amplifies the rounding of the view's
# sine. Of 1000 samples, one exceeds the tolerance on average. The probability that more than 10
# exceed the tolerance is 1e-8.
TURNED_DIRECTION = 10.0 * DIRECTION
TURNED_SHARE = 10 / 1000

# Relative difference between the density returned with a sample and the density computed from the
# sample's direction. Each computation has 4 (6 + 6) roundings in a fourth power, and 20 other
# roundings. The determinant of M, a difference of terms <= 1.6, is at least 0.91 and adds 6 x 1.8
# roundings. Near the boundary of CLTC, the density also has an absolute error of DIRECTION.
SAMPLE_PDF = 2 * (4 * (6 + 6) + 6 * 1.8 + 20) * ROUNDING

# Absolute error of the density of a sample that has the error TURNED_DIRECTION. Per radian, the
# density changes by (2 |s / t| + 1) / pi, where 1 stands for the cosine. The largest |s / t| at
# mu_o = 0.3 is 3.2.
TURNED_PDF = (1 + 2 * 3.2) / pi * TURNED_DIRECTION

# Relative error of the height of a clipped cosine, a square root of a product of positive terms.
# The root halves four rounding errors of the chord's ends and six of the terms, and is itself
# rounded once.
RIM = (0.5 * (4 + 6) + 1) * ROUNDING

# Absolute error of d x + z, which is negative where CLTC is clipped. The coordinates x and z are at
# most 1 and have 4 roundings, a function call, and the error RIM.
LUNE = (4 + FUNCTION) * ROUNDING + RIM

# Absolute error of the integral of a density with a kink. A kink adds h^2 / 12 per unit of length.
# The boundary of CLTC, at most pi long, crosses Gauss panels with nodes h <= pi/2 / 64 apart. At
# the boundary, the slope of the density jumps by at most 1 per steradian and radian.
KINK_QUADRATURE = (pi / 2 / 64) ** 2 / 12 * pi

# RHO is the relative error of an inverted albedo, which has at most 11 roundings. ROUND_TRIP also
# includes the roundings of the albedo and twice the error of rho, because an albedo grows at most
# twice as fast as rho.
RHO = 11.0 * ROUNDING
ROUND_TRIP = 1e-14

# --- pictures ----------------------------------------------------------------------------------

# Error of an OpenGL picture times cos(theta_o). Points have 16 roundings, and values have 32.
PICTURE = (16 + 32) * ROUNDING_32

# Maximum number of kits that may be judged biased, among 200 kits with pure noise. Each kit has a
# false-alarm rate of 1e-3, so more than 2 false alarms have a probability of 1.1e-3.
KIT_FALSE_ALARMS = 2

# Error of an albedo that is summed over visible normals. SwiftShader's sine and cosine are off by
# 1.9e-4 and rotate a direction twice, which adds up to 8e-4. The sum changes at most 2.5 times as
# fast as the directions. With 64 directions instead of 1024, the sum would be off by 3e-2.
SUMMED_DIRECTIONS = 2.5 * 8e-4

# Relative difference of two figures that are printed with two digits, as on the pages on upstream
# defects. Rounding changes each figure by at most half a unit of the second digit, which is 5 %.
# Graphics drivers differ by a unit of the third digit, which is 1 %.
PRINTED = 0.05 + 0.05 + 0.01

# --- microfacet and sheen nodes ------------------------------------------------------------------

# Errors of the fits of E_ss and of the Conty-Kulla albedo. The first term is the documented error,
# and the second term is the error of the quadrature.
FIT_GGX = 4.92e-4 + 1e-6
FIT_CONTY_KULLA = 1.51e-3 + 1e-5

# Error of the quadrature that checks the fits. Panels shrink to 4^-9 of the integrand's width.
FIT_QUADRATURE = 1e-7

# Relative error of the Fresnel reflectance of a dielectric, and of its average, for an index of
# refraction >= 1. A sum has at most 40 roundings and a logarithm. The terms are at most four
# times as large as the sum.
FRESNEL = 4.0 * (40 + FUNCTION) * ROUNDING

# Relative error of a microfacet BRDF for alpha >= 0.05. A component of the half vector has 2
# roundings, which D multiplies by 2 / alpha. The other operations have 60 roundings.
MICROFACET = (2 * 2 / 0.05 + 60) * ROUNDING

# Documented errors. CONDUCTOR is the absolute error of a conductor's reflectance. E_SS is the
# absolute error of E_ss, or E_SS_SMALL for small roughness. SLOPES is the error of albedos that are
# summed over facet slopes, divided by the larger of 1 and the albedo.
CONDUCTOR = 1e-12
E_SS = 1e-10
E_SS_SMALL = 2e-8
SLOPES = 5e-6
# Albedos for an index of refraction below 1 have 100 times the error of adaptive quadrature.
SPLIT = 100 * 1e-13

# --- transmission, float64 ---------------------------------------------------------------------

# Error of a BTDF's integral over a grid of 300 x 300 directions without nodes at the critical
# angle. The measured error is 6e-4 at an index of refraction of 0.7.
REFRACTED_GRID = 1e-3

# Documented error of the transmittance from the side with the larger index of refraction.
TRANSMITTANCE_CRITICAL = 1e-8

# Error of cosine-weighted averages with 32 Gauss nodes on each side of the surface.
REVERSED = 5e-5

# --- Mitsuba, float32 --------------------------------------------------------------------------

# Relative error of a BTDF with 64 roundings, which D may amplify by 1 / alpha = 1 / 0.3.
MITSUBA_BTDF = 64 * ROUNDING_32 / 0.3

# Errors of EON, FON and QON. MITSUBA_EVAL is the error of a value times the cosine. The product is
# at most 1 / pi and has about 15 roundings. MITSUBA_WEIGHT is the error of a sample's weight, a
# quotient of two such values.
MITSUBA_EVAL = 3e-7
MITSUBA_WEIGHT = 1e-6
# Relative error of a large value of a dielectric over EON. The value has 24 roundings in the
# distribution of the facets, two squares in Fresnel's equations, the visibility, and sums of the
# curves. The measured error is 1.0e-6.
MITSUBA_COAT = 24 * ROUNDING_32
# Additional relative error of the density of a dielectric over EON. The fraction of samples that
# the dielectric reflects is computed from an albedo, whose relative error is 2e-7 from the curve
# plus 3 roundings. The measured error is 1.5e-7.
MITSUBA_DENSITY = 2e-7 + 3 * ROUNDING_32

# Documented error of the fitted curves that the model "dielectric over EON" uses.
COAT = 2e-7
# Error of a quadrature with 256 x 256 nodes, for the model "dielectric over EON" at alpha = 0.5.
# The specular lobe causes the largest error, for a view at mu = 0.1.
COAT_INTEGRAL = 2e-6
