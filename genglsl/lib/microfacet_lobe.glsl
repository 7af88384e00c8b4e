// SPDX-License-Identifier: Apache-2.0
// What the microfacet nodes share: geometry, reflectances and response of a GGX lobe.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"
#include "ggx_albedo.glsl"
#include "thin_film.glsl"

// Least index of refraction for MaterialX's own curve: along the normal it divides 0 by 0 where
// float32 adds nothing to 1. With ior 0 the curve of eonlib reflects everything.
#define MICROFACET_LEAST_IOR 1e-3

// Positive nodes of Gauss's rules of two and of four for a semicircle over [-1, 1]. Of n nodes, x has the
// weight 2 (1 - x^2) / (n + 1).
#define MICROFACET_HALF 0.5
#define MICROFACET_INNER 0.30901699
#define MICROFACET_OUTER 0.80901699

// Mean, reach and bend of four nodes for visible facets, fitted to the averages of random films. Source:
// tools/fits/thin_film_nodes.py. Domain: mu in [0.1, 1], alpha in [0.01, 1], films up to 1000 nm. Largest error of
// a reflectance: 5.9e-2, of a film of index 1.16 in which a metal of a lower index reflects totally.
#define MICROFACET_FACETS_00 vec3(3.4303, -0.000094979, 0.44939)
#define MICROFACET_FACETS_01 vec3(-1.7007, 4.6952, -0.93653)
#define MICROFACET_FACETS_02 vec3(-3.1011, -6.0773, 0.78291)
#define MICROFACET_FACETS_03 vec3(1.3698, 1.3104, -0.55497)
#define MICROFACET_FACETS_10 vec3(0.046978, 3.7667, 0.66991)
#define MICROFACET_FACETS_11 vec3(2.3613, -7.8535, -0.19493)
#define MICROFACET_FACETS_12 vec3(-2.8816, 3.6722, -0.84088)
#define MICROFACET_FACETS_20 vec3(-7.968, -2.5177, -1.7317)
#define MICROFACET_FACETS_21 vec3(8.4497, 3.4417, 2.096)
#define MICROFACET_FACETS_30 vec3(0.062022, -0.39209, -0.02136)

// Width of all nodes together, relative to their reach; reach below which two serve.
#define MICROFACET_SHARE 0.97
#define MICROFACET_ALIKE 0.09

// Compensation below which two cosines serve for F_ss.
#define MICROFACET_LITTLE 0.01

// Weights whose sums tell lobes under films apart, in one pixel: two of mu_o, alpha, thickness and index of
// the film, two of the curve's average without it and its kind. Lobes that differ have all four in common
// where two roundings coincide at least.
#define MICROFACET_LOBE_KEY vec4(1.0, 0.7320508, 0.0041421356, 0.236068)
#define MICROFACET_FILM_KEY vec4(-0.3166248, 0.6055513, 0.0078256676, -1.1231056)
#define MICROFACET_CURVE_KEY vec4(0.4142136, 0.6457513, 0.1622777, 1.0)
#define MICROFACET_COLOR_KEY vec4(-0.8708287, 0.3851648, 0.5677644, 1.0)

// Index of a mirror by MaterialX's curves of dielectrics and conductors.
#define MICROFACET_MIRROR_IOR 1e8

// A variable that a call leaves to the next one.
#ifdef __SLANG__
#define MICROFACET_STATIC static
#else
#define MICROFACET_STATIC
#endif

// The last two lobes under films, and their averages: every closure and every light of a pixel asks for the
// same ones, and materials have a metal and a dielectric under one film.
MICROFACET_STATIC vec4 microfacet_key1 = vec4(0.0);
MICROFACET_STATIC vec4 microfacet_key2 = vec4(0.0);
MICROFACET_STATIC vec3 microfacet_average1 = vec3(0.0);
MICROFACET_STATIC vec3 microfacet_average2 = vec3(0.0);
MICROFACET_STATIC vec3 microfacet_visible1 = vec3(0.0);
MICROFACET_STATIC vec3 microfacet_visible2 = vec3(0.0);

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
    float alpha;
    float albedo; // E_ss
    int closure;
};

// A Fresnel curve's value at the half vector, its cosine-weighted average over the hemisphere,
// F_ss, and its average over the visible facets.
struct MicrofacetFresnel
{
    vec3 value;
    vec3 average;
    vec3 visible;
};

// Whether a lobe does nothing: it is switched off, or transmits and is asked for reflection. A
// negative weight, never valid, counts as 0.
bool microfacet_is_off(ClosureData closureData, float weight, int scatter_mode)
{
    bool transmission = closureData.closureType == CLOSURE_TYPE_TRANSMISSION;
    return weight <= 0.0 || (scatter_mode == 1 && !transmission);
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
    lobe.mu_h = clamp(dot(lobe.wo, normalize(lobe.wi + lobe.wo)), M_FLOAT_EPS, 1.0);
    lobe.roughness = clamp(roughness, M_FLOAT_EPS, 1.0);
    lobe.alpha = mx_average_alpha(lobe.roughness);
    lobe.albedo = ggx_albedo_dir(lobe.mu_o, lobe.alpha);
    return lobe;
}

// Mean of the cosines of wo with the visible facets, reach of the nodes around it, and their bend.
vec3 microfacet_facets(float mu, float alpha)
{
    float y = alpha / (alpha + 0.2);
    vec3 C0 = MICROFACET_FACETS_00
              + y * (MICROFACET_FACETS_01 + y * (MICROFACET_FACETS_02 + y * MICROFACET_FACETS_03));
    vec3 C1 = MICROFACET_FACETS_10 + y * (MICROFACET_FACETS_11 + y * MICROFACET_FACETS_12);
    vec3 C2 = MICROFACET_FACETS_20 + y * MICROFACET_FACETS_21;
    vec3 C = C0 + mu * (C1 + mu * (C2 + mu * MICROFACET_FACETS_30));
    float s = alpha / sqrt(mu + alpha);
    return vec3(mu + s * s * C.x, s * C.y, C.z);
}

// Node i of 2 or 4 for visible facets: cosine, weight and width. They are Gauss's, x, bent to
// x + bend (4 x^2 - 1), which has the same mean.
vec3 microfacet_visible(int i, int count, vec3 facets)
{
    float node = i == 0 || i == 3 ? MICROFACET_OUTER : MICROFACET_INNER;
    node = count == 2 ? MICROFACET_HALF : node;
    float x = 2 * i < count ? -node : node;
    float mu = facets.x + facets.y * (x + facets.z * (4.0 * x * x - 1.0));
    float scale = count == 2 ? 2.0 / 3.0 : 0.4;
    float width = count == 2 ? 0.5 * MICROFACET_SHARE : 0.25 * MICROFACET_SHARE;
    return vec3(clamp(mu, 0.0, 1.0), scale - scale * x * x, width * facets.y);
}

// Put a film's reflectances in the place of those without one, in one loop: of the visible facets and of the
// cosines of the hemisphere, unless the last lobes had them, and of the half vector.
void microfacet_add_film(MicrofacetLobe lobe, FresnelData fd, inout MicrofacetFresnel F)
{
    if (fd.airy)
    {
        // Look up the averages.
        vec4 inputs = vec4(lobe.mu_o, lobe.alpha, fd.tf_thickness, fd.tf_ior);
        vec4 curve = vec4(F.average, float(fd.model));
        vec4 key = vec4(dot(MICROFACET_LOBE_KEY, inputs), dot(MICROFACET_FILM_KEY, inputs),
                        dot(MICROFACET_CURVE_KEY, curve), dot(MICROFACET_COLOR_KEY, curve));
        bool is_last = dot(abs(key - microfacet_key1), vec4(1.0)) == 0.0;
        bool is_known = is_last || dot(abs(key - microfacet_key2), vec4(1.0)) == 0.0;
        F.average = is_last ? microfacet_average1 : microfacet_average2;
        F.visible = is_last ? microfacet_visible1 : microfacet_visible2;

        // Count the nodes.
        ThinFilm film = thin_film(fd);
        vec3 reached = microfacet_facets(lobe.mu_o, lobe.alpha);
        int facets = reached.y < MICROFACET_ALIKE ? 2 : 4;
        int cosines = 1.0 - lobe.albedo < MICROFACET_LITTLE * lobe.albedo ? 2 : 5;
        int last = facets + cosines;
        int end = lobe.closure == CLOSURE_TYPE_REFLECTION ? last + 1 : last;
        int i = is_known ? last : 0;
        if (i < end)
        {
            F.average = is_known ? F.average : vec3(0.0);
            F.visible = is_known ? F.visible : vec3(0.0);
            do
            {
                // Cosine, weight and width of a node.
                vec3 node = i < last ? thin_film_gauss(i - facets, cosines) : vec3(lobe.mu_h, 1.0, 0.0);
                node = i < facets ? microfacet_visible(i, facets, reached) : node;

                // Add its share.
                vec3 share = node.y * thin_film_fresnel(node.x, node.z, film, fd);
                F.visible += i < facets ? share : vec3(0.0);
                F.average += i < facets || i == last ? vec3(0.0) : share;
                F.value = share;
                i++;
            } while (i < end);
        }

        // Keep the averages.
        microfacet_key2 = microfacet_key1;
        microfacet_average2 = microfacet_average1;
        microfacet_visible2 = microfacet_visible1;
        microfacet_key1 = key;
        microfacet_average1 = F.average;
        microfacet_visible1 = F.visible;
    }
}

// D G_2 / (4 mu_o), the value of facets that reflect everything, times mu_i: 0 below the horizon.
float microfacet_value(MicrofacetLobe lobe)
{
    vec3 X = normalize(lobe.X - dot(lobe.X, lobe.N) * lobe.N);
    vec3 Y = cross(lobe.N, X);
    vec3 H = normalize(lobe.wi + lobe.wo);
    vec3 local = vec3(dot(H, X), dot(H, Y), dot(H, lobe.N));
    float mu_i = clamp(dot(lobe.N, lobe.wi), 0.0, 1.0);
    return mx_ggx_NDF(local, lobe.roughness) * mx_ggx_smith_G2(mu_i, lobe.mu_o, lobe.alpha)
           / (4.0 * lobe.mu_o);
}

// The curve that MaterialX sums over the facets of an environment. It has no film: a film's curve
// stays outside the sum, as an average over the same facets, and within it they reflect everything.
FresnelData microfacet_environment_curve(FresnelData fd)
{
    if (fd.model == FRESNEL_MODEL_DIELECTRIC)
    {
        fd.ior = max(fd.ior, MICROFACET_LEAST_IOR);
    }
    if (fd.airy)
    {
        fd.ior = vec3(MICROFACET_MIRROR_IOR);
        fd.F0 = vec3(1.0);
        fd.F82 = vec3(1.0);
        fd.F90 = vec3(1.0);
    }
    fd.airy = false;
    return fd;
}

// Light of an environment. MaterialX draws anisotropic visible normals and divides by G_1 at the
// mean alpha; the factor puts the G_1 of the normals in its place. It is 1 where both alphas are
// the same.
vec3 microfacet_environment(MicrofacetLobe lobe, int distribution, FresnelData fd)
{
    FresnelData curve = microfacet_environment_curve(fd);
    vec3 radiance = mx_environment_radiance(lobe.N, lobe.wo, lobe.X, lobe.roughness, distribution,
                                            curve);
    vec3 X = normalize(lobe.X - dot(lobe.X, lobe.N) * lobe.N);
    vec2 across = vec2(dot(lobe.wo, X), dot(lobe.wo, cross(lobe.N, X))) * lobe.roughness;
    float mu2 = lobe.mu_o * lobe.mu_o;
    float alpha2 = lobe.alpha * lobe.alpha;
    float drawn = lobe.mu_o + sqrt(dot(across, across) + mu2);
    return radiance * (drawn / (lobe.mu_o + sqrt(alpha2 + (1.0 - alpha2) * mu2)));
}

// Light through a surface that reflects nothing, along the view refracted twice.
vec3 microfacet_transmission(MicrofacetLobe lobe, int distribution, vec3 ior, vec3 tint)
{
    FresnelData clear = mx_init_fresnel_schlick(vec3(0.0), vec3(1.0), vec3(0.0), 5.0, 0.0, 1.0);
    clear.ior = max(ior, MICROFACET_LEAST_IOR);

    // MaterialX divides the sum by G_1, for a shadowing that it does not have.
    float shadowing = mx_ggx_smith_G1(lobe.mu_o, lobe.alpha);
    vec3 wo = lobe.wo;
    vec2 roughness = lobe.roughness;
    vec3 light = vec3(-1.0);

    // It is NaN where rounding makes one of many facets reflect totally, those that graze wo. In a
    // second look-up a smooth surface takes their place, at a cosine where that does not happen.
    for (int i = 0; i < 2 && !(dot(light, vec3(1.0)) >= 0.0); i++)
    {
        light = shadowing * mx_surface_transmission(lobe.N, wo, lobe.X, roughness, distribution,
                                                    clear, tint);
        float mu = max(lobe.mu_o, min(0.005 + 2e-3 * clear.ior.x, 0.9));
        vec3 side = normalize(lobe.wo - lobe.mu_o * lobe.N);
        wo = mu > lobe.mu_o ? mu * lobe.N + sqrt(1.0 - mu * mu) * side : lobe.wo;
        roughness = vec2(M_FLOAT_EPS);
        shadowing = 1.0;
    }
    return light;
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
        bsdf.response = microfacet_value(lobe) * F.value * scale * closureData.occlusion;
    }
    else if (lobe.closure == CLOSURE_TYPE_TRANSMISSION && scatter_mode != 0)
    {
        vec3 passed = max(1.0 - lobe.albedo * F.visible * compensation, 0.0);
        bsdf.response = microfacet_transmission(lobe, distribution, fd.ior, tint) * passed * weight;
    }
    else if (lobe.closure == CLOSURE_TYPE_INDIRECT)
    {
        vec3 outside = fd.airy ? microfacet_visible1 : vec3(1.0);  // F.visible, needless without a film
        bsdf.response = microfacet_environment(lobe, distribution, fd) * outside * scale;
    }
}
