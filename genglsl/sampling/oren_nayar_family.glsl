// SPDX-License-Identifier: Apache-2.0

#include "../lib/eon.glsl"

// Models of the Oren-Nayar family, named as in the Python package.
//
// wo and wi are unit vectors that leave the surface, in a local frame with the normal +z, and not
// below the horizon. BRDFs do not include the cosine. Albedos of QON and FON are for rho = 1.

// Coefficients of G_F / pi: [Portsmouth2025], Eq. (14), for mu in [0, 1]. Largest error: 6.0e-4.
#define EON_G1 0.0571085289
#define EON_G2 0.491881867
#define EON_G3 -0.332181442
#define EON_G4 0.0714429953

// Average albedo of QON: [Portsmouth2025], Eq. (9).
float qon_albedo_avg(float sigma)
{
    return qon_aq(sigma) + (2.0 / 3.0 - 64.0 / (45.0 * EON_PI)) * qon_bq(sigma);
}

// Directional albedo of FON: [Portsmouth2025], Eq. (12), as 1 - r H / (1 + c1 r) with roughness r
// and H = fon_loss.
float fon_albedo_dir(float mu, float roughness)
{
    return 1.0 - roughness * fon_loss(mu) * fon_af(roughness);
}

// Average albedo of FON: [Portsmouth2025], Eq. (15).
float fon_albedo_avg(float roughness)
{
    return (1.0 + EON_C2 * roughness) * fon_af(roughness);
}

// Approximate fon_loss, with G_F by [Portsmouth2025], Eq. (14).
float fon_loss_approx(float mu)
{
    float m = 1.0 - mu;
    return EON_C1 - m * (EON_G1 + m * (EON_G2 + m * (EON_G3 + m * EON_G4)));
}

// Approximate albedo of FON: [Portsmouth2025], Eqs. (12), (14).
float fon_albedo_dir_approx(float mu, float roughness)
{
    return 1.0 - roughness * fon_loss_approx(mu) * fon_af(roughness);
}

// Approximate albedo of EON: [Portsmouth2025], Eq. (28) with the albedo of Eq. (14).
vec3 eon_albedo_dir_approx(float mu, vec3 rho, float roughness)
{
    vec3 D = eon_denominator(rho, roughness);
    return rho * (vec3(1.0) - roughness * fon_loss_approx(mu) * (vec3(1.0) - rho) / D);
}

// Average albedo of EON. The directional albedo is linear in fon_loss.
vec3 eon_albedo_avg(vec3 rho, float roughness)
{
    vec3 D = eon_denominator(rho, roughness);
    return rho * (vec3(1.0) - roughness * EON_LOSS_AVG * (vec3(1.0) - rho) / D);
}

// s = dot(wo, wi) - mu_o mu_i of [Portsmouth2025], Eq. (3), for the normal +z.
float oren_nayar_s(vec3 wo, vec3 wi)
{
    return wo.x * wi.x + wo.y * wi.y;
}

// BRDF of Lambert's model.
vec3 lambert_brdf(vec3 wo, vec3 wi, vec3 rho)
{
    return rho / EON_PI;
}

// Angle with sine y and cosine x, divided by pi / 2. A polynomial (tools/fits/arc_tangent.py) is
// used, because SwiftShader's cosine is off by 1.9e-4 and OSL's arc tangent by 1.2e-5.
float oren_nayar_angle(float y, float x)
{
    float t_half = y / (1.0 + x);
    float t = t_half / (1.0 + sqrt(1.0 + t_half * t_half));
    float z = t * t;
    float series = 0.99999998 + z * (-0.33332786 + z * (0.19974082 + z * (-0.13848490 + z * 0.07976292)));
    return 8.0 / EON_PI * t * series;
}

// Factor of oren_nayar_brdf: (sin(alpha) - (2 beta / pi)^3) / cos(beta), or 6 / pi if both
// directions are grazing. The form without cancellation is derived in
// python/mxeon/models/diffuse.py.
float oren_nayar_behind_slope(float mu_o, float mu_i, float S_o, float S_i)
{
    float high = max(mu_o, mu_i);
    float low = min(mu_o, mu_i);
    float q = oren_nayar_angle(high, min(S_o, S_i));
    float rise = q * (3.0 - 3.0 * q + q * q) - low * low / (1.0 + max(S_o, S_i));
    return high > 1.0e-37 ? rise / high : 6.0 / EON_PI;
}

// BRDF of [OrenNayar1994], functional approximation for Gaussian slopes with interreflection. alpha
// is the larger polar angle, beta the smaller. The code divides both angles by pi / 2.
//   f = rho / pi [C1 + C2 cos(phi) tan(beta) + C3 (1 - |cos(phi)|) tan((alpha + beta) / 2)]
//       + 0.17 rho^2 / pi k (1 - (2 beta / pi)^2 cos(phi)),  k = sigma^2 / (sigma^2 + 0.13)
vec3 oren_nayar_brdf(vec3 wo, vec3 wi, vec3 rho, float sigma)
{
    float mu_o = min(wo.z, 1.0);
    float mu_i = min(wi.z, 1.0);
    float s = oren_nayar_s(wo, wi);
    float S_o = sqrt(wo.x * wo.x + wo.y * wo.y);
    float S_i = sqrt(wi.x * wi.x + wi.y * wi.y);
    float alpha = oren_nayar_angle(max(S_o, S_i), min(mu_o, mu_i));
    float beta = oren_nayar_angle(min(S_o, S_i), max(mu_o, mu_i));
    float cos_phi = oren_nayar_quotient(s, S_o * S_i);
    float behind = oren_nayar_quotient(min(s, 0.0), max(S_o, S_i))
                   * oren_nayar_behind_slope(mu_o, mu_i, S_o, S_i);
    float C3 = 0.125 / 0.45 * qon_bq(sigma) * (alpha * beta) * (alpha * beta);
    float aside = (1.0 - abs(cos_phi)) * oren_nayar_quotient(S_o + S_i, mu_o + mu_i);
    float single_scatter = qon_aq(sigma) + qon_bq(sigma) * (qon_quotient(mu_o, mu_i, s) + behind);
    float k = sigma * sigma / (sigma * sigma + 0.13);
    float interreflection = 0.17 * k * (1.0 - beta * beta * cos_phi);
    return 1.0 / EON_PI * rho * (vec3(single_scatter + C3 * aside) + interreflection * rho);
}

// BRDF of QON: [Portsmouth2025], Eqs. (1), (3), (4).
vec3 qon_brdf(vec3 wo, vec3 wi, vec3 rho, float sigma)
{
    return qon_brdf_mu(min(wo.z, 1.0), min(wi.z, 1.0), oren_nayar_s(wo, wi), rho, sigma);
}

// BRDF of QON with 0.57 instead of 0.33 in A_q: [Portsmouth2025], footnote 1; [OrenNayar1994].
vec3 qon_footnote_brdf(vec3 wo, vec3 wi, vec3 rho, float sigma)
{
    float quotient = qon_quotient(wo.z, wi.z, oren_nayar_s(wo, wi));
    float A = 1.0 - 0.5 * sigma * sigma / (sigma * sigma + 0.57);
    return 1.0 / EON_PI * (A + qon_bq(sigma) * quotient) * rho;
}

// BRDF of [Fujii2013], first formula, with B_q of QON, s / t of FON and A growing with rho.
vec3 qon_fujii_brdf(vec3 wo, vec3 wi, vec3 rho, float sigma)
{
    float quotient = fon_quotient(wo.z, wi.z, oren_nayar_s(wo, wi));
    vec3 tinted = 0.17 * sigma * sigma / (sigma * sigma + 0.13) * rho;
    return 1.0 / EON_PI * rho * (vec3(qon_aq(sigma) + qon_bq(sigma) * quotient) + tinted);
}

// BRDF of FON: [Portsmouth2025], Eq. (10).
vec3 fon_brdf(vec3 wo, vec3 wi, vec3 rho, float roughness)
{
    float quotient = fon_quotient(wo.z, wi.z, oren_nayar_s(wo, wi));
    return 1.0 / EON_PI * fon_af(roughness) * (1.0 + roughness * quotient) * rho;
}

// BRDF of EON: [Portsmouth2025], Eq. (16).
vec3 eon_brdf(vec3 wo, vec3 wi, vec3 rho, float roughness)
{
    return eon_brdf_mu(min(wo.z, 1.0), min(wi.z, 1.0), oren_nayar_s(wo, wi), rho, roughness);
}

// BRDF of EON with the albedo of Eq. (14): [Portsmouth2025], Eq. (16). Below mu = 0.0014, the
// approximate loss is negative and counts as 0, but the listing clamps 1 - E to 1e-7.
vec3 eon_brdf_approx(vec3 wo, vec3 wi, vec3 rho, float roughness)
{
    float single_scatter = 1.0 + roughness * fon_quotient(wo.z, wi.z, oren_nayar_s(wo, wi));
    float losses = max(fon_loss_approx(wo.z), 0.0) * max(fon_loss_approx(wi.z), 0.0);
    vec3 multi_scatter = losses * eon_multiple_ratio(rho, roughness);
    return 1.0 / EON_PI * fon_af(roughness) * rho * (vec3(single_scatter) + multi_scatter);
}
