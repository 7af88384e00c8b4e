# SPDX-License-Identifier: Apache-2.0
"""Every tolerance of the tests, with its derivation and its scale."""

# Unit roundoff of float64.
ROUNDING = 2.0**-53

# Roundings of one function of NumPy: sine, arc tangent, power and so on. Its vector versions, which
# differ among processors, are of 4 ulp or less, those of the C library of 1.
FUNCTION = 8

# --- models and albedos, float64 -------------------------------------------------------------

# Value of a BRDF, in units of the largest of its terms: 1 / pi, or 1 / pi times the largest |s / t|
# at the same cosines. The longest formula (full Oren-Nayar) has 60 roundings and four functions.
BRDF = (60 + 4 * FUNCTION) * ROUNDING

# FON's loss H(mu) and albedos, relative: sums of two positive terms that each see at most 7
# roundings and one function.
LOSS = (7 + FUNCTION) * ROUNDING

# Closed-form albedo against quadrature, absolute, albedos <= 1.05. The integrand is analytic
# between the kinks, so that 64 nodes leave rounding alone: 128 x 128 terms whose weights add up to
# 1 and carry 20 roundings each, and whose sum adds one for each of at most 128 partial sums:
# 150 roundings, 1.7e-14. The 64 nodes and weights of NumPy's rule are good to 1e-14 each:
# at most 64 times that, should they all err to one side.
QUADRATURE = 150 * ROUNDING * 1.05 + 64 * 1e-14

# One rounding of a number in [1/2, 1].
ONE_ROUNDING = 2.0 * ROUNDING

# Values of sheen and of Burley's model, relative to the value and 1 / pi, times 1 / roughness:
# 40 roundings and a power of at most 0.5 / roughness, whose base takes 10.
SHEEN = (40 + 2 * FUNCTION + 10) * ROUNDING

# Turning a pair about the normal rounds each component three times, so s changes by 9 roundings of
# S_o S_i, and the value by 9 of the largest |s / t|. The roundings of BRDF add to that.
ROTATION = BRDF + 12.0 * ROUNDING

# eon_brdf_approx against eon_brdf, in 1 / pi: [Portsmouth2025], Eq. (14) is off by up to 6.0e-4 in
# H; rho^2 r A (1 + c2 r) / ((c1 - c2) D) <= 3.61 stands before H H, each H <= c1 = 0.288, and both
# err: 2 x 3.61 x 0.288 x 6.0e-4 = 1.25e-3.
QUARTIC_BRDF = 1.25e-3

# fon_albedo_dir_approx against fon_albedo_dir: 6.0e-4 times r A <= 1 / (1 + c1) = 0.777.
QUARTIC_FON_ALBEDO = 4.7e-4

# eon_albedo_dir_approx against eon_albedo_dir: 6.0e-4 times rho (1 - rho) r / D <= 0.213.
QUARTIC_EON_ALBEDO = 1.3e-4

# eon_brdf_approx against Listing 1 at roughness >= 1e-5, in 1 / pi. The listing keeps 1 - E above
# 1e-7, so a factor moves by at most that; the rest of the lobe, (1 - E) / (1 - <E>), is at most
# c1 / (c1 - c2) = 1.34, and 1 - <E> > 1.6e-6: 1.34e-7 once, 1e-14 / 1.6e-6 where both factors move.
LISTING_EPSILON = 1.4e-7

# --- fits --------------------------------------------------------------------------------------

# The errors stated next to the coefficients: the largest errors of the printed digits, with the
# last digit rounded up. They hold everywhere: the exact values come from closed forms, whose
# rounding moves them by 1e-15. fon_loss: relative, in float64 and in float32. ROOT: relative.
# Density of exact samples: relative, for the worse of the two fits.
FIT_LOSS = 2.7e-7
FIT_LOSS_32 = 5.4e-7
FIT_ROOT = 1.8e-7
EON_DENSITY = 1.3e-5

# Weight and relative variance of exact samples, as the project promises.
EON_WEIGHT = 5e-5
EON_VARIANCE = 1e-9

# Arc tangent below tan(pi / 8), relative: the polynomial's 1.9e-8, and half a unit of the eighth
# decimal in each of five coefficients, which count as the powers of 0.172: 0.6e-8.
FIT_ANGLE = 2.5e-8

# --- shader twins, float32 against float64 ---------------------------------------------------

TWIN_ALBEDO = 1e-6
TWIN_VALUE = 2e-6

# Cycles, float32. A point of the sphere is a ray's origin plus its length, both at most 2: three
# roundings of 2^-23 together. For grazing rays the error is e / mu, and the test compares e.
CYCLES_NORMAL = 3 * 2.0**-23


# A picture of EON, relative, where both cosines exceed CYCLES_RIM.
CYCLES_RIM = 0.1
CYCLES_EON_RELATIVE = (
    5e-5  # 6 roundings of 2^-24 over the square of the rim, 1e-5 of roughness; rounded up
)

# Mean of the 3212 pixels of a picture in an environment: four times its deviation of 3.1e-5, rounded up.
CYCLES_FURNACE_MEAN = 2e-4

# Mean of the 208 pixels of a small sphere of subsurface under a uniform sky, 64 samples each. With 16
# times the pixels the color is missed by up to 0.011, since Cycles inverts albedos by a fit of its own;
# a pixel's deviation is 0.05 there, so the mean's is 0.0035, and twice that is added.
CYCLES_SUBSURFACE = 0.018

# --- sampling and inversion, float64 ---------------------------------------------------------

# A density against the product or the sum that it stands for, relative: no more than 20 roundings
# lie between the two; the sum in which FON may cancel is the same in both.
PDF = 20.0 * ROUNDING

# Components and squared lengths of sampled directions, absolute: each of three components <= 1 has
# at most 12 roundings and two functions on its way: 28. The squares add up to 1, and so do their
# weights: 56; a length moves by half of that and is taken twice.
DIRECTION = 72.0 * ROUNDING

# Directions sampled for a turned view, whose sine is rounded anew. As in float32, stretching makes the
# difference more than 10 times larger for a thousandth of the samples: for one of 1000 on average, and
# for more than 10 with a probability of 1e-8.
TURNED_DIRECTION = 10.0 * DIRECTION
TURNED_SHARE = 10 / 1000

# A sample's density compared with the density for its direction, relative. Both have a length
# or its square to the third or fourth power, 6 roundings each, over det M, a difference of terms
# <= 1.6 that is 0.91 or more: 4 x (6 + 6) + 6 x 1.8 + 20 others, twice. Near the line where CLTC
# ends its density is a difference, exact to DIRECTION absolutely.
SAMPLE_PDF = 160.0 * ROUNDING

# Density where a sample is off by TURNED_DIRECTION, absolute: at mu_o 0.3 the largest |s / t| is
# 3.2, and a density changes by at most (1 + 2 x 3.2) / pi = 2.4 per radian.
TURNED_PDF = 2.4 * TURNED_DIRECTION

# Height of a clipped cosine, relative: the root of a product of positive terms, with half of the
# four roundings of the chord's ends and the six of the terms, and the root's own.
RIM = 6 * ROUNDING

# Side of the lune, absolute: x and z are at most 1, and off by 4 roundings and a function, and by RIM.
LUNE = (4 + FUNCTION) * ROUNDING + RIM

# Integral of a density with a kink, absolute. The line where CLTC ends, at most pi long, crosses
# Gauss panels whose nodes are h <= pi/2 / 64 apart; the slope jumps by at most 1 per steradian and
# radian: h^2 / 12 x pi = 1.6e-4.
KINK_QUADRATURE = 1.6e-4

# Inverse of an albedo, relative: 11 roundings on the longest chain. There and back: 1e-14, with
# the albedo's own 9 roundings and rho's twice, since an albedo grows at most twice as fast as rho.
RHO = 11.0 * ROUNDING
ROUND_TRIP = 1e-14


# --- Pictures on OpenGL ----------------------------------------------------------------------

# Error times cos(theta_o): 16 roundings in the position of a pixel's point, 32 in the value.
PICTURE = 48 * 2.0**-24

# --- kit ---------------------------------------------------------------------------------------


# Pictures of pure noise, 200 of them at a false rate of 1e-3 each: more than 2 are called biased
# with a probability of 1.1e-3.
KIT_FALSE_ALARMS = 2


# --- microfacet and sheen nodes ------------------------------------------------------------------

# The fits of E_ss and of the Conty-Kulla albedo: their stated errors, plus quadrature.
FIT_GGX = 4.92e-4 + 1e-6
FIT_CONTY_KULLA = 1.51e-3 + 1e-5

# The quadrature of the fits, whose panels end at 4^-9 of the width of the integrand.
FIT_QUADRATURE = 1e-7

# --- pages of upstream -----------------------------------------------------------------------

# Two figures with two digits each, relative: each is off by half a unit of the second digit, 5 % at
# most. Drivers differ by 1e-5, which is one unit in the third digit of the smallest figure, 0.01.
PRINTED = 0.11

# --- sums over an environment ------------------------------------------------------------------

# An albedo as a sum over visible normals. SwiftShader's sine and cosine are off by 1.9e-4 and turn
# a direction twice, 8e-4 in all; the sum changes at most 2.5 times as fast. With 64 directions
# instead of 1024 it would be off by 3e-2.
SUMMED_DIRECTIONS = 2e-3

# --- microfacets, float64 ----------------------------------------------------------------------

# Fresnel reflectance of a dielectric of index >= 1, and its average, relative: at most 40 roundings
# and a logarithm, in sums whose terms are at most four times the sum.
FRESNEL = 4.0 * (40 + FUNCTION) * ROUNDING

# Reflectance of a conductor, absolute, as its docstring promises.
CONDUCTOR = 1e-12

# Value of a microfacet BRDF, relative, for alpha >= 0.05. A component of the half vector is off by
# 2 roundings, by which D moves 2 / alpha times as much: 80 roundings; 60 others.
MICROFACET = (80 + 60) * ROUNDING

# E_ss, and albedos by slopes in units of the larger of 1 and the albedo: as their docstrings promise.
E_SS = 1e-10
E_SS_SMALL = 2e-8
SLOPES = 5e-6
# Albedo for an index below 1, at roughnesses where adaptive quadrature converges: a hundred times
# its 1e-13.
SPLIT = 1e-11

# --- transmission, float64 ---------------------------------------------------------------------

# Integrals of a BTDF over a grid of 300 x 300 directions, which has no nodes at the critical angle:
# measured, 6e-4 at an index of 0.7.
REFRACTED_GRID = 1e-3

# Transmittance from the denser side, as its docstring promises.
TRANSMITTANCE_CRITICAL = 1e-8

# Averages over 32 Gauss nodes of the cosine, on both sides of the surface.
REVERSED = 5e-5

# Mitsuba's values are float32: 64 roundings, the fourth power of D by alpha 0.3 among them.
MITSUBA_BTDF = 64 * 2.0**-24 / 0.3

# EON, FON and QON in Mitsuba, in float32: value times cosine, at most 1/pi times some 15 roundings of 2^-24,
# 1.1e-7 measured; and the weight of a sample, a quotient of two such values, 3.6e-7 measured.
MITSUBA_EVAL = 3e-7
MITSUBA_WEIGHT = 1e-6
# A dielectric over EON in Mitsuba, relative where it is larger: the fourth power of the facets' distribution, its
# square, Fresnel's two squares, visibility and the sums of the curves, 24 roundings of 2^-24; 1.0e-6 measured.
MITSUBA_COAT = 24 * 2.0**-24
# Its density, in addition: the fraction of samples for the dielectric is as exact as its albedo,
# 2e-7 from the curve and 2e-7 from 3 roundings, divided by that albedo; 1.5e-7 measured.
MITSUBA_DENSITY = 4e-7

# Curves of a dielectric over EON, as their docstring promises: 9e-8 measured, at alpha 0.01 and index 1.02.
COAT = 2e-7
# Integral of its value at alpha 0.5 by 256 x 256 nodes; the specular lobe at mu 0.1 is the hardest.
COAT_INTEGRAL = 2e-6
