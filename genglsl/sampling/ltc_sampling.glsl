// SPDX-License-Identifier: Apache-2.0

#include "oren_nayar_family.glsl"

// Sampling of the hemisphere: uniform, by the cosine, by a linearly transformed cosine (LTC), and
// by a clipped LTC (CLTC).
//
// For a lobe x, x_sample draws a direction wi, and x_pdf is the density of wi in 1/sr. Directions
// are as in oren_nayar_family. u1 and u2 are independent uniform random numbers in [0, 1). d is an
// entry of the LTC's matrix M, and `turn` is the result of eon_azimuth_frame.

// Largest float32 below 1.
#define EON_BELOW_ONE (1.0 - 1.0 / 16777216.0)

// Cosine and sine of the azimuth of wo, and the sine S_o of the polar angle. The azimuth is 0 if
// S_o^2 underflows.
vec3 eon_azimuth_frame(vec3 wo)
{
    float S_o = min(sqrt(wo.x * wo.x + wo.y * wo.y), 1.0);
    return S_o > 1.0e-18 ? vec3(wo.x / S_o, wo.y / S_o, S_o) : vec3(1.0, 0.0, 0.0);
}

// Direction wi, rotated about the normal by an angle.
vec3 eon_rotate_z(vec3 wi, float cosine, float sine)
{
    return vec3(cosine * wi.x - sine * wi.y, sine * wi.x + cosine * wi.y, wi.z);
}

// Direction with cosine mu and sine S at the azimuth 2 pi u2.
vec3 eon_around(float mu, float S, float u2)
{
    float phi = 2.0 * EON_PI * u2;
    return vec3(S * cos(phi), S * sin(phi), mu);
}

// Uniform direction: [Portsmouth2025], Listing 4.
vec3 uniform_sample(float u1, float u2)
{
    return eon_around(u1, sqrt((1.0 - u1) * (1.0 + u1)), u2);
}

// Density of uniform_sample, 1 / (2 pi).
float uniform_pdf(vec3 wi)
{
    return 0.5 / EON_PI;
}

// Direction drawn in proportion to the cosine: [Portsmouth2025], Eq. (21).
vec3 cosine_sample(float u1, float u2)
{
    return eon_around(sqrt(1.0 - u1), sqrt(u1), u2);
}

// Density of cosine_sample, the cosine divided by pi.
float cosine_pdf(vec3 wi)
{
    return wi.z / EON_PI;
}

// Entries a, b, c and d of M for a cosine mu and roughness in [0, 1]: [Portsmouth2025], Listing 2,
// which states no error.
float ltc_ma(float mu, float roughness)
{
    return 1.0 + roughness * (0.303392 + (-0.518982 + 0.111709 * mu) * mu
                              + (-0.276266 + 0.335918 * mu) * roughness);
}

float ltc_mb(float mu, float roughness)
{
    float b = -1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * roughness;
    return roughness * b / (mu * mu * mu - 1.43545);
}

float ltc_mc(float mu, float roughness)
{
    return 1.0 + roughness * (0.20013 + (-0.506373 + 0.261777 * mu) * mu);
}

float ltc_md(float mu, float roughness)
{
    float d = 0.540852 + (-1.01625 + 0.475392 * mu) * mu;
    return roughness * d / (-1.0743 + (0.0725628 + mu) * mu);
}

// Direction M wh for a direction wh, normalized and rotated to the azimuth of wo: [Portsmouth2025],
// Eqs. (22), (25).
vec3 ltc_transformed(vec3 wo, vec3 wh, float roughness, float d)
{
    float a = ltc_ma(wo.z, roughness);
    float b = ltc_mb(wo.z, roughness);
    float c = ltc_mc(wo.z, roughness);
    vec3 wi = normalize(vec3(a * wh.x + b * wh.z, c * wh.y, d * wh.x + wh.z));
    vec3 turn = eon_azimuth_frame(wo);
    return eon_rotate_z(wi, turn.x, turn.y);
}

// Density of the LTC: [Portsmouth2025], Eqs. (23), (24). The length of wh = adj(M) wi enters the
// density, so wh is not normalized.
float ltc_density(vec3 wo, vec3 wi, float roughness, float d)
{
    float a = ltc_ma(wo.z, roughness);
    float b = ltc_mb(wo.z, roughness);
    float c = ltc_mc(wo.z, roughness);
    float det = c * (a - b * d);
    vec3 turn = eon_azimuth_frame(wo);
    vec3 back = eon_rotate_z(wi, turn.x, -turn.y);
    float wh_z = c * (a * back.z - d * back.x);
    vec3 wh = vec3(c * (back.x - b * back.z), (a - b * d) * back.y, wh_z);
    float ratio = det / dot(wh, wh);
    return ratio * ratio * max(wh_z, 0.0) / EON_PI;
}

// Direction drawn from the LTC. Samples below the horizon are wasted.
vec3 ltc_sample(vec3 wo, float u1, float u2, float roughness)
{
    return ltc_transformed(wo, cosine_sample(u1, u2), roughness, ltc_md(wo.z, roughness));
}

float ltc_pdf(vec3 wo, vec3 wi, float roughness)
{
    return ltc_density(wo, wi, roughness, ltc_md(wo.z, roughness));
}

// Fraction of the LTC above the horizon, where d wh.x + wh.z > 0: [Portsmouth2025], below Eq. (26).
float cltc_kept_fraction(float d)
{
    return 0.5 + 0.5 / sqrt(1.0 + d * d);
}

// Direction (x, y, z) drawn in proportion to the cosine where d x + z >= 0: [Portsmouth2025],
// Listing 3, but mirrored if d > 0. Rounding may leave x^2 + y^2 > 1.
vec3 cltc_clipped(float u1, float u2, float d)
{
    vec3 wh = cosine_sample(u1, u2);
    float x = mix(sqrt(max(1.0 - wh.y * wh.y, 0.0)), wh.x, cltc_kept_fraction(d));
    return vec3(d > 0.0 ? x : -x, wh.y, sqrt(max(1.0 - (x * x + wh.y * wh.y), 0.0)));
}

// Direction drawn from the CLTC. Rounding must not move the direction below the horizon.
vec3 cltc_sample(vec3 wo, float u1, float u2, float roughness)
{
    float d = ltc_md(wo.z, roughness);
    vec3 wi = ltc_transformed(wo, cltc_clipped(u1, u2, d), roughness, d);
    return vec3(wi.x, wi.y, max(wi.z, 0.0));
}

// Density of cltc_sample: [Portsmouth2025], Eq. (27).
float cltc_pdf(vec3 wo, vec3 wi, float roughness)
{
    float d = ltc_md(wo.z, roughness);
    return ltc_density(wo, wi, roughness, d) / cltc_kept_fraction(d);
}

// Probability P_u of the uniform lobe for mu and roughness in [0, 1]: [Portsmouth2025], Listing 4.
float eon_cltc_probability(float mu, float roughness)
{
    float P_u = 0.162925 + (-0.372058 + (0.538233 - 0.290822 * mu) * mu) * mu;
    return pow(roughness, 0.1) * P_u;
}

// Direction drawn from the mixture of CLTC and uniform sampling: [Portsmouth2025], Listing 4, but
// with u1 < P_u instead of u1 <= P_u, which avoids a division by P_u = 0.
vec3 eon_cltc_sample(vec3 wo, float u1, float u2, float roughness)
{
    float P_u = eon_cltc_probability(wo.z, roughness);
    if (u1 < P_u)
        return uniform_sample(min(u1 / P_u, EON_BELOW_ONE), u2);
    return cltc_sample(wo, min((u1 - P_u) / (1.0 - P_u), EON_BELOW_ONE), u2, roughness);
}

float eon_cltc_pdf(vec3 wo, vec3 wi, float roughness)
{
    float P_u = eon_cltc_probability(wo.z, roughness);
    return P_u * uniform_pdf(wi) + (1.0 - P_u) * cltc_pdf(wo, wi, roughness);
}
