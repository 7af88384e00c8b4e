// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl"
#include "eon.glsl"

// Response of a rough diffuse lobe for two nodes. With energy_compensation, the model is EON,
// otherwise qualitative Oren-Nayar.
//
// Inputs are not clamped. Results are finite for roughness in [-1, 10] and colors up to 1.

void oren_nayar_lobe(ClosureData closureData, float weight, vec3 color, float roughness,
                     vec3 N, bool energy_compensation, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));  // share that reaches the layer below

    if (weight <= 0.0)
    {
        return;
    }

    vec3 wo = closureData.V;
    vec3 wi = closureData.L;
    N = mx_forward_facing_normal(N, wo);

    // Rounding may make a cosine exceed 1, and the albedo takes a square root of 1 - mu^2.
    float mu_o = min(dot(N, wo), 1.0);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, wi), 0.0, 1.0);
        float s = dot(wo, wi) - mu_o * mu_i;
        vec3 brdf = energy_compensation ? eon_brdf_mu(mu_o, mu_i, s, color, roughness)
                                        : qon_brdf_mu(mu_o, mu_i, s, color, roughness);
        bsdf.response = brdf * mu_i * weight * closureData.occlusion;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        vec3 albedo = energy_compensation ? eon_albedo_dir(mu_o, color, roughness)
                                          : color * qon_albedo_dir(mu_o, roughness);
        bsdf.response = albedo * mx_environment_irradiance(N) * weight;
    }
}
