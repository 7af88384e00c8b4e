// SPDX-License-Identifier: Apache-2.0

#include "lib/microfacet_transmission.glsl"
#include "lib/fresnel_schlick.glsl"

// Average of the Fresnel curve over visible facets. `dip` is Hoffman's term, 0 if color82 is 1.
vec3 generalized_schlick_visible(MicrofacetLobe lobe, FresnelData fd, vec3 dip)
{
    float m = 1.0 - ggx_cosine_schlick(lobe.visible.x, lobe.visible.y, fd.exponent);
    vec3 average = mix(fd.F0, fd.F90, pow(m, fd.exponent));
    bool dips = dot(abs(dip), vec3(1.0)) > 0.0;
    return dips ? max(average - dip * ggx_dip(lobe.visible.x, lobe.visible.y), 0.0) : average;
}

void generalized_schlick_bsdf(ClosureData closureData, float weight, vec3 color0, vec3 color82,
                              vec3 color90, float exponent, vec2 roughness, bool retroreflective,
                              float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X,
                              int distribution, int scatter_mode, inout BSDF bsdf)
{
    if (microfacet_is_off(closureData, weight, scatter_mode))
    {
        return;
    }
    MicrofacetLobe lobe = microfacet_lobe(closureData, N, X, roughness, retroreflective);
    FresnelData fd = mx_init_fresnel_schlick(max(color0, 0.0), max(color82, 0.0), max(color90, 0.0),
                                             exponent, thinfilm_thickness, thinfilm_ior);
    fd.ior = vec3(mx_f0_to_ior(dot(fd.F0, vec3(1.0 / 3.0))));  // for transmission
    vec3 dip = eonlib_fresnel_schlick_dip(fd.F0, fd.F82, fd.F90, exponent);
    MicrofacetFresnel F;
    // MaterialX's curve may be negative if the colors are dark and color82 is small.
    F.value = max(mx_fresnel_hoffman_schlick(lobe.mu_h, fd), 0.0);
    F.average = max(eonlib_fresnel_schlick_avg(fd.F0, fd.F90, exponent, dip), 0.0);
    F.visible = generalized_schlick_visible(lobe, fd, dip);
    microfacet_film(lobe, fd, F);
    microfacet_bsdf(closureData, lobe, fd, F, vec3(1.0), weight, distribution, scatter_mode, bsdf);
}

// Overload without retroreflection, for MaterialX before 1.39.5.
void generalized_schlick_bsdf(ClosureData closureData, float weight, vec3 color0, vec3 color82,
                              vec3 color90, float exponent, vec2 roughness,
                              float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X,
                              int distribution, int scatter_mode, inout BSDF bsdf)
{
    generalized_schlick_bsdf(closureData, weight, color0, color82, color90, exponent, roughness,
                             false, thinfilm_thickness, thinfilm_ior, N, X, distribution,
                             scatter_mode, bsdf);
}
