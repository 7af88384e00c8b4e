// SPDX-License-Identifier: Apache-2.0
// The half vector of two directions, for all models that have one.

// The normal for a light exactly opposite the view, which no facet reflects. 1e-15 has a square that is no
// denormal, and turns only sums that are themselves roundings of 0.
vec3 eonlib_half_vector(vec3 wo, vec3 wi, vec3 N)
{
    return normalize(wi + wo + 1e-15 * N);
}
