// SPDX-License-Identifier: Apache-2.0
// Entry point of the node conductor_bsdf, which lets nothing through.

#include "microfacet_lobe.glsl"
#include "thin_film.glsl"

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

    vec3 F_ss = fd.airy ? thin_film_avg(fd) : fresnel_conductor_avg(ior_n, ior_k);
    vec3 scale = microfacet_compensation(lobe, F_ss) * weight;

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float cosine = microfacet_cosine(lobe, closureData.L);
        vec3 F = fd.airy ? thin_film_fresnel(cosine, fd) : mx_compute_fresnel(cosine, fd);
        bsdf.response = microfacet_value(lobe, closureData.L, X) * F * scale * closureData.occlusion;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = fd.airy ? microfacet_white_environment(lobe, X, distribution)
                                  * thin_film_visible(lobe.mu_o, lobe.alpha, fd) * scale
                                : microfacet_environment(lobe, X, distribution, fd) * scale;
    }
}
