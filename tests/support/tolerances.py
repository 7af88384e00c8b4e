# SPDX-License-Identifier: Apache-2.0
"""The tolerances of the tests, each computed from its sources of error."""

from math import pi

# Unit roundoff of float64 and float32.
ROUNDING, ROUNDING_32 = 2.0**-53, 2.0**-24

# Roundings counted for a call of a NumPy function: vectorized versions are off by up to 4 ulp.
FUNCTION = 8

# --- models and albedos, float64 -------------------------------------------------------------

# Error of a BRDF, in units of its largest term: 1 / pi, or 1 / pi times the largest |s / t| for the
# same cosines. The longest formula, full Oren-Nayar, has 60 roundings and four functions.
BRDF = (60 + 4 * FUNCTION) * ROUNDING

# Relative error of FON's loss H(mu) and of its albedos, which are sums of two positive terms.
LOSS = (7 + FUNCTION) * ROUNDING

# Absolute difference of a closed-form albedo <= 1.05 and its quadrature by 128 x 128 terms: 20
# roundings per term, 130 in partial sums, and an error of 1e-14 in each of 64 nodes and weights.
QUADRATURE = (20 + 130) * ROUNDING * 1.05 + 64 * 1e-14

# Relative error of one rounding, for a number in [1/2, 1].
ONE_ROUNDING = 2.0 * ROUNDING

# Error of sheen and of Burley's model, in units of (value + 1 / pi) / roughness: 40 roundings, and
# a power with an exponent of at most 0.5 / roughness, whose base has 10 roundings.
SHEEN = (40 + 2 * FUNCTION + 10) * ROUNDING

# Error after a rotation about the normal, which rounds each component three times. The error of s
# grows by 9 roundings of S_o S_i.
ROTATION = BRDF + 12.0 * ROUNDING

# Absolute error of the approximate loss, [Portsmouth2025], Eq. (14), and its factor in each
# function: eon_brdf_approx, in units of 1 / pi, contains two losses of at most c1 = 0.288 with the
# factor rho^2 r A (1 + c2 r) / ((c1 - c2) D) <= 3.61; fon_albedo_dir_approx contains one with r A
# <= 0.777, and eon_albedo_dir_approx one with rho (1 - rho) r / D <= 0.213.
QUARTIC_LOSS = 6.03e-4
QUARTIC_BRDF = 2 * 3.61 * 0.288 * QUARTIC_LOSS
QUARTIC_FON_ALBEDO = 0.777 * QUARTIC_LOSS
QUARTIC_EON_ALBEDO = 0.213 * QUARTIC_LOSS

# Difference of eon_brdf_approx and Listing 1, in units of 1 / pi. Listing 1 clamps each 1 - E to at
# least 1e-7. One clamp counts c1 / (c1 - c2) = 1.34 times; two are divided by 1 - <E> > 1.6e-6.
LISTING_EPSILON = 1.34 * 1e-7 + 1e-14 / 1.6e-6

# --- fits --------------------------------------------------------------------------------------

# Largest relative errors of fits with their printed digits, as stated next to the coefficients and
# rounded up: fon_loss in float64, fon_loss in float32, ROOT, and the density of exact samples for
# the worse of its two fits.
FIT_LOSS = 2.7e-7
FIT_LOSS_32 = 5.4e-7
FIT_ROOT = 1.8e-7
EON_DENSITY = 1.3e-5

# Excess of an exact sample's weight over 1, and relative variance of weights, as documented.
EON_WEIGHT = 5e-5
EON_VARIANCE = 1e-9

# Relative error of the arc tangent below tan(pi / 8): the fit's, and that of its eight decimals.
FIT_ANGLE = 1.9e-8 + 0.6e-8

# --- shader twins, float32 against float64 ---------------------------------------------------

TWIN_ALBEDO = 1e-6
TWIN_VALUE = 2e-6

# Error e of a normal in Cycles (float32). A point of the sphere is a ray's origin plus its length,
# both at most 2: three roundings. For grazing rays the error is e / mu; the test multiplies by mu.
CYCLES_NORMAL = 3 * 2.0 * ROUNDING_32

# Relative error of a picture of EON if both cosines exceed 0.1: 6 roundings, and 1e-5 of roughness.
CYCLES_RIM = 0.1
CYCLES_EON_RELATIVE = 6 * ROUNDING_32 / CYCLES_RIM**2 + 1e-5

# Error of the mean of 3212 pixels in an environment: four standard deviations, rounded up.
CYCLES_FURNACE_MEAN = 2e-4

# Error of the mean of 208 pixels of a subsurface sphere under a uniform sky: Cycles' error when it
# inverts the albedo, measured with 1024 samples, and two standard deviations with 64 samples.
CYCLES_SUBSURFACE = 0.011 + 2 * 0.05 / 208**0.5

# --- sampling and inversion, float64 ---------------------------------------------------------

# Relative difference between a density and the equivalent product or sum.
PDF = 20.0 * ROUNDING

# Absolute error of components and squared lengths of sampled directions: 12 roundings and two
# functions per component, half of a length's error, all counted twice, and the sums.
DIRECTION = 72.0 * ROUNDING

# Error of directions sampled for a rotated view, whose sine is rounded again. As in float32, its
# stretching makes 1 of 1000 samples exceed this on average, and more than 10 with probability 1e-8.
TURNED_DIRECTION = 10.0 * DIRECTION
TURNED_SHARE = 10 / 1000

# Relative difference between the density returned with a sample and the density of its direction.
# Both divide the third or fourth power of a length or its square (6 roundings each) by det M, a
# difference of terms <= 1.6 that is at least 0.91. Near the boundary of CLTC, the density is a
# difference with an absolute error of DIRECTION.
SAMPLE_PDF = 2 * (4 * (6 + 6) + 6 * 1.8 + 20) * ROUNDING

# Absolute error of a density if its sample is off by TURNED_DIRECTION. At mu_o = 0.3, |s / t| is at
# most 3.2. Per radian, the density changes by twice that, plus 1 for its cosine, all over pi.
TURNED_PDF = (1 + 2 * 3.2) / pi * TURNED_DIRECTION

# Relative error of the height of a clipped cosine, the root of a product of positive terms: half of
# four roundings for the chord's ends and six for the terms, and one rounding of the root.
RIM = (0.5 * (4 + 6) + 1) * ROUNDING

# Absolute error of the side of the lune: x and z, at most 1, have 4 roundings, a function, and RIM.
LUNE = (4 + FUNCTION) * ROUNDING + RIM

# Absolute error of the integral of a density with a kink. The boundary of CLTC, at most pi long,
# crosses Gauss panels whose nodes are h <= pi/2 / 64 apart. Across it, the density's slope per
# radian jumps by at most 1 per steradian.
KINK_QUADRATURE = (pi / 2 / 64) ** 2 / 12 * pi

# Relative errors of an inverted albedo (its longest chain of roundings) and of a round trip, which
# adds the albedo's roundings and doubles rho's: an albedo grows at most twice as fast as rho.
RHO = 11.0 * ROUNDING
ROUND_TRIP = 1e-14

# --- pictures ----------------------------------------------------------------------------------

# Error of an OpenGL picture times cos(theta_o): 16 roundings of a pixel's point, 32 of its value.
PICTURE = (16 + 32) * ROUNDING_32

# Maximum number of 200 kits of pure noise that are judged biased. The false-alarm rate of each is
# 1e-3, so more than 2 have a probability of 1.1e-3.
KIT_FALSE_ALARMS = 2

# Error of an albedo summed over visible normals. SwiftShader's sine and cosine are off by 1.9e-4
# and rotate a direction twice, 8e-4 in all; the sum changes at most 2.5 times as fast. With 64
# directions instead of 1024, the sum would be off by 3e-2.
SUMMED_DIRECTIONS = 2.5 * 8e-4

# Relative difference of two figures printed with two digits, as on upstream pages. Each is off by
# half a unit of its second digit, 5 % at most. Drivers differ by a unit of the third digit, 0.01.
PRINTED = 0.05 + 0.05 + 0.01

# --- microfacet and sheen nodes ------------------------------------------------------------------

# Errors of the fits of E_ss and of the Conty-Kulla albedo: those stated, plus the quadrature's.
FIT_GGX = 4.92e-4 + 1e-6
FIT_CONTY_KULLA = 1.51e-3 + 1e-5

# Error of the quadrature in the fits, whose panels shrink to 4^-9 of the integrand's width.
FIT_QUADRATURE = 1e-7

# Relative error of the Fresnel reflectance of a dielectric with index >= 1, and of its average: at
# most 40 roundings and a logarithm, in sums whose terms are at most four times the sum.
FRESNEL = 4.0 * (40 + FUNCTION) * ROUNDING

# Relative error of a microfacet BRDF for alpha >= 0.05: 2 roundings in a component of the half
# vector, which D multiplies by 2 / alpha, and 60 other roundings.
MICROFACET = (2 * 2 / 0.05 + 60) * ROUNDING

# Errors that docstrings promise: absolute error of a conductor's reflectance; error of E_ss; error
# of albedos by slopes, in units of the larger of 1 and the albedo.
CONDUCTOR = 1e-12
E_SS = 1e-10
E_SS_SMALL = 2e-8
SLOPES = 5e-6
# Error of an albedo for an index below 1, at roughnesses where adaptive quadrature reaches 1e-13.
SPLIT = 100 * 1e-13

# --- transmission, float64 ---------------------------------------------------------------------

# Error of a BTDF's integral over a grid of 300 x 300 directions, which has no nodes at the critical
# angle. At an index of 0.7, 6e-4 was measured.
REFRACTED_GRID = 1e-3

# Error of the transmittance from the denser side, as its docstring promises.
TRANSMITTANCE_CRITICAL = 1e-8

# Error of averages over 32 Gauss nodes of the cosine on both sides of the surface.
REVERSED = 5e-5

# --- Mitsuba, float32 --------------------------------------------------------------------------

# Relative error of a BTDF: 64 roundings, including the fourth power in D, divided by alpha = 0.3.
MITSUBA_BTDF = 64 * ROUNDING_32 / 0.3

# Errors of EON, FON and QON: of value times cosine, which is at most 1 / pi, about 15 roundings; of
# a sample's weight, a quotient of two such values, 3.6e-7 as measured.
MITSUBA_EVAL = 3e-7
MITSUBA_WEIGHT = 1e-6
# Relative error of a dielectric over EON, where it exceeds MITSUBA_EVAL: roundings of the facets'
# distribution (a fourth power and a square), of Fresnel's two squares, of visibility and of the
# curves' sums; 1.0e-6 was measured.
MITSUBA_COAT = 24 * ROUNDING_32
# Additional relative error of its density. The dielectric's share of samples has the error of the
# albedo, 2e-7 from the curve and 3 roundings, divided by the albedo; 1.5e-7 was measured.
MITSUBA_DENSITY = 2e-7 + 3 * ROUNDING_32

# Error of the curves of a dielectric over EON, as their docstring promises.
COAT = 2e-7
# Error of its integral by 256 x 256 nodes at alpha = 0.5; largest in the specular lobe at mu = 0.1.
COAT_INTEGRAL = 2e-6
