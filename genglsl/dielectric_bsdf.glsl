// SPDX-License-Identifier: Apache-2.0

#include "lib/microfacet_transmission.glsl"
#include "lib/fresnel_dielectric.glsl"

// Node dielectric_bsdf. If ior is 0, the lobe reflects all light.

void dielectric_bsdf(ClosureData closureData, float weight, vec3 tint, float ior, vec2 roughness,
                     bool retroreflective, float thinfilm_thickness, float thinfilm_ior, vec3 N,
                     vec3 X, int distribution, int scatter_mode, inout BSDF bsdf)
{
    if (microfacet_is_off(closureData, weight, scatter_mode))
    {
        return;
    }
    MicrofacetLobe lobe = microfacet_lobe(closureData, N, X, roughness, retroreflective);
    FresnelData fd = mx_init_fresnel_dielectric(ior, thinfilm_thickness, thinfilm_ior);
    MicrofacetFresnel F;
    F.value = vec3(eonlib_fresnel_dielectric(lobe.mu_h, ior));
    F.average = vec3(eonlib_fresnel_dielectric_avg(ior));
    F.visible = vec3(eonlib_fresnel_dielectric_visible(lobe.visible.x, lobe.visible.y, ior));
    vec2 passing = vec2(0.0);
    if (ior < 1.0)
    {
        passing = eonlib_dielectric_passing(lobe.visible.x, lobe.visible.y, ior);
        F.visible = vec3(1.0 - passing.x);
    }
    microfacet_film(lobe, fd, F);
    if (ior < 1.0 && scatter_mode != 0 && !fd.airy)
    {
        // Add a lobe of perfect mirrors, so that no light is lost.
        float rest = max((1.0 - passing.y) / lobe.albedo - F.visible.x, 0.0);
        F.value += rest;
        F.visible += rest;
        F.average = vec3(0.0);
        F.outside = F.visible;
        fd.airy = true;  // sums an environment over perfect mirrors, as under a film
    }
    microfacet_bsdf(closureData, lobe, fd, F, max(tint, 0.0), weight, distribution, scatter_mode,
                    bsdf);
}

// Overload without retroreflection, for MaterialX before 1.39.5.
void dielectric_bsdf(ClosureData closureData, float weight, vec3 tint, float ior, vec2 roughness,
                     float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X, int distribution,
                     int scatter_mode, inout BSDF bsdf)
{
    dielectric_bsdf(closureData, weight, tint, ior, roughness, false, thinfilm_thickness,
                    thinfilm_ior, N, X, distribution, scatter_mode, bsdf);
}
