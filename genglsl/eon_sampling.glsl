// SPDX-License-Identifier: Apache-2.0
// Exact importance sampling of EON with two random numbers, no table and no iteration.
//
// eon_sample -> wi and eon_pdf, the density of wi in 1/sr; directions and random numbers are those
// of ltc_sampling. On the disk below the hemisphere, with wo at azimuth 0, EON is the sum of four
// parts: docs/sampling.md. v is a random number in [0, 1), mu_o and S_o cosine and sine of wo.

#include "ltc_sampling.glsl"

// The least cosine of a sample.
#define EON_HORIZON (1.0 / 16777216.0)

// Inverse distributions of two parts of EON. Source: fits/eon_sampling.py. Domain: random numbers
// and roots of them in [0, 1]. Largest relative error of the density: 1.27e-5 and 5.7e-6.
#define EON_MULTIPLE0 -0.1221922778
#define EON_MULTIPLE1 0.3674879021
#define EON_MULTIPLE2 -0.5228118253
#define EON_MULTIPLE3 0.4013375963
#define EON_MULTIPLE4 -0.1292043650
#define EON_MULTIPLE5 0.0102224997
#define EON_UPPER0 -0.0857788193
#define EON_UPPER1 -0.0262131859
#define EON_UPPER2 -0.0086609082
#define EON_UPPER3 -0.0096471279
#define EON_UPPER4 0.0067340733
#define EON_UPPER5 -0.0065897093

// eon_multiple_weight of a grey rho.
float eon_grey_weight(float rho, float roughness)
{
    float weight = roughness * (1.0 + EON_C2 * roughness) * (1.0 / EON_LOSS_AVG);
    return weight * rho / (1.0 + EON_C1 * roughness - roughness * EON_LOSS_AVG * rho);
}

// (1 - S^3) / mu, with neither a division by mu nor a cancellation.
float eon_cube_gap(float mu, float S)
{
    return mu * (1.0 + S + S * S) / (1.0 + S);
}

// K, the integral of sin^2 (1 - cos) up to this angle, from H: the two parts towards wo hold
// r (c1 - H(mu_o)) together. Near the normal no digit of the difference is left, and the bounds
// hold K, which is 0.2 to 0.4521 times (1 - mu) S^3.
float eon_segment(float mu, float S)
{
    float both = 0.5 * EON_PI * oren_nayar_quotient(EON_C1 - fon_loss(mu), S);
    float scale = (1.0 - mu) * S * S * S;
    float K = both - (1.0 - mu) / 3.0 * eon_cube_gap(mu, S);
    return clamp(K, 0.2 * scale, 0.4521 * scale);
}

// Direction with cosine mu and sine S at an azimuth whose sine is uniform, towards wo.
vec3 eon_towards(float mu, float S, float u2)
{
    return vec3(2.0 * S * sqrt(u2 * (1.0 - u2)), S * (2.0 * u2 - 1.0), mu);
}

// Drawn in proportion to x (1 / mu_o - 1) below mu_o: 1 - S^3 is uniform.
vec3 eon_lower_draw(float v, float u2, float mu_o, float S_o)
{
    float x = v * mu_o * eon_cube_gap(mu_o, S_o);
    float S = pow(1.0 - x, 1.0 / 3.0);
    return eon_towards(sqrt(x * (1.0 + S) / (1.0 + S + S * S)), S, u2);
}

// Q(y) of eon_upper_draw, 1 at y = 1.
float eon_upper_quotient(float y)
{
    float Q = EON_UPPER2 + y * (EON_UPPER3 + y * (EON_UPPER4 + y * EON_UPPER5));
    return 1.0 + (1.0 - y) * (EON_UPPER0 + y * (EON_UPPER1 + y * Q));
}

// Drawn in proportion to x (1 / mu_i - 1) above mu_o: K is uniform, and
// 1 - mu = m(v K_o) (1 - mu_o) / m(K_o), m(K) = y Q(y), y = (K / K(pi / 2))^(2 / 5).
vec3 eon_upper_draw(float v, float u2, float mu_o, float S_o)
{
    float y_o = pow(eon_segment(mu_o, S_o) / (0.25 * EON_PI - 1.0 / 3.0), 0.4);
    float y = pow(v, 0.4);
    float m = (1.0 - mu_o) * y * eon_upper_quotient(y_o * y) / eon_upper_quotient(y_o);
    return eon_towards(1.0 - m, sqrt(m * (2.0 - m)), u2);
}

// Drawn in proportion to H(mu_i); mu is a function of the cube root of v.
vec3 eon_multiple_draw(float v, float u2)
{
    float t = pow(v, 1.0 / 3.0);
    float m = max(1.0 - t, 0.0);
    float w = sqrt(m);
    float high = EON_MULTIPLE3 + w * (EON_MULTIPLE4 + m * m * EON_MULTIPLE5);
    float low = EON_MULTIPLE0 + m * (EON_MULTIPLE1 + w * (EON_MULTIPLE2 + w * high));
    float mu = t * (1.0 + m * low);
    return eon_around(mu, sqrt((1.0 - mu) * (1.0 + mu)), u2);
}

// Drawn in proportion to 1 + q x: along each chord of the disk, x by its inverse distribution from
// the uniform point (x, y). z is sqrt(1 - x^2 - y^2) without a cancellation.
vec3 eon_flat_draw(float v, float u2, float q)
{
    vec3 wh = cosine_sample(v, u2);
    float ahead = 1.0 + q * wh.x;
    float root = sqrt(ahead * ahead + q * q * (1.0 - v));
    float z = sqrt(2.0 * (1.0 - v) / (ahead + root));
    return vec3((q * (1.0 - wh.y * wh.y) + 2.0 * wh.x) / (1.0 + root), wh.y, z);
}

// Drawn from one of the four parts, chosen by what their integrals over pi leave of u1; wo has
// azimuth 0. The flat part's integral is 1.
vec3 eon_draw(float mu_o, float S_o, float u1, float u2, float rho, float roughness)
{
    float q = roughness * S_o;
    float lower = 2.0 / EON_PI * q * (1.0 - mu_o) / 3.0 * eon_cube_gap(mu_o, S_o);
    float upper = 2.0 / EON_PI * q * eon_segment(mu_o, S_o);
    float multiple = EON_LOSS_AVG * eon_grey_weight(rho, roughness) * fon_loss(mu_o);
    float v = u1 * (lower + upper + multiple + 1.0);
    if (v < lower)
        return eon_lower_draw(v / lower, u2, mu_o, S_o);
    v = v - lower;
    if (v < upper)
        return eon_upper_draw(v / upper, u2, mu_o, S_o);
    v = v - upper;
    if (v < multiple)
        return eon_multiple_draw(v / multiple, u2);
    return eon_flat_draw(min(v - multiple, EON_BELOW_ONE), u2, q);
}

// In proportion to EON with a grey rho, times the cosine: docs/sampling.md. The end of a part may
// reach the horizon, where the density is 0 and a weight 0 / 0.
vec3 eon_sample(vec3 wo, float u1, float u2, float rho, float roughness)
{
    vec3 turn = eon_azimuth(wo);
    vec3 wi = eon_draw(min(wo.z, 1.0), turn.z, u1, u2, rho, roughness);
    wi = eon_turned(wi, turn.x, turn.y);
    return vec3(wi.x, wi.y, max(wi.z, EON_HORIZON));
}

// EON with a grey rho times the cosine, over its integral: [Portsmouth2025], Eqs. (16), (19), (28).
float eon_pdf(vec3 wo, vec3 wi, float rho, float roughness)
{
    float mu_o = min(wo.z, 1.0);
    float mu_i = min(wi.z, 1.0);
    float s = oren_nayar_s(wo, wi);
    float weight = eon_grey_weight(rho, roughness);
    float multiple = weight * fon_loss(mu_o) * fon_loss(mu_i);
    float parts = 1.0 + roughness * fon_quotient(mu_o, mu_i, s) + multiple;
    float total = 1.0 + EON_C1 * roughness + (weight * EON_LOSS_AVG - roughness) * fon_loss(mu_o);
    return mu_i * parts / (EON_PI * total);
}
