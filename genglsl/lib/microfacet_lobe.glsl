// SPDX-License-Identifier: Apache-2.0
// What the microfacet nodes share: geometry, reflectances and response of a GGX lobe.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"
#include "ggx_anisotropic.glsl"
#include "half_vector.glsl"

// Least index of refraction for MaterialX's own curve: along the normal it divides 0 by 0 where
// float32 adds nothing to 1. With ior 0 the curve of eonlib reflects everything.
#define MICROFACET_LEAST_INDEX 1e-3

// Index of a mirror by MaterialX's curves of dielectrics and conductors.
#define MICROFACET_MIRROR_INDEX 1e8

// The lobe at one direction wo: [MaterialX2026], Microfacet Model.
struct MicrofacetLobe
{
    vec3 wo;
    vec3 wi;
    vec3 N;
    vec3 X;
    float mu_o;
    float mu_h; // cosine of wo and wi with the half vector
    vec2 roughness;
    float alpha;    // geometric mean, by which MaterialX masks facets
    vec2 visible;   // cosine and alpha for averages over the visible facets
    float albedo; // E_ss
    int closure;
};

// A Fresnel curve's value at the half vector, its cosine-weighted average over the hemisphere,
// F_ss, and its average over the visible facets: over wi, weighted by D G_2 / (4 mu_o). Stock's sum
// over an environment has the curve but no film, whose average is a factor outside it.
struct MicrofacetFresnel
{
    vec3 value;
    vec3 average;
    vec3 visible;
    vec3 outside;
};

// Whether a lobe does nothing: it is switched off, or transmits alone (scatter_mode 1, T; 0 is R, 2
// is RT) and is asked for reflection. A negative weight, never valid, counts as 0.
bool microfacet_is_off(ClosureData closureData, float weight, int scatter_mode)
{
    bool transmission = closureData.closureType == CLOSURE_TYPE_TRANSMISSION;
    return weight <= 0.0 || (scatter_mode == 1 && !transmission);
}

// A direction in the frame of tangent, bitangent and normal.
vec3 microfacet_local(MicrofacetLobe lobe, vec3 w)
{
    vec3 X = normalize(lobe.X - dot(lobe.X, lobe.N) * lobe.N);
    return vec3(dot(w, X), dot(w, cross(lobe.N, X)), dot(w, lobe.N));
}

// |(alpha_x x, alpha_y y, z)|: [Heitz2014], Eq. (86).
float microfacet_stretched(MicrofacetLobe lobe, vec3 w)
{
    return length(microfacet_local(lobe, w) * vec3(lobe.roughness, 1.0));
}

// Cosines and roughness of 0 would divide by 0. Retroreflection mirrors wo at the normal.
MicrofacetLobe microfacet_lobe(ClosureData closureData, vec3 N, vec3 X, vec2 roughness,
                               bool retroreflective)
{
    MicrofacetLobe lobe;
    lobe.closure = closureData.closureType;
    bool mirrored = retroreflective && lobe.closure != CLOSURE_TYPE_TRANSMISSION;
    lobe.wo = mirrored ? reflect(-closureData.V, N) : closureData.V;
    lobe.wi = closureData.L;
    lobe.N = mx_forward_facing_normal(N, lobe.wo);
    lobe.X = X;
    lobe.mu_o = clamp(dot(lobe.N, lobe.wo), M_FLOAT_EPS, 1.0);
    lobe.mu_h = clamp(dot(lobe.wo, eonlib_half_vector(lobe.wo, lobe.wi, lobe.N)), M_FLOAT_EPS, 1.0);
    lobe.roughness = clamp(roughness, M_FLOAT_EPS, 1.0);
    lobe.alpha = mx_average_alpha(lobe.roughness);
    vec2 visible = vec2(lobe.mu_o, lobe.alpha);  // naga takes no member of a structure as an output
    vec3 lossless = vec3(visible, 1.0);
    if (lobe.roughness.x != lobe.roughness.y)
    {
        lossless = ggx_facets(microfacet_local(lobe, lobe.wo), lobe.roughness, visible);
    }
    lobe.visible = visible;
    lobe.albedo = 1.0 - ggx_missing(lossless.x, lossless.y) * lossless.z;
    return lobe;
}

// D G_2 / (4 mu_o), the value of facets that reflect everything, times mu_i: 0 below the horizon. [MaterialX2026],
// Height-Correlated Smith Masking-Shadowing, as corrected in July 2026: G_2 = 2 mu_o mu_i / (l_o mu_i + l_i mu_o).
float microfacet_lossless(MicrofacetLobe lobe)
{
    float mu_i = clamp(dot(lobe.N, lobe.wi), 0.0, 1.0);
    float G2 = mx_ggx_smith_G2(mu_i, lobe.mu_o, lobe.alpha);
    if (lobe.roughness.x != lobe.roughness.y)
    {
        G2 = 2.0 * mu_i * lobe.mu_o
             / (microfacet_stretched(lobe, lobe.wi) * lobe.mu_o + microfacet_stretched(lobe, lobe.wo) * mu_i);
    }
    vec3 H = microfacet_local(lobe, eonlib_half_vector(lobe.wo, lobe.wi, lobe.N));
    return mx_ggx_NDF(H, lobe.roughness) * G2 / (4.0 * lobe.mu_o);
}

// The curve that MaterialX sums over the facets of an environment. Under a film they reflect everything.
FresnelData microfacet_environment_curve(FresnelData fd)
{
    if (fd.model == FRESNEL_MODEL_DIELECTRIC)
    {
        fd.ior = max(fd.ior, MICROFACET_LEAST_INDEX);
    }
    if (fd.airy)
    {
        fd.ior = vec3(MICROFACET_MIRROR_INDEX);
        fd.F0 = vec3(1.0);
        fd.F82 = vec3(1.0);
        fd.F90 = vec3(1.0);
    }
    fd.airy = false;
    return fd;
}

// Light of an environment, whose sum MaterialX weights by the masking of the mean alpha.
vec3 microfacet_environment(MicrofacetLobe lobe, int distribution, FresnelData fd)
{
    fd = microfacet_environment_curve(fd);
    return max(mx_environment_radiance(lobe.N, lobe.wo, lobe.X, lobe.roughness, distribution, fd), 0.0);
}

// A Fresnel curve by which each of MaterialX's sums over a refracted environment, whose cosine with the
// view is mu, transmits the same share. It is F0 at all facets but those along the view's horizon.
//   sampled: (1 - F0) / G_1(mu)           prefiltered: 1 - (A F0 + B F90), with MaterialX's fits A and B
// The least B keeps F90 finite where there is no table of fits.
FresnelData microfacet_share_curve(float mu, float alpha, vec3 share)
{
#ifdef MX_REFRACTION_UNMASKED // the sampled sum has no division: patch 0009
    vec3 F0 = 1.0 - share;
#else
    vec3 F0 = 1.0 - mx_ggx_smith_G1(mu, alpha) * share;
#endif
    vec3 AB = mx_ggx_dir_albedo(mu, alpha, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0));
    return mx_init_fresnel_schlick(F0, vec3(1.0), (1.0 - share - AB.x * F0) / max(AB.y, 1e-6), 1e9, 0.0, 1.0);
}

// Light through a surface that transmits a share of it, along the view refracted twice, as by a solid sphere;
// or, where MaterialX renders transmission as opacity, the tint.
//
// The ray leaves the sphere at the cosine c at which it met the facet. MaterialX computes c^2 anew, as
// 1 - n^2 (1 - q^2) from the cosine q inside, and where its rounding exceeds c^2, nothing leaves: 0 / 0. A view
// longer by d adds 8 d q^2 / n^2 to it, here 8e-6 n^2, three times the roundings of seven operations, and
// otherwise changes nothing above d. Near n = 1 and above 4, d is too large: rough surfaces refract as with 1.001
// and with 4. A smooth one, whose facets are one, keeps its n above 4, and refracts as with a larger c.
vec3 microfacet_transmitted(MicrofacetLobe lobe, int distribution, vec3 ior, vec3 share, vec3 tint)
{
    float n = max(ior.x, MICROFACET_LEAST_INDEX);
    vec3 wo = lobe.wo;
    if (n > 4.0 && lobe.alpha <= M_FLOAT_EPS)
    {
        float mu = min(0.005 + 2e-3 * n, 0.9);
        vec3 side = normalize(wo - lobe.mu_o * lobe.N);
        wo = mu > lobe.mu_o ? mu * lobe.N + sqrt(1.0 - mu * mu) * side : wo;
    }
    else if (n >= 1.0)
    {
        n = clamp(n, 1.001, 4.0);
        float n2 = n * n;
        wo *= 1.0 + 1e-6 * n2 * n2 * n2 / (n2 - 1.0);
    }
    float mu = clamp(dot(lobe.N, wo), M_FLOAT_EPS, 1.0);
    FresnelData curve = microfacet_share_curve(mu, lobe.alpha, share);
    curve.ior = vec3(n);
    return mx_surface_transmission(lobe.N, wo, lobe.X, lobe.roughness, distribution, curve, tint);
}

// Response and throughput of a lobe with its reflectances F: [MaterialX2026], Energy Compensation,
// 1 + F_ss (1 - E_ss) / E_ss.
void microfacet_bsdf(ClosureData closureData, MicrofacetLobe lobe, FresnelData fd,
                     MicrofacetFresnel F, vec3 tint, float weight, int distribution,
                     int scatter_mode, inout BSDF bsdf)
{
    vec3 compensation = 1.0 + F.average * ((1.0 - lobe.albedo) / lobe.albedo);
    vec3 scale = tint * compensation * weight;
    bsdf.throughput = max(1.0 - lobe.albedo * F.visible * scale, 0.0);

    if (lobe.closure == CLOSURE_TYPE_REFLECTION)
    {
        bsdf.response = microfacet_lossless(lobe) * F.value * scale * closureData.occlusion;
    }
    else if (lobe.closure == CLOSURE_TYPE_TRANSMISSION && scatter_mode != 0)
    {
        // As opacity, a lobe that only transmits passes all light: what lies over it takes away what it reflects.
        vec3 passed = max(1.0 - lobe.albedo * F.visible * compensation, 0.0);
        bool below = scatter_mode == 1;
        bsdf.response = microfacet_transmitted(lobe, distribution, fd.ior, below ? passed : vec3(1.0), tint)
                        * (below ? vec3(1.0) : passed) * weight;
    }
    else if (lobe.closure == CLOSURE_TYPE_INDIRECT)
    {
#ifdef EONLIB_PREFILTERED  // the file in genglsl/environment
        vec3 mean = eonlib_prefiltered_light(lobe.N, lobe.wo, lobe.roughness, fd);
        bsdf.response = mean * lobe.albedo * F.visible * scale;
#else
        bsdf.response = microfacet_environment(lobe, distribution, fd) * F.outside * scale;
#endif
    }
}
