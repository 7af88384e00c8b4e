// SPDX-License-Identifier: Apache-2.0
// Albedos and BRDFs of qualitative (QON), Fujii's (FON) and energy-preserving (EON) Oren-Nayar.
//
// mu_o and mu_i are the cosines of wo and wi with the normal, in [0, 1]. s is dot(wo, wi) - mu_o *
// mu_i. BRDFs do not include the cosine.

#define EON_PI 3.14159265358979
#define EON_C1 (0.5 - 2.0 / (3.0 * EON_PI))
#define EON_C2 (2.0 / 3.0 - 28.0 / (15.0 * EON_PI))

// Cosine-weighted average of fon_loss over the hemisphere, equal to EON_C1 - EON_C2.
#define EON_LOSS_AVG (6.0 / (5.0 * EON_PI) - 1.0 / 6.0)

// Coefficients of fon_loss. Source and equations: tools/fits/fon_loss.py. Domain: mu in [0, 1].
// Largest relative error: 2.7e-7, or 5.4e-7 in float32.
#define EON_P0 0.318309971
#define EON_P1 0.143885045
#define EON_P2 -0.449159307
#define EON_P3 0.42190335
#define EON_P4 -0.147145689
#define EON_Q0 0.527481849
#define EON_Q1 -0.248895342
#define EON_Q2 -0.125382218
#define EON_Q3 0.0571913429

// H(mu) = c1 - G_F(mu) / pi, where G_F is Eq. (13) of [Portsmouth2025]. FON with roughness r and
// albedo E loses the energy 1 - E(mu) = r H(mu) / (1 + c1 r).
float fon_loss(float mu)
{
    float m = 1.0 - mu;
    float S = sqrt(m * (1.0 + mu));
    float P = EON_P0 + mu * (EON_P1 + mu * (EON_P2 + mu * (EON_P3 + mu * EON_P4)));
    float Q = EON_Q0 + mu * (EON_Q1 + mu * (EON_Q2 + mu * EON_Q3));
    return mu * (P + (1.0 - S) * m * Q);
}

// A_F of [Portsmouth2025], below Eq. (11).
float fon_af(float roughness)
{
    return 1.0 / (1.0 + EON_C1 * roughness);
}

// Lambertian factor rho A_F / pi: [Portsmouth2025], Eq. (10).
vec3 fon_lambert(vec3 rho, float roughness)
{
    return 1.0 / EON_PI * fon_af(roughness) * rho;
}

// A_q of [Portsmouth2025], below Eq. (1).
float qon_aq(float sigma)
{
    float sigma2 = sigma * sigma;
    return 1.0 - 0.5 * sigma2 / (sigma2 + 0.33);
}

// B_q of [Portsmouth2025], below Eq. (1).
float qon_bq(float sigma)
{
    float sigma2 = sigma * sigma;
    return 0.45 * sigma2 / (sigma2 + 0.09);
}

// Denominator D = (1 + c1 r)(1 - rho (1 - <E>)) >= 1 of [Portsmouth2025], Eq. (18), for roughness
// r.
vec3 eon_denominator(vec3 rho, float roughness)
{
    return vec3(1.0 + EON_C1 * roughness) - roughness * EON_LOSS_AVG * rho;
}

// Albedo of QON for rho = 1: [Portsmouth2025], Eqs. (5), (8), with G_q by Eq. (13).
float qon_albedo_dir(float mu, float sigma)
{
    float S = sqrt((1.0 - mu) * (1.0 + mu));
    float G_over_pi = EON_C1 - fon_loss(mu) + 2.0 / (3.0 * EON_PI) * S;
    return qon_aq(sigma) + qon_bq(sigma) * G_over_pi;
}

// Albedo of EON: [Portsmouth2025], Eq. (28), simplified to rho (1 - r H (1 - rho) / D), where H is
// fon_loss and D is eon_denominator.
vec3 eon_albedo_dir(float mu, vec3 rho, float roughness)
{
    vec3 loss = roughness * fon_loss(mu) * (vec3(1.0) - rho) / eon_denominator(rho, roughness);
    return rho * (vec3(1.0) - loss);
}

// Quotient value / divisor, or 0 if the divisor, a cosine or sine, is at most 1e-37. The quotient
// might overflow, and infinity times 0 is NaN.
float oren_nayar_quotient(float value, float divisor)
{
    return divisor > 1.0e-37 ? value / divisor : 0.0;
}

// Quotient s / t_q of [Portsmouth2025], Eq. (4), or 0 if both cosines are 0 and s / t_q has no
// limit.
float qon_quotient(float mu_o, float mu_i, float s)
{
    return oren_nayar_quotient(max(s, 0.0), max(mu_o, mu_i));
}

// Quotient s / t_F of [Portsmouth2025], Eq. (11).
float fon_quotient(float mu_o, float mu_i, float s)
{
    return s > 0.0 ? oren_nayar_quotient(s, max(mu_o, mu_i)) : s;
}

// Multiple scattering, [Portsmouth2025], Eq. (19), divided by fon_lambert and H(mu_o) H(mu_i).
// Since 1 - E = r H / (1 + c1 r), powers of r cancel, and no divisor is 0.
vec3 eon_multiple_ratio(vec3 rho, float roughness)
{
    float weight = roughness * (1.0 + EON_C2 * roughness) * (1.0 / EON_LOSS_AVG);
    return weight * rho / eon_denominator(rho, roughness);
}

// BRDF of QON: [Portsmouth2025], Eqs. (1), (3).
vec3 qon_brdf_mu(float mu_o, float mu_i, float s, vec3 rho, float sigma)
{
    float quotient = qon_quotient(mu_o, mu_i, s);
    return 1.0 / EON_PI * (qon_aq(sigma) + qon_bq(sigma) * quotient) * rho;
}

// BRDF of EON: [Portsmouth2025], Eq. (16).
vec3 eon_brdf_mu(float mu_o, float mu_i, float s, vec3 rho, float roughness)
{
    vec3 weight = eon_multiple_ratio(rho, roughness);
    vec3 scale = fon_lambert(rho, roughness);
    float single_scatter = 1.0 + roughness * fon_quotient(mu_o, mu_i, s);
    return scale * (vec3(single_scatter) + fon_loss(mu_o) * fon_loss(mu_i) * weight);
}
