# SPDX-License-Identifier: Apache-2.0
"""Every tolerance of the tests, as arithmetic of its causes."""

from math import pi

# Unit roundoff of float64 and float32.
ROUNDING, ROUNDING_32 = 2.0**-53, 2.0**-24

# Roundings of one function of NumPy: its vector versions are good to 4 ulp.
FUNCTION = 8

# --- models and albedos, float64 -------------------------------------------------------------

# Value of a BRDF, in units of the largest of its terms: 1 / pi, or 1 / pi times the largest |s / t|
# at the same cosines. The longest formula (full Oren-Nayar) has 60 roundings and four functions.
BRDF = (60 + 4 * FUNCTION) * ROUNDING

# FON's loss H(mu) and albedos, relative: sums of two positive terms.
LOSS = (7 + FUNCTION) * ROUNDING

# Closed-form albedo <= 1.05 against 128 x 128 terms, absolute: 20 roundings of a term, and 130 of the
# partial sums; and 64 nodes and weights good to 1e-14 each.
QUADRATURE = (20 + 130) * ROUNDING * 1.05 + 64 * 1e-14

# One rounding of a number in [1/2, 1].
ONE_ROUNDING = 2.0 * ROUNDING

# Values of sheen and of Burley's model, relative to the value and 1 / pi, times 1 / roughness:
# 40 roundings and a power of at most 0.5 / roughness, whose base takes 10.
SHEEN = (40 + 2 * FUNCTION + 10) * ROUNDING

# Turning a pair about the normal rounds each component three times, s by 9 roundings of S_o S_i.
ROTATION = BRDF + 12.0 * ROUNDING

# The approximate loss of [Portsmouth2025], Eq. (14); absolute. In eon_brdf_approx, in 1 / pi,
# rho^2 r A (1 + c2 r) / ((c1 - c2) D) <= 3.61 stands before two losses of at most c1 = 0.288; in
# fon_albedo_dir_approx r A <= 0.777 before one, in eon_albedo_dir_approx rho (1 - rho) r / D <= 0.213.
QUARTIC_LOSS = 6.03e-4
QUARTIC_BRDF = 2 * 3.61 * 0.288 * QUARTIC_LOSS
QUARTIC_FON_ALBEDO = 0.777 * QUARTIC_LOSS
QUARTIC_EON_ALBEDO = 0.213 * QUARTIC_LOSS

# eon_brdf_approx against Listing 1, which keeps 1 - E above 1e-7, in 1 / pi: c1 / (c1 - c2) stands
# before one factor; where both are that small, 1 - <E> > 1.6e-6 divides them.
LISTING_EPSILON = 1.34 * 1e-7 + 1e-14 / 1.6e-6

# --- fits --------------------------------------------------------------------------------------

# The errors stated next to the coefficients: the largest errors of the printed digits, with the
# last digit rounded up. fon_loss: relative, in float64 and in float32. ROOT: relative.
# Density of exact samples: relative, for the worse of the two fits.
FIT_LOSS = 2.7e-7
FIT_LOSS_32 = 5.4e-7
FIT_ROOT = 1.8e-7
EON_DENSITY = 1.3e-5

# Weight and relative variance of exact samples, as the project promises.
EON_WEIGHT = 5e-5
EON_VARIANCE = 1e-9

# Arc tangent below tan(pi / 8), relative: the polynomial's error, and the rounding of its eight decimals.
FIT_ANGLE = 1.9e-8 + 0.6e-8

# --- shader twins, float32 against float64 ---------------------------------------------------

TWIN_ALBEDO = 1e-6
TWIN_VALUE = 2e-6

# Cycles, float32. A point of the sphere is a ray's origin plus its length, both at most 2: three
# roundings. For grazing rays the error is e / mu, and the test compares e.
CYCLES_NORMAL = 3 * 2.0 * ROUNDING_32

# A picture of EON where both cosines exceed the rim, relative: 6 roundings, and 1e-5 of roughness.
CYCLES_RIM = 0.1
CYCLES_EON_RELATIVE = 6 * ROUNDING_32 / CYCLES_RIM**2 + 1e-5

# Mean of the 3212 pixels of a picture in an environment: four times its deviation, rounded up.
CYCLES_FURNACE_MEAN = 2e-4

# Mean of the 208 pixels of a small sphere of subsurface under a uniform sky: the error of Cycles' inverse
# albedo, as measured with 1024 samples, and twice the deviation of a pixel with 64.
CYCLES_SUBSURFACE = 0.011 + 2 * 0.05 / 208**0.5

# --- sampling and inversion, float64 ---------------------------------------------------------

# A density against the product or the sum that it stands for, relative.
PDF = 20.0 * ROUNDING

# Components and squared lengths of sampled directions, absolute: 12 roundings and two functions of
# a component, half of a length's error, taken twice, and the sums.
DIRECTION = 72.0 * ROUNDING

# Directions sampled for a turned view, whose sine is rounded anew. As in float32, stretching makes the
# difference more than 10 times larger for a thousandth of the samples: for one of 1000 on average, and
# for more than 10 with a probability of 1e-8.
TURNED_DIRECTION = 10.0 * DIRECTION
TURNED_SHARE = 10 / 1000

# A sample's density compared with the density for its direction, relative. Both have a length
# or its square to the third or fourth power, 6 roundings each, over det M, a difference of terms
# <= 1.6 that is 0.91 or more. Near the line where CLTC ends its density is a difference, exact to
# DIRECTION absolutely.
SAMPLE_PDF = 2 * (4 * (6 + 6) + 6 * 1.8 + 20) * ROUNDING

# Density where a sample is off by TURNED_DIRECTION, absolute: at mu_o 0.3 the largest |s / t| is
# 3.2, to whose double a density's change adds its cosine's, per radian.
TURNED_PDF = (1 + 2 * 3.2) / pi * TURNED_DIRECTION

# Height of a clipped cosine, relative: the root of a product of positive terms, with half of the
# four roundings of the chord's ends and the six of the terms, and the root's own.
RIM = (0.5 * (4 + 6) + 1) * ROUNDING

# Side of the lune, absolute: x and z are at most 1, and off by 4 roundings and a function, and by RIM.
LUNE = (4 + FUNCTION) * ROUNDING + RIM

# Integral of a density with a kink, absolute. The line where CLTC ends, at most pi long, crosses
# Gauss panels whose nodes are h <= pi/2 / 64 apart; the slope jumps by at most 1 per steradian and
# radian.
KINK_QUADRATURE = (pi / 2 / 64) ** 2 / 12 * pi

# Inverse of an albedo, relative: the longest chain. There and back: with the albedo's own roundings
# and rho's twice, since an albedo grows at most twice as fast as rho.
RHO = 11.0 * ROUNDING
ROUND_TRIP = 1e-14

# --- pictures ----------------------------------------------------------------------------------

# On OpenGL, error times cos(theta_o): roundings in the position of a pixel's point and in the value.
PICTURE = (16 + 32) * ROUNDING_32

# Kits of pure noise, 200 of them at a false rate of 1e-3 each: more than 2 are called biased with a
# probability of 1.1e-3.
KIT_FALSE_ALARMS = 2

# An albedo as a sum over visible normals. SwiftShader's sine and cosine are off by 1.9e-4 and turn
# a direction twice, 8e-4 in all; the sum changes at most 2.5 times as fast. With 64 directions
# instead of 1024 it would be off by 3e-2.
SUMMED_DIRECTIONS = 2.5 * 8e-4

# Two figures with two digits each on a page of upstream, relative: each is off by half a unit of the
# second digit, 5 % at most, and drivers differ by one unit of the third digit of 0.01.
PRINTED = 0.05 + 0.05 + 0.01

# --- microfacet and sheen nodes ------------------------------------------------------------------

# The fits of E_ss and of the Conty-Kulla albedo: their stated errors, plus quadrature.
FIT_GGX = 4.92e-4 + 1e-6
FIT_CONTY_KULLA = 1.51e-3 + 1e-5

# The quadrature of the fits, whose panels end at 4^-9 of the width of the integrand.
FIT_QUADRATURE = 1e-7

# Fresnel reflectance of a dielectric of index >= 1, and its average, relative: at most 40 roundings
# and a logarithm, in sums whose terms are at most four times the sum.
FRESNEL = 4.0 * (40 + FUNCTION) * ROUNDING

# Value of a microfacet BRDF, relative, for alpha >= 0.05. A component of the half vector is off by
# 2 roundings, by which D moves 2 / alpha times as much; 60 others.
MICROFACET = (2 * 2 / 0.05 + 60) * ROUNDING

# Accuracies that docstrings promise: reflectance of a conductor, absolute; E_ss; albedos by slopes, in
# units of the larger of 1 and the albedo.
CONDUCTOR = 1e-12
E_SS = 1e-10
E_SS_SMALL = 2e-8
SLOPES = 5e-6
# Albedo for an index below 1, at roughnesses where adaptive quadrature converges to 1e-13.
SPLIT = 100 * 1e-13

# --- transmission, float64 ---------------------------------------------------------------------

# Integrals of a BTDF over a grid of 300 x 300 directions, which has no nodes at the critical angle:
# measured, 6e-4 at an index of 0.7.
REFRACTED_GRID = 1e-3

# Transmittance from the denser side, as its docstring promises.
TRANSMITTANCE_CRITICAL = 1e-8

# Averages over 32 Gauss nodes of the cosine, on both sides of the surface.
REVERSED = 5e-5

# --- Mitsuba, float32 --------------------------------------------------------------------------

# A BTDF: 64 roundings, the fourth power of D by alpha 0.3 among them.
MITSUBA_BTDF = 64 * ROUNDING_32 / 0.3

# EON, FON and QON: value times cosine, at most 1/pi times some 15 roundings; and the weight of a sample, a
# quotient of two such values, 3.6e-7 measured.
MITSUBA_EVAL = 3e-7
MITSUBA_WEIGHT = 1e-6
# A dielectric over EON, relative where it is larger: the fourth power of the facets' distribution, its
# square, Fresnel's two squares, visibility and the sums of the curves; 1.0e-6 measured.
MITSUBA_COAT = 24 * ROUNDING_32
# Its density, in addition: the fraction of samples for the dielectric is as exact as its albedo, 2e-7
# from the curve and 3 roundings, divided by that albedo; 1.5e-7 measured.
MITSUBA_DENSITY = 2e-7 + 3 * ROUNDING_32

# Curves of a dielectric over EON, as their docstring promises.
COAT = 2e-7
# Integral of its value at alpha 0.5 by 256 x 256 nodes; the specular lobe at mu 0.1 is the hardest.
COAT_INTEGRAL = 2e-6
