// SPDX-License-Identifier: Apache-2.0
// Entry point of the node dielectric_bsdf. With ior 0 it reflects everything.

#include "microfacet_lobe.glsl"
#include "ggx_cosine.glsl"
#include "thin_film.glsl"

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

    FresnelData film = mx_init_fresnel_dielectric(ior, thinfilm_thickness, thinfilm_ior);

    // MaterialX's curve divides 0 by 0 along the normal where float32 adds nothing to 1.
    FresnelData fd = mx_init_fresnel_dielectric(max(ior, 1e-3), thinfilm_thickness, thinfilm_ior);

    // Averages of the Fresnel curve over the hemisphere, and over the visible facets.
    vec3 F_ss, F_o;
    if (film.airy)
    {
        F_ss = thin_film_avg(film);
        F_o = thin_film_visible(lobe.mu_o, lobe.alpha, film);
    }
    else
    {
        F_ss = vec3(fresnel_dielectric_avg(ior));
        F_o = vec3(fresnel_dielectric(ggx_cosine_dielectric(lobe.mu_o, lobe.alpha, ior), ior));
    }
    vec3 compensation = microfacet_compensation(lobe, F_ss);
    vec3 scale = max(tint, 0.0) * compensation * weight;

    bsdf.throughput = max(1.0 - lobe.albedo * F_o * scale, 0.0);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float cosine = microfacet_cosine(lobe, closureData.L);
        vec3 F = film.airy ? thin_film_fresnel(cosine, film) : vec3(fresnel_dielectric(cosine, ior));
        bsdf.response = microfacet_value(lobe, closureData.L, X) * F * scale * closureData.occlusion;
    }
    else if (transmission && scatter_mode != 0)
    {
        vec3 passed = max(1.0 - lobe.albedo * F_o * compensation, 0.0);
        bsdf.response = microfacet_transmission(lobe, X, distribution, fd.ior, max(tint, 0.0), passed) * weight;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = film.airy ? microfacet_white_environment(lobe, X, distribution) * F_o * scale
                                  : microfacet_environment(lobe, X, distribution, fd) * scale;
    }
}
