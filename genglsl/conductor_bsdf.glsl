// SPDX-License-Identifier: Apache-2.0
// Entry point of the node conductor_bsdf, which lets nothing through.

#include "microfacet_lobe.glsl"

void conductor_bsdf(ClosureData closureData, float weight, vec3 ior_n, vec3 ior_k, vec2 roughness,
                    bool retroreflective, float thinfilm_thickness, float thinfilm_ior, vec3 N,
                    vec3 X, int distribution, inout BSDF bsdf)
{
    bsdf.throughput = vec3(0.0);

    // A lobe that is switched off costs nothing; a negative weight, never valid, counts as 0.
    if (weight <= 0.0)
    {
        return;
    }

    MicrofacetLobe lobe = microfacet_lobe(closureData.V, N, roughness, retroreflective);
    FresnelData fd = mx_init_fresnel_conductor(ior_n, ior_k, thinfilm_thickness, thinfilm_ior);

    // The average is that without a film, whose curve costs as much as all the rest at each cosine.
    vec3 scale = microfacet_compensation(lobe, fresnel_conductor_avg(ior_n, ior_k)) * weight;

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        vec3 F = mx_compute_fresnel(microfacet_cosine(lobe, closureData.L), fd);
        bsdf.response = microfacet_value(lobe, closureData.L, X) * F * scale * closureData.occlusion;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = microfacet_environment(lobe, X, distribution, fd)
                        * scale;
    }
}
