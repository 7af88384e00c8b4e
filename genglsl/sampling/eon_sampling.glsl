// SPDX-License-Identifier: Apache-2.0

#include "ltc_sampling.glsl"

// Exact importance sampling of EON with two random numbers.
//
// eon_sample draws a direction wi, and eon_pdf is the density of wi in 1/sr. Arguments are as in
// ltc_sampling. EON is the sum of the parts `flat`, `lower`, `upper` and `multiple`, which
// docs/sampling.md defines for wo at azimuth 0. mu and S are the cosine and sine of a polar angle,
// and mu_o and S_o are those of wo. q is roughness times S_o, and v is a random number in [0, 1).

// Least cosine of a sample.
#define EON_HORIZON (1.0 / 16777216.0)

// Coefficients to draw cosines of the parts `multiple` and `upper`. Source:
// tools/fits/eon_sampling.py. Domain: random numbers and their roots in [0, 1]. Largest relative
// errors: 1.27e-5 of MULTIPLE's density, 5.7e-6 of UPPER's density, 1.8e-7 of ROOT's y.
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

// Weight eon_multiple_ratio of multiple scattering for a gray rho.
float eon_gray_ratio(float rho, float roughness)
{
    float weight = roughness * (1.0 + EON_C2 * roughness) * (1.0 / EON_LOSS_AVG);
    return weight * rho / (1.0 + EON_C1 * roughness - roughness * EON_LOSS_AVG * rho);
}

// (1 - S^3) / mu without cancellation or a division by mu.
float eon_cube_gap(float mu, float S)
{
    return mu * (1.0 + S + S * S) / (1.0 + S);
}

// Direction with z = mu, x >= 0 and a uniform y in [-S, S].
vec3 eon_towards(float mu, float S, float u2)
{
    return vec3(2.0 * S * sqrt(u2 * (1.0 - u2)), S * (2.0 * u2 - 1.0), mu);
}

// Part `lower`: a cosine below mu_o, drawn in proportion to S mu, for a uniform x = 1 - S^3.
float eon_lower_cosine(float x, float S)
{
    return sqrt(x * (1.0 + S) / (1.0 + S + S * S));
}

// Part `upper`: the inverse y(m) of m = y Q(y), where m is 1 - mu.
float eon_upper_root(float m)
{
    float high = EON_ROOT3 + m * (EON_ROOT4 + m * EON_ROOT5);
    return m * (EON_ROOT0 + m * (EON_ROOT1 + m * (EON_ROOT2 + m * high)));
}

// Part `upper`: the polynomial Q(y), where Q(1) = 1.
float eon_upper_quotient(float y)
{
    float y2 = y * y;
    float even = EON_UPPER0 + y2 * (EON_UPPER2 + y2 * EON_UPPER4);
    float odd = EON_UPPER1 + y2 * (EON_UPPER3 + y2 * EON_UPPER5);
    return 1.0 + (1.0 - y) * (even + y * odd);
}

// Part `upper`: a cosine above mu_o, drawn in proportion to S (1 - mu). y is v^(2 / 5), and y_o is
// eon_upper_root(1 - mu_o). Division by Q(y_o) makes the cosine exactly mu_o at y = 1.
float eon_upper_cosine(float y, float mu_o, float y_o)
{
    return 1.0 - (1.0 - mu_o) / eon_upper_quotient(y_o) * (y * eon_upper_quotient(y_o * y));
}

// Part `multiple`: a cosine drawn in proportion to mu fon_loss(mu). t is v^(1 / 3).
float eon_multiple_cosine(float t)
{
    float m = max(1.0 - t, 0.0);
    float w = sqrt(m);
    float even = EON_MULTIPLE0 + m * (EON_MULTIPLE1 + m * EON_MULTIPLE3);
    float odd = EON_MULTIPLE2 + m * (EON_MULTIPLE4 + m * m * EON_MULTIPLE5);
    return t * (1.0 + m * (even + m * w * odd));
}

// Part `flat`: a direction whose projection onto the disk has a density in proportion to 1 + q x. A
// uniform point of the disk is moved parallel to x.
vec3 eon_flat_draw(float v, float u2, float q)
{
    vec3 wh = cosine_sample(v, u2);
    float ahead = 1.0 + q * wh.x;
    float root = sqrt(ahead * ahead + q * q * (1.0 - v));
    float z = sqrt(2.0 * (1.0 - v) / (ahead + root));
    return vec3((q * (1.0 - wh.y * wh.y) + 2.0 * wh.x) / (1.0 + root), wh.y, z);
}

// Direction for wo at azimuth 0. u1 chooses a part in proportion to the part's integral, which is 1
// for `flat`. Parts except `flat` share one call of pow, which saves time on GPUs.
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

// Direction drawn in proportion to EON with a gray rho times the cosine: docs/sampling.md. Samples
// avoid the horizon, where the density is 0 and a weight would be 0 / 0.
vec3 eon_sample(vec3 wo, float u1, float u2, float rho, float roughness)
{
    vec3 turn = eon_azimuth_frame(wo);
    vec3 wi = eon_draw(min(wo.z, 1.0), turn.z, u1, u2, rho, roughness);
    wi = eon_rotate_z(wi, turn.x, turn.y);
    return vec3(wi.x, wi.y, max(wi.z, EON_HORIZON));
}

// Density of eon_sample: EON with a gray rho times the cosine, divided by the albedo.
// [Portsmouth2025], Eqs. (16), (19), (28).
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
