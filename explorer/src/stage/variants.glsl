// SPDX-License-Identifier: Apache-2.0
// The wrong variants of models in python/mxeon/models/diffuse.py.
//
// Arguments are wo and wi in the local frame, rho per channel, and the model's roughness or sigma.

// EON with dot(wo, wi) = s + mu_o mu_i clamped to at least 1e-8.
vec3 eon_clamped_brdf(vec3 wo, vec3 wi, vec3 rho, float roughness)
{
    float mu_o = min(wo.z, 1.0);
    float mu_i = min(wi.z, 1.0);
    float s = oren_nayar_s(wo, wi);
    s = s + mu_o * mu_i > 1.0e-8 ? s : 1.0e-8 - mu_o * mu_i;
    return eon_brdf_mu(mu_o, mu_i, s, rho, roughness);
}

// EON whose multiple-scattering lobe has rho^3 instead of rho^2.
vec3 eon_rho_cubed_brdf(vec3 wo, vec3 wi, vec3 rho, float roughness)
{
    float single_scatter = 1.0 + roughness * fon_quotient(wo.z, wi.z, oren_nayar_s(wo, wi));
    vec3 weight = rho * eon_multiple_ratio(rho, roughness);
    float losses = fon_loss(min(wo.z, 1.0)) * fon_loss(min(wi.z, 1.0));
    return fon_lambert(rho, roughness) * (vec3(single_scatter) + losses * weight);
}

// FON plus the multiple-scattering lobe of a white surface.
vec3 fon_white_lobe_brdf(vec3 wo, vec3 wi, vec3 rho, float roughness)
{
    float losses = fon_loss(min(wo.z, 1.0)) * fon_loss(min(wi.z, 1.0));
    float white = roughness * fon_af(roughness) / (EON_PI * EON_LOSS_AVG) * losses;
    return fon_brdf(wo, wi, rho, roughness) + vec3(white);
}

// QON multiplied by its own color a second time.
vec3 qon_tinted_twice_brdf(vec3 wo, vec3 wi, vec3 rho, float sigma)
{
    return rho * qon_brdf(wo, wi, rho, sigma);
}

// Albedo of eon_rho_cubed_brdf: rho (E_EON + (1 - rho) E_FON).
vec3 eon_rho_cubed_albedo_dir(float mu, vec3 rho, float roughness)
{
    vec3 fon = (vec3(1.0) - rho) * fon_albedo_dir(mu, roughness);
    return rho * (eon_albedo_dir(mu, rho, roughness) + fon);
}

// Albedo of fon_white_lobe_brdf: 1 - (1 - rho) E_FON.
vec3 fon_white_lobe_albedo_dir(float mu, vec3 rho, float roughness)
{
    return vec3(1.0) - (vec3(1.0) - rho) * fon_albedo_dir(mu, roughness);
}

vec3 qon_tinted_twice_albedo_dir(float mu, vec3 rho, float sigma)
{
    return rho * rho * qon_albedo_dir(mu, sigma);
}

// MaterialX's fit of the albedo of QON: mx_microfacet_diffuse.glsl of MaterialX 1.39.5.
vec3 qon_fitted_albedo_dir(float mu, vec3 rho, float sigma)
{
    float over = 1.0 - 0.4297 * sigma - 0.7632 * mu * sigma + 1.4385 * sigma * sigma;
    float under = 1.0 - 0.6076 * sigma - 0.4993 * mu * sigma + 2.0315 * sigma * sigma;
    return min(over / under, 1.0) * rho;
}
