// SPDX-License-Identifier: Apache-2.0
// The half vector of two directions in all models.

// If the light is exactly opposite the view, the result is the normal. The square of 1e-15 is not
// denormal, and 1e-15 only matters next to sums that are 0 up to rounding.
vec3 eonlib_half_vector(vec3 wo, vec3 wi, vec3 N)
{
    return normalize(wi + wo + 1e-15 * N);
}
