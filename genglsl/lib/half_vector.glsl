// SPDX-License-Identifier: Apache-2.0

// Half vector of wo and wi, or N if wi is -wo. The term 1e-15 N only matters if wo + wi is 0 up to
// rounding. The square of 1e-15 is not denormal.
vec3 eonlib_half_vector(vec3 wo, vec3 wi, vec3 N)
{
    return normalize(wi + wo + 1e-15 * N);
}
