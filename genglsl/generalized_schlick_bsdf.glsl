// SPDX-License-Identifier: Apache-2.0
// Entry point of the node generalized_schlick_bsdf.

#include "microfacet_lobe.glsl"
#include "ggx_cosine.glsl"
#include "thin_film.glsl"

// Average of the Fresnel curve over the visible facets; a color82 of 1 has no dip.
vec3 generalized_schlick_average(MicrofacetLobe lobe, FresnelData fd, vec3 dip)
{
    float m = 1.0 - ggx_cosine_schlick(lobe.mu_o, lobe.alpha, fd.exponent);
    vec3 average = mix(fd.F0, fd.F90, pow(m, fd.exponent));
    bool dips = dot(abs(dip), vec3(1.0)) > 0.0;
    return dips ? average - dip * ggx_dip(lobe.mu_o, lobe.alpha) : average;
}

void generalized_schlick_bsdf(ClosureData closureData, float weight, vec3 color0, vec3 color82,
                              vec3 color90, float exponent, vec2 roughness, bool retroreflective,
                              float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X,
                              int distribution, int scatter_mode, inout BSDF bsdf)
{
    // A lobe that is switched off costs nothing; a negative weight, never valid, counts as 0.
    bool transmission = closureData.closureType == CLOSURE_TYPE_TRANSMISSION;
    if (weight <= 0.0 || (scatter_mode == 1 && !transmission))
    {
        return;
    }

    MicrofacetLobe lobe = microfacet_lobe(closureData.V, N, roughness, retroreflective && !transmission);
    FresnelData fd = mx_init_fresnel_schlick(max(color0, 0.0), max(color82, 0.0), max(color90, 0.0),
                                             exponent, thinfilm_thickness, thinfilm_ior);
    vec3 dip = fresnel_schlick_dip(fd.F0, fd.F82, fd.F90, exponent);

    // Averages of the Fresnel curve over the hemisphere, and over the visible facets.
    vec3 F_ss, F_o;
    if (fd.airy)
    {
        F_ss = thin_film_avg(fd);
        F_o = thin_film_visible(lobe.mu_o, lobe.alpha, fd);
    }
    else
    {
        F_ss = fresnel_schlick_avg(fd.F0, fd.F90, exponent, dip);
        F_o = generalized_schlick_average(lobe, fd, dip);
    }
    vec3 compensation = microfacet_compensation(lobe, F_ss);
    vec3 scale = compensation * weight;

    bsdf.throughput = max(1.0 - lobe.albedo * F_o * scale, 0.0);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float cosine = microfacet_cosine(lobe, closureData.L);
        vec3 F = fd.airy ? thin_film_fresnel(cosine, fd) : mx_compute_fresnel(cosine, fd);
        bsdf.response = microfacet_value(lobe, closureData.L, X) * F * scale * closureData.occlusion;
    }
    else if (transmission && scatter_mode != 0)
    {
        vec3 ior = vec3(mx_f0_to_ior(dot(fd.F0, vec3(1.0 / 3.0))));
        vec3 passed = max(1.0 - lobe.albedo * F_o * compensation, 0.0);
        bsdf.response = microfacet_transmission(lobe, X, distribution, ior, vec3(1.0), passed) * weight;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = fd.airy ? microfacet_white_environment(lobe, X, distribution) * F_o * scale
                                : microfacet_environment(lobe, X, distribution, fd) * scale;
    }
}
