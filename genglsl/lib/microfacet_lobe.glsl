// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"
#include "ggx_anisotropic.glsl"
#include "half_vector.glsl"

// Geometry, reflectances and reflection of a GGX lobe.

// Least ior. In float32, 1 + ior^2 is 1 below 2.4e-4, and MaterialX's curve is 0 / 0 along the
// normal.
#define MICROFACET_LEAST_INDEX 1e-3

#define MICROFACET_MIRROR_INDEX 1e8

// A GGX lobe for one view direction wo: [MaterialX2026], Microfacet Model.
struct MicrofacetLobe
{
    vec3 wo;
    vec3 wi;
    vec3 wh;
    vec3 N;
    vec3 X;
    float mu_o;
    float mu_h; // cosine of wo and wi with the half vector
    vec2 roughness;
    float alpha;    // geometric mean
    vec2 visible;   // cosine and alpha for averages over the visible facets
    float albedo; // E_ss
    int closure;
};

// Fresnel reflectances. `value` is at the half vector. `average` is F_ss, the cosine-weighted
// average over the hemisphere. `visible` is the average over visible facets with the weight D G_2 /
// (4 mu_o). `outside` scales MaterialX's environment.
struct MicrofacetFresnel
{
    vec3 value;
    vec3 average;
    vec3 visible;
    vec3 outside;
};

// A lobe is off if its weight is at most 0, or if scatter_mode is 1 (only transmit) and light is
// reflected.
bool microfacet_is_off(ClosureData closureData, float weight, int scatter_mode)
{
    bool transmission = closureData.closureType == CLOSURE_TYPE_TRANSMISSION;
    return weight <= 0.0 || (scatter_mode == 1 && !transmission);
}

// Direction w in the frame of X, cross(N, X) and N.
vec3 microfacet_local(MicrofacetLobe lobe, vec3 w)
{
    return vec3(dot(w, lobe.X), dot(w, cross(lobe.N, lobe.X)), dot(w, lobe.N));
}

// Length |(alpha_x x, alpha_y y, z)| of the stretched direction w: [Heitz2014], Eq. (86).
float microfacet_stretched(MicrofacetLobe lobe, vec3 w)
{
    return length(microfacet_local(lobe, w) * vec3(lobe.roughness, 1.0));
}

// Clamps avoid divisions by 0. Retroreflection mirrors wo about N.
MicrofacetLobe microfacet_lobe(ClosureData closureData, vec3 N, vec3 X, vec2 roughness,
                               bool retroreflective)
{
    MicrofacetLobe lobe;
    lobe.closure = closureData.closureType;
    bool mirrored = retroreflective && lobe.closure != CLOSURE_TYPE_TRANSMISSION;
    lobe.wo = mirrored ? reflect(-closureData.V, N) : closureData.V;
    lobe.wi = closureData.L;
    lobe.N = mx_forward_facing_normal(N, lobe.wo);
    lobe.X = normalize(X - dot(X, lobe.N) * lobe.N);
    lobe.mu_o = clamp(dot(lobe.N, lobe.wo), M_FLOAT_EPS, 1.0);
    lobe.wh = eonlib_half_vector(lobe.wo, lobe.wi, lobe.N);
    lobe.mu_h = clamp(dot(lobe.wo, lobe.wh), M_FLOAT_EPS, 1.0);
    lobe.roughness = clamp(roughness, M_FLOAT_EPS, 1.0);
    lobe.alpha = mx_average_alpha(lobe.roughness);
    vec2 visible = vec2(lobe.mu_o, lobe.alpha);  // naga rejects struct members as outputs
    vec3 lossless = vec3(visible, 1.0);
    if (lobe.roughness.x != lobe.roughness.y)
    {
        lossless = ggx_facets(microfacet_local(lobe, lobe.wo), lobe.roughness, visible);
    }
    lobe.visible = visible;
    lobe.albedo = 1.0 - ggx_missing(lossless.x, lossless.y) * lossless.z;
    return lobe;
}

// BRDF of perfect mirrors times mu_i: D G_2 / (4 mu_o), or 0 below the horizon. [MaterialX2026],
// Height-Correlated Smith Masking-Shadowing, July 2026, defines G_2.
float microfacet_lossless(MicrofacetLobe lobe)
{
    float mu_i = clamp(dot(lobe.N, lobe.wi), 0.0, 1.0);
    float smith = microfacet_stretched(lobe, lobe.wo) * mu_i + microfacet_stretched(lobe, lobe.wi) * lobe.mu_o;
    return mx_ggx_NDF(microfacet_local(lobe, lobe.wh), lobe.roughness) * mu_i / (2.0 * smith);
}

// Environment light. MaterialX masks facets with the mean alpha. Under a film, facets reflect as
// mirrors, and the caller multiplies by F.outside.
vec3 microfacet_environment(MicrofacetLobe lobe, int distribution, FresnelData fd)
{
    fd.ior = fd.model == FRESNEL_MODEL_DIELECTRIC ? max(fd.ior, MICROFACET_LEAST_INDEX) : fd.ior;
    if (fd.airy)
    {
        fd.airy = false;
        fd.ior = vec3(MICROFACET_MIRROR_INDEX);
        fd.F0 = vec3(1.0);
        fd.F82 = fd.F0;
        fd.F90 = fd.F0;
    }
    return max(mx_environment_radiance(lobe.N, lobe.wo, lobe.X, lobe.roughness, distribution, fd), 0.0);
}

// Response and throughput of a lobe, with the factor 1 + F_ss (1 - E_ss) / E_ss: [MaterialX2026],
// Energy Compensation. Light that a tint removes is absorbed: [MaterialX2026a], Vertical-Layering
// Transmittance.
void microfacet_bsdf(ClosureData closureData, MicrofacetLobe lobe, FresnelData fd, MicrofacetFresnel F, vec3 tint,
                     float weight, int distribution, inout BSDF bsdf)
{
    vec3 scale = (1.0 + F.average * ((1.0 - lobe.albedo) / lobe.albedo)) * weight;
    bsdf.throughput = max(1.0 - lobe.albedo * F.visible * scale, 0.0);
    scale *= tint;

    if (lobe.closure == CLOSURE_TYPE_REFLECTION)
    {
        bsdf.response = microfacet_lossless(lobe) * F.value * scale * closureData.occlusion;
    }
    else if (lobe.closure == CLOSURE_TYPE_INDIRECT)
    {
#ifdef EONLIB_PREFILTERED  // set in genglsl/environment
        vec3 mean = eonlib_prefiltered_light(lobe.N, lobe.wo, lobe.roughness, fd);
        bsdf.response = mean * lobe.albedo * F.visible * scale;
#else
        bsdf.response = microfacet_environment(lobe, distribution, fd) * F.outside * scale;
#endif
    }
}
