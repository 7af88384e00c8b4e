// SPDX-License-Identifier: Apache-2.0
// Exact importance sampling of EON with two random numbers, no table and no iteration.
//
// eon_sample draws wi, and eon_pdf is the density of wi in 1/sr. Directions and random numbers are
// as in ltc_sampling. On the disk below the hemisphere, with wo at azimuth 0, EON is the sum of
// four parts: docs/sampling.md. v is a random number in [0, 1); mu_o and S_o are cosine and sine of
// wo.

#include "ltc_sampling.glsl"

// The least cosine of a sample.
#define EON_HORIZON (1.0 / 16777216.0)

// Inverse distributions of two parts of EON. Source: tools/fits/eon_sampling.py. Domain: random
// numbers and their roots in [0, 1]. Largest relative errors: 1.27e-5 and 5.7e-6 of the densities,
// and 1.8e-7 of ROOT, the inverse of m = y Q(y).
#define EON_MULTIPLE0 -0.1221923217
#define EON_MULTIPLE1 0.3674909842
#define EON_MULTIPLE2 -0.5228247070
#define EON_MULTIPLE3 0.4013565309
#define EON_MULTIPLE4 -0.1292139302
#define EON_MULTIPLE5 0.0102229681
#define EON_UPPER0 -0.0857788216
#define EON_UPPER1 -0.0262131579
#define EON_UPPER2 -0.0086607754
#define EON_UPPER3 -0.0096479330
#define EON_UPPER4 0.0067351199
#define EON_UPPER5 -0.0065900984
#define EON_ROOT0 1.0938298847
#define EON_ROOT1 -0.0781435851
#define EON_ROOT2 -0.0116435545
#define EON_ROOT3 -0.0032983444
#define EON_ROOT4 0.0001101024
#define EON_ROOT5 -0.0008543250

// eon_multiple_ratio of a gray rho.
float eon_gray_ratio(float rho, float roughness)
{
    float weight = roughness * (1.0 + EON_C2 * roughness) * (1.0 / EON_LOSS_AVG);
    return weight * rho / (1.0 + EON_C1 * roughness - roughness * EON_LOSS_AVG * rho);
}

// (1 - S^3) / mu without a division by mu or cancellation.
float eon_cube_gap(float mu, float S)
{
    return mu * (1.0 + S + S * S) / (1.0 + S);
}

// Direction on the side of wo with cosine mu and sine S. The sine of the azimuth is uniform.
vec3 eon_towards(float mu, float S, float u2)
{
    return vec3(2.0 * S * sqrt(u2 * (1.0 - u2)), S * (2.0 * u2 - 1.0), mu);
}

// Cosine below mu_o, drawn in proportion to S mu, for a uniform x = 1 - S^3.
float eon_lower_cosine(float x, float S)
{
    return sqrt(x * (1.0 + S) / (1.0 + S + S * S));
}

// y(m) = (K / K(pi / 2))^(2 / 5), the inverse of m = y Q(y). K is the integral of sin^2 (1 - cos)
// up to the angle whose cosine is 1 - m.
float eon_upper_root(float m)
{
    float high = EON_ROOT3 + m * (EON_ROOT4 + m * EON_ROOT5);
    return m * (EON_ROOT0 + m * (EON_ROOT1 + m * (EON_ROOT2 + m * high)));
}

// Q(y) of eon_upper_cosine, where Q(1) = 1.
float eon_upper_quotient(float y)
{
    float y2 = y * y;
    float even = EON_UPPER0 + y2 * (EON_UPPER2 + y2 * EON_UPPER4);
    float odd = EON_UPPER1 + y2 * (EON_UPPER3 + y2 * EON_UPPER5);
    return 1.0 + (1.0 - y) * (even + y * odd);
}

// Cosine above mu_o, drawn in proportion to S (1 - mu), for a uniform K. With y = v^(2 / 5) and
// m(K) = y Q(y), 1 - mu = m(v K_o) (1 - mu_o) / m(K_o).
float eon_upper_cosine(float y, float mu_o, float y_o)
{
    return 1.0 - (1.0 - mu_o) / eon_upper_quotient(y_o) * (y * eon_upper_quotient(y_o * y));
}

// Cosine drawn in proportion to H(mu) mu, as a function of t = v^(1 / 3).
float eon_multiple_cosine(float t)
{
    float m = max(1.0 - t, 0.0);
    float w = sqrt(m);
    float even = EON_MULTIPLE0 + m * (EON_MULTIPLE1 + m * EON_MULTIPLE3);
    float odd = EON_MULTIPLE2 + m * (EON_MULTIPLE4 + m * m * EON_MULTIPLE5);
    return t * (1.0 + m * (even + m * w * odd));
}

// Direction drawn in proportion to 1 + q x. The inverse distribution of x moves a uniform disk
// point along a chord. z is sqrt(1 - x^2 - y^2) without cancellation.
vec3 eon_flat_draw(float v, float u2, float q)
{
    vec3 wh = cosine_sample(v, u2);
    float ahead = 1.0 + q * wh.x;
    float root = sqrt(ahead * ahead + q * q * (1.0 - v));
    float z = sqrt(2.0 * (1.0 - v) / (ahead + root));
    return vec3((q * (1.0 - wh.y * wh.y) + 2.0 * wh.x) / (1.0 + root), wh.y, z);
}

// Direction for wo at azimuth 0. u1 chooses one of four parts in proportion to their integrals, pi
// for the flat part. The other parts share one costly pow, since GPU lanes that choose different
// parts pay for all.
vec3 eon_draw(float mu_o, float S_o, float u1, float u2, float rho, float roughness)
{
    float q = roughness * S_o;
    float y_o = eon_upper_root(1.0 - mu_o);
    float lower = 2.0 / EON_PI * q * (1.0 - mu_o) / 3.0 * eon_cube_gap(mu_o, S_o);
    float upper = EON_C1 * q * y_o * y_o * sqrt(y_o);
    float multiple = EON_LOSS_AVG * eon_gray_ratio(rho, roughness) * fon_loss(mu_o);
    float towards = lower + upper;
    float polar = towards + multiple;
    float v = u1 * (polar + 1.0);
    float x = v * (1.5 * EON_PI * mu_o / (q * (1.0 - mu_o)));
    float part = v < towards ? (v - lower) * (1.0 / upper) : (v - towards) * (1.0 / multiple);
    float power = v < lower || v >= towards ? 1.0 / 3.0 : 0.4;
    float root = pow(v < lower ? max(1.0 - x, 0.0) : part, power);
    if (v >= polar)
        return eon_flat_draw(min(v - polar, EON_BELOW_ONE), u2, q);
    float mu = v < towards ? eon_upper_cosine(root, mu_o, y_o) : eon_multiple_cosine(root);
    if (v < lower)
        mu = eon_lower_cosine(x, root);
    float S = sqrt(max((1.0 - mu) * (1.0 + mu), 0.0));
    return v < towards ? eon_towards(mu, S, u2) : eon_around(mu, S, u2);
}

// Direction drawn in proportion to the cosine times EON with a gray rho: docs/sampling.md. Samples
// avoid the horizon, where the density is 0 and a weight is 0 / 0.
vec3 eon_sample(vec3 wo, float u1, float u2, float rho, float roughness)
{
    vec3 turn = eon_azimuth_frame(wo);
    vec3 wi = eon_draw(min(wo.z, 1.0), turn.z, u1, u2, rho, roughness);
    wi = eon_rotate_z(wi, turn.x, turn.y);
    return vec3(wi.x, wi.y, max(wi.z, EON_HORIZON));
}

// Cosine times EON with a gray rho, divided by the integral: [Portsmouth2025], Eqs. (16), (19),
// (28).
float eon_pdf(vec3 wo, vec3 wi, float rho, float roughness)
{
    float mu_o = min(wo.z, 1.0);
    float mu_i = min(wi.z, 1.0);
    float s = oren_nayar_s(wo, wi);
    float weight = eon_gray_ratio(rho, roughness);
    float multiple = weight * fon_loss(mu_o) * fon_loss(mu_i);
    float parts = 1.0 + roughness * fon_quotient(mu_o, mu_i, s) + multiple;
    float total = 1.0 + EON_C1 * roughness + (weight * EON_LOSS_AVG - roughness) * fon_loss(mu_o);
    return mu_i * parts * (1.0 / (EON_PI * total));
}
