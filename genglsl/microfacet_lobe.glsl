// SPDX-License-Identifier: Apache-2.0
// What the microfacet nodes share: geometry, value and energy compensation of a GGX lobe.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"
#include "fresnel_average.glsl"
#include "ggx_albedo.glsl"

// The lobe at one direction wo: [MaterialX2026], Microfacet Model.
struct MicrofacetLobe
{
    vec3 wo;
    vec3 N;
    float mu_o;
    vec2 roughness;
    float alpha;
    float albedo; // E_ss
};

// Cosines and roughness of 0 would divide by 0. Retroreflection mirrors wo at the normal.
MicrofacetLobe microfacet_lobe(vec3 wo, vec3 N, vec2 roughness, bool retroreflective)
{
    MicrofacetLobe lobe;
    lobe.wo = retroreflective ? reflect(-wo, N) : wo;
    lobe.N = mx_forward_facing_normal(N, lobe.wo);
    lobe.mu_o = clamp(dot(lobe.N, lobe.wo), M_FLOAT_EPS, 1.0);
    lobe.roughness = clamp(roughness, M_FLOAT_EPS, 1.0);
    lobe.alpha = mx_average_alpha(lobe.roughness);
    lobe.albedo = ggx_albedo_dir(lobe.mu_o, lobe.alpha);
    return lobe;
}

// 1 + F_ss (1 - E_ss) / E_ss: [MaterialX2026], Energy Compensation.
vec3 microfacet_compensation(MicrofacetLobe lobe, vec3 F_ss)
{
    return 1.0 + F_ss * ((1.0 - lobe.albedo) / lobe.albedo);
}

// Cosine of wi with the half vector.
float microfacet_cosine(MicrofacetLobe lobe, vec3 wi)
{
    return clamp(dot(lobe.wo, normalize(wi + lobe.wo)), M_FLOAT_EPS, 1.0);
}

// D G_2 / (4 mu_o), the value of facets that reflect everything, times mu_i: 0 below the horizon.
float microfacet_value(MicrofacetLobe lobe, vec3 wi, vec3 X)
{
    X = normalize(X - dot(X, lobe.N) * lobe.N);
    vec3 Y = cross(lobe.N, X);
    vec3 H = normalize(wi + lobe.wo);
    vec3 local = vec3(dot(H, X), dot(H, Y), dot(H, lobe.N));
    float mu_i = clamp(dot(lobe.N, wi), 0.0, 1.0);
    return mx_ggx_NDF(local, lobe.roughness) * mx_ggx_smith_G2(mu_i, lobe.mu_o, lobe.alpha)
           / (4.0 * lobe.mu_o);
}

// Light of an environment. MaterialX draws anisotropic visible normals and divides by G_1 at the mean
// alpha; the factor puts the G_1 of the normals in its place. It is 1 where both alphas are the same.
vec3 microfacet_environment(MicrofacetLobe lobe, vec3 X, int distribution, FresnelData fd)
{
    vec3 radiance = mx_environment_radiance(lobe.N, lobe.wo, X, lobe.roughness, distribution, fd);
    X = normalize(X - dot(X, lobe.N) * lobe.N);
    vec2 across = vec2(dot(lobe.wo, X), dot(lobe.wo, cross(lobe.N, X))) * lobe.roughness;
    float mu2 = lobe.mu_o * lobe.mu_o;
    float alpha2 = lobe.alpha * lobe.alpha;
    float drawn = lobe.mu_o + sqrt(dot(across, across) + mu2);
    return radiance * (drawn / (lobe.mu_o + sqrt(alpha2 + (1.0 - alpha2) * mu2)));
}

// Light of an environment from facets that reflect everything. A film's curve stays outside this sum,
// as an average over the same facets.
vec3 microfacet_white_environment(MicrofacetLobe lobe, vec3 X, int distribution)
{
    FresnelData white = mx_init_fresnel_schlick(vec3(1.0), vec3(1.0), vec3(1.0), 5.0, 0.0, 1.0);
    return microfacet_environment(lobe, X, distribution, white);
}

// Light through the surface: the share that passes, from where a solid sphere sends the view.
vec3 microfacet_transmission(MicrofacetLobe lobe, vec3 X, int distribution, vec3 ior, vec3 tint,
                             vec3 passed)
{
    FresnelData clear = mx_init_fresnel_schlick(vec3(0.0), vec3(1.0), vec3(0.0), 5.0, 0.0, 1.0);
    clear.ior = ior;

    // MaterialX divides the sum by G_1, for a shadowing that it does not have.
    vec3 light = mx_surface_transmission(lobe.N, lobe.wo, X, lobe.roughness, distribution, clear, tint)
                 * mx_ggx_smith_G1(lobe.mu_o, lobe.alpha);

    // It is no number where rounding makes one of many facets reflect totally, those that graze wo. A
    // smooth surface takes their place, at the cosine from which on that does not happen.
    if (!(dot(light, vec3(1.0)) >= 0.0))
    {
        float mu = max(lobe.mu_o, min(0.005 + 2e-3 * ior.x, 0.9));
        vec3 side = normalize(lobe.wo - lobe.mu_o * lobe.N);
        vec3 wo = mu > lobe.mu_o ? mu * lobe.N + sqrt(1.0 - mu * mu) * side : lobe.wo;
        light = mx_surface_transmission(lobe.N, wo, X, vec2(M_FLOAT_EPS), distribution, clear, tint);
    }
    return light * passed;
}
