// SPDX-License-Identifier: Apache-2.0
// Functions to time the shaders against, none of which is shipped: EON and its sampling with the
// operations of the paper's listings.
//
// Included after eon_sampling.glsl, whose constants and matrix it uses. That file computes H instead of
// albedos; this one keeps the divisions, bounds and shared terms of [Portsmouth2025], Listings 1, 3 and 4.

#define PRINTED_EPSILON 1.0e-7

// [Portsmouth2025], Eqs. (12), (14).
float printed_albedo_quartic(float mu, float roughness)
{
    float m = 1.0 - mu;
    float G_over_pi = m * (EON_G1 + m * (EON_G2 + m * (EON_G3 + m * EON_G4)));
    return (1.0 + roughness * G_over_pi) / (1.0 + EON_C1 * roughness);
}

// [Portsmouth2025], Eqs. (16), (19) from the albedos of both directions.
vec3 printed_eon(float mu_o, float mu_i, float s, vec3 rho, float roughness, float E_o, float E_i)
{
    float A = 1.0 / (1.0 + EON_C1 * roughness);
    float quotient = s > 0.0 ? s / max(mu_i, mu_o) : s;
    vec3 single = rho * (1.0 / EON_PI) * A * (1.0 + roughness * quotient);
    float average = A * (1.0 + EON_C2 * roughness);
    vec3 tint = rho * rho * average / (vec3(1.0) - rho * (1.0 - average));
    vec3 multiple = tint * (1.0 / EON_PI) * max(PRINTED_EPSILON, 1.0 - E_o)
                    * max(PRINTED_EPSILON, 1.0 - E_i) / max(PRINTED_EPSILON, 1.0 - average);
    return single + multiple;
}

vec3 printed_quartic(float mu_o, float mu_i, float s, vec3 rho, float roughness)
{
    float E_o = printed_albedo_quartic(mu_o, roughness);
    float E_i = printed_albedo_quartic(mu_i, roughness);
    return printed_eon(mu_o, mu_i, s, rho, roughness, E_o, E_i);
}

// Direction and density together, which share the matrix: [Portsmouth2025], Listing 3.
vec4 printed_cltc(vec3 wo, float u1, float u2, float roughness)
{
    float a = ltc_ma(wo.z, roughness);
    float b = ltc_mb(wo.z, roughness);
    float c = ltc_mc(wo.z, roughness);
    float d = ltc_md(wo.z, roughness);
    float kept = cltc_kept_fraction(d);
    vec3 wh = cltc_clipped(u1, u2, d);
    vec3 wi = vec3(a * wh.x + b * wh.z, c * wh.y, d * wh.x + wh.z);
    float size = length(wi);
    float pdf = wh.z / (EON_PI * kept) * size * size * size / (c * (a - b * d));
    vec3 turn = eon_azimuth_frame(wo);
    return vec4(eon_rotate_z(wi / size, turn.x, turn.y), pdf);
}

// [Portsmouth2025], Listing 4.
vec4 printed_sample(vec3 wo, float u1, float u2, float roughness)
{
    float P_u = eon_cltc_probability(wo.z, roughness);
    vec4 drawn;
    if (u1 <= P_u)
    {
        vec3 wi = uniform_sample(u1 / P_u, u2);
        drawn = vec4(wi, cltc_pdf(wo, wi, roughness));
    }
    else
        drawn = printed_cltc(wo, (u1 - P_u) / (1.0 - P_u), u2, roughness);
    return vec4(drawn.xyz, P_u * (0.5 / EON_PI) + (1.0 - P_u) * drawn.w);
}
