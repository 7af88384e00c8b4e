// SPDX-License-Identifier: Apache-2.0

#include "lib/microfacet_film.glsl"
#include "lib/fresnel_conductor.glsl"

// Node conductor_bsdf, a lobe that only reflects.

// Least ior. If ior and extinction were 0, MaterialX's Fresnel curve would be 0 /
// 0 along the normal.
#define CONDUCTOR_LEAST_INDEX 1e-8

void conductor_bsdf(ClosureData closureData, float weight, vec3 ior, vec3 extinction,
                    vec2 roughness, bool retroreflective, float thinfilm_thickness,
                    float thinfilm_ior, vec3 N, vec3 X, int distribution, inout BSDF bsdf)
{
    if (weight > 0.0 && closureData.closureType != CLOSURE_TYPE_TRANSMISSION)
    {
        ior = max(ior, CONDUCTOR_LEAST_INDEX);
        MicrofacetLobe lobe = microfacet_lobe(closureData, N, X, roughness, retroreflective);
        FresnelData fd = mx_init_fresnel_conductor(ior, extinction, thinfilm_thickness,
                                                   thinfilm_ior);
        MicrofacetFresnel F;
        F.value = mx_fresnel_conductor(lobe.mu_h, ior, extinction);
        F.average = eonlib_fresnel_conductor_avg(ior, extinction);
        F.visible = vec3(1.0);  // unused: metal is opaque
#ifdef EONLIB_PREFILTERED
        vec3 F0 = mx_fresnel_conductor(1.0, ior, extinction);
        F.visible = mx_ggx_dir_albedo(lobe.mu_o, lobe.alpha, F0, vec3(1.0))
                    / mx_ggx_dir_albedo(lobe.mu_o, lobe.alpha, vec3(1.0), vec3(1.0));
#endif
        microfacet_film(lobe, fd, F);
        microfacet_bsdf(closureData, lobe, fd, F, vec3(1.0), weight, distribution, bsdf);
    }
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));
}

// Overload without retroreflection, for MaterialX before 1.39.5.
void conductor_bsdf(ClosureData closureData, float weight, vec3 ior, vec3 extinction,
                    vec2 roughness, float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X,
                    int distribution, inout BSDF bsdf)
{
    conductor_bsdf(closureData, weight, ior, extinction, roughness, false, thinfilm_thickness,
                   thinfilm_ior, N, X, distribution, bsdf);
}
