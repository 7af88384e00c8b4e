// SPDX-License-Identifier: Apache-2.0
// Entry point of the node dielectric_bsdf. With ior 0 it reflects everything.

#include "microfacet_lobe.glsl"
#include "ggx_cosine.glsl"

// Fresnel reflectance, of the film where there is one.
vec3 dielectric_fresnel(float mu, FresnelData fd)
{
    return fd.airy ? mx_fresnel_airy(mu, fd) : vec3(fresnel_dielectric(mu, fd.ior.x));
}

void dielectric_bsdf(ClosureData closureData, float weight, vec3 tint, float ior, vec2 roughness,
                     bool retroreflective, float thinfilm_thickness, float thinfilm_ior, vec3 N,
                     vec3 X, int distribution, int scatter_mode, inout BSDF bsdf)
{
    // A lobe that is switched off costs nothing; a negative weight, never valid, counts as 0.
    bool transmission = closureData.closureType == CLOSURE_TYPE_TRANSMISSION;
    if (weight <= 0.0 || (scatter_mode == 1 && !transmission))
    {
        return;
    }

    MicrofacetLobe lobe = microfacet_lobe(closureData.V, N, roughness, retroreflective && !transmission);

    // MaterialX's curve divides 0 by 0 along the normal where float32 adds nothing to 1.
    FresnelData fd = mx_init_fresnel_dielectric(max(ior, 1e-3), thinfilm_thickness, thinfilm_ior);

    // Averages are those without a film: a film's curve costs as much as all the rest, at each cosine.
    vec3 F_ss = vec3(fresnel_dielectric_avg(ior));
    float F_o = fresnel_dielectric(ggx_cosine_dielectric(lobe.mu_o, lobe.alpha, ior), ior);
    vec3 compensation = microfacet_compensation(lobe, F_ss);
    vec3 scale = max(tint, 0.0) * compensation * weight;

    bsdf.throughput = max(1.0 - lobe.albedo * F_o * scale, 0.0);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        vec3 F = dielectric_fresnel(microfacet_cosine(lobe, closureData.L), fd);
        bsdf.response = microfacet_value(lobe, closureData.L, X) * F * scale * closureData.occlusion;
    }
    else if (transmission && scatter_mode != 0)
    {
        vec3 passed = max(1.0 - lobe.albedo * F_o * compensation, 0.0);
        bsdf.response = microfacet_transmission(lobe, X, distribution, fd, max(tint, 0.0), passed) * weight;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = microfacet_environment(lobe, X, distribution, fd)
                        * scale;
    }
}
