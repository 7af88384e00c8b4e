// SPDX-License-Identifier: Apache-2.0

#include "lib/questions.glsl"
#include "../lib/microfacet_transmission.glsl"
#include "../lib/fresnel_dielectric.glsl"

// Microfacet lobes for path tracers: docs/path_tracing.md. Macros replace three functions in the
// nodes' code.
//
// In the denser medium, a facet may be lost: the facet neither reflects wo into the medium nor
// refracts wo out of the medium. A draw replaces a lost facet by its partner, the facet at the
// mirrored height on the spherical cap of visible normals [Dupuy2023]. Mirroring preserves areas,
// and mirroring twice changes nothing, so facets whose partner is lost are drawn twice as often.
//
// Transmission out of the denser medium is reciprocal: see python/mxeon/models/transmission.py. Two
// lobes reflect all other light: a lobe with the Fresnel reflectance from outside (1 beyond the
// critical angle), and a lobe of perfect mirrors.

// Least alpha. Rounded directions cannot resolve narrower lobes.
#define PATH_LEAST_ALPHA 1e-4

// The index of refraction n and |n - 1| are at least this value. If n is 1, refraction does not
// determine the facet.
#define PATH_LEAST_BEND 1e-3

// Least albedo that determines a lobe's probability. A fit may be 0 although facets reflect.
#define PATH_LEAST_SHARE 1e-3

// Value of path_eta for a node's ior.
float path_eta_of(float ior)
{
    float n = path_inside && !path_thin ? 1.0 / max(ior, PATH_LEAST_BEND) : ior;
    return abs(n - 1.0) < PATH_LEAST_BEND ? 1.0 + PATH_LEAST_BEND : max(n, PATH_LEAST_BEND);
}

vec3 path_mirrored(vec3 w, vec3 N)
{
    return w - 2.0 * dot(w, N) * N;
}

// w rotated by 180 degrees about N: the reflection of w by a facet with normal N.
vec3 path_turned(vec3 w, vec3 N)
{
    return 2.0 * dot(w, N) * N - w;
}

// Normal of the facet that reflects or refracts wo into wi. Thin walls do not bend light.
vec3 path_facet_between(vec3 wo, vec3 wi, vec3 N)
{
    bool through = dot(N, wi) < 0.0;
    if (through && !path_thin)
    {
        vec3 H = normalize(wo + path_eta * wi);
        return dot(H, N) < 0.0 ? -H : H;
    }
    return normalize(wo + (through ? path_mirrored(wi, N) : wi));
}

// Direction into which the facet H refracts wo, or N if the facet reflects totally.
vec3 path_refracted(vec3 wo, vec3 H, vec3 N)
{
    float cosine = dot(wo, H);
    float squared = 1.0 - (1.0 - cosine) * (1.0 + cosine) / (path_eta * path_eta);
    return squared > 0.0 ? (cosine / path_eta - sqrt(squared)) * H - wo / path_eta : N;
}

bool path_is_denser()
{
    return path_eta < 1.0 && !path_thin;
}

// Whether facet H neither reflects wo upwards nor refracts wo downwards.
bool path_is_lost(MicrofacetLobe lobe, vec3 H)
{
    return dot(lobe.N, path_turned(lobe.wo, H)) <= 0.0 && dot(lobe.N, path_refracted(lobe.wo, H, lobe.N)) >= 0.0;
}

// The partner of path_facet. Heights z on the cap of visible normals are in [-wo.z, 1].
vec3 path_partner(MicrofacetLobe lobe)
{
    vec3 stretch = vec3(lobe.roughness, 1.0);
    vec3 wo = normalize(microfacet_local(lobe, lobe.wo) * stretch);
    vec3 cap = path_turned(wo, normalize(microfacet_local(lobe, path_facet) / stretch));
    float z = 1.0 - wo.z - cap.z;
    vec2 flat_cap = cap.xy * sqrt(max(1.0 - z * z, 0.0) / max(1.0 - cap.z * cap.z, M_FLOAT_EPS));
    return path_world(vec3(flat_cap + wo.xy, max(z + wo.z, M_FLOAT_EPS)) * stretch, lobe.X, lobe.N);
}

// For wo in the denser medium, gives `lobe` the albedo and averages of the direction into which
// path_facet refracts wo. If no light is refracted, any direction outside serves.
void path_turn_outside(ClosureData closureData, inout MicrofacetLobe lobe)
{
    bool below = dot(lobe.N, lobe.wi) < 0.0;
    vec3 end = below && path_asked != PATH_DRAW ? lobe.wi : path_refracted(lobe.wo, path_facet, lobe.N);
    lobe.mu_h = max(-dot(end, path_facet), 0.0);
    bool leaves = dot(lobe.N, end) < 0.0 && (below || path_asked != PATH_VALUE);
    if (!leaves)
    {
        float mu = sqrt(max(1.0 - (1.0 - lobe.mu_o * lobe.mu_o) / (path_eta * path_eta), 0.25));
        vec3 side = lobe.wo - dot(lobe.wo, lobe.N) * lobe.N;
        end = -mu * lobe.N + sqrt(1.0 - mu * mu) * side / max(length(side), M_FLOAT_EPS);
    }
    closureData.V = path_mirrored(normalize(end), lobe.N);
    MicrofacetLobe outer = microfacet_lobe(closureData, lobe.N, lobe.X, lobe.roughness, false);
    float masking = 1.0 + microfacet_stretched(lobe, lobe.wo) / lobe.mu_o;
    path_reversed = leaves ? masking / (1.0 + microfacet_stretched(outer, outer.wo) / outer.mu_o) : 0.0;
    vec2 passing = eonlib_dielectric_passing(lobe.visible.x, lobe.visible.y, path_eta);
    path_inner = vec3(passing.y, lobe.albedo, 1.0 - passing.x);
    lobe.visible = outer.visible;
    lobe.albedo = outer.albedo;
}

MicrofacetLobe path_microfacet_lobe(ClosureData closureData, vec3 N, vec3 X, vec2 roughness, bool retroreflective)
{
    roughness = max(roughness, vec2(PATH_LEAST_ALPHA));
    MicrofacetLobe lobe = microfacet_lobe(closureData, N, X, roughness, retroreflective);
    if (retroreflective && dot(lobe.N, lobe.wi) < 0.0)
    {
        lobe.wi = path_turned(lobe.wi, lobe.N);  // only reflection is mirrored
    }
    path_facet = path_facet_between(lobe.wo, lobe.wi, lobe.N);
    if (path_asked == PATH_DRAW)
    {
        vec3 wo = path_local(lobe.wo, lobe.X, lobe.N);
        wo.z = lobe.mu_o;
        path_facet = path_world(mx_ggx_importance_sample_VNDF(path_u.xy, wo, lobe.roughness), lobe.X, lobe.N);
        if (path_is_denser() && path_is_lost(lobe, path_facet))
        {
            path_facet = path_partner(lobe);
        }
    }
    lobe.mu_h = clamp(dot(lobe.wo, path_facet), M_FLOAT_EPS, 1.0);
    if (path_is_denser())
    {
        path_turn_outside(closureData, lobe);
    }
    return lobe;
}

// Density of wi in 1/sr if visible normals are drawn. For reflection, the density is G_1 D / (4
// mu_o). For refraction, the Jacobian dh / dwi of the half vector h is n^2 |wi . h| / |wo + n
// wi|^2: [Walter2007], Eq. (17).
float path_facet_pdf(MicrofacetLobe lobe, bool through)
{
    if ((dot(lobe.N, lobe.wi) < 0.0) != through)
    {
        return 0.0;
    }
    vec3 wo = path_local(lobe.wo, lobe.X, lobe.N);
    vec3 H = path_facet;
    vec2 stretched = lobe.roughness * wo.xy;
    float visible = mx_ggx_NDF(path_local(H, lobe.X, lobe.N), lobe.roughness)
                    / (lobe.mu_o + sqrt(dot(stretched, stretched) + lobe.mu_o * lobe.mu_o));
    if (!through || path_thin)
    {
        return 0.5 * visible;
    }
    float cosine_o = dot(lobe.wo, H);
    float cosine_i = -dot(lobe.wi, H);
    vec3 total = lobe.wo + path_eta * lobe.wi;
    float jacobian = path_eta * path_eta * cosine_i / dot(total, total);
    return cosine_o > 0.0 && cosine_i > 0.0 ? 2.0 * visible * cosine_o * jacobian : 0.0;
}

// Fraction G_2 / G_1 of the reflected light that other facets do not shadow, or 0 if path_facet
// reflects wo downwards.
float path_unshadowed(MicrofacetLobe lobe)
{
    vec3 wi = path_turned(lobe.wo, path_facet);
    float mu_i = max(dot(lobe.N, wi), 0.0);
    float stretched = microfacet_stretched(lobe, lobe.wo);
    return mu_i * (lobe.mu_o + stretched) / (stretched * mu_i + microfacet_stretched(lobe, wi) * lobe.mu_o);
}

// Packed direction into which path_facet reflects or refracts wo.
vec2 path_facet_draw(MicrofacetLobe lobe, bool through, bool retroreflective)
{
    vec3 H = path_facet;
    vec3 wi = path_turned(lobe.wo, H);
    if (through)
    {
        wi = path_thin ? path_mirrored(wi, lobe.N) : path_refracted(lobe.wo, H, lobe.N);
    }
    bool below = dot(lobe.N, wi) < 0.0;
    wi = below && retroreflective ? path_turned(wi, lobe.N) : wi;
    return below == through ? path_packed(normalize(wi)) : PATH_WASTED;
}

void path_microfacet_bsdf(ClosureData closureData, MicrofacetLobe lobe, FresnelData fd, MicrofacetFresnel F, vec3 tint,
                          float weight, int distribution, int scatter_mode, inout BSDF bsdf)
{
    // scatter_mode is 0 to reflect, 1 to transmit and 2 for both. A lobe with mode 1 lies below a
    // reflecting lobe, so the lobe also draws reflected directions.
    vec3 scale = tint * weight;
    vec3 factor = 1.0 + F.average * ((1.0 - lobe.albedo) / lobe.albedo);
    vec3 albedo = lobe.albedo * F.visible * factor;
    vec3 through = max(1.0 - albedo, 0.0);
    bool below = dot(lobe.N, lobe.wi) < 0.0;
    bool valued = path_asked == PATH_VALUE;
    if (path_is_denser())
    {
        vec3 curve = vec3(1.0); // transmittance relative to a dielectric
        if (valued && !below)
        {
            float n = 1.0 / path_eta;
            float lost = eonlib_fresnel_dielectric_avg(n) * (1.0 - lobe.albedo);
            curve = through / (1.0 - (lobe.albedo + lost)
                                     * eonlib_fresnel_dielectric_visible(lobe.visible.x, lobe.visible.y, n));
        }
        F.value = lobe.mu_h > 0.0 ? F.value : vec3(1.0);
        vec3 returned = max(1.0 - path_inner.x * curve, 0.0);
        F.value += max(returned / path_inner.y - (1.0 - (1.0 - path_inner.z) * curve), 0.0);
        factor = vec3(1.0);
        through *= path_reversed;
        albedo = valued && below ? albedo : returned;
    }
    if (scatter_mode != 1)
    {
        // In draws, the lobe below keeps its full weight, because that lobe draws refracted wi.
        bsdf.throughput = path_is_denser() && !valued ? vec3(1.0) : max(1.0 - albedo * weight, 0.0);
        bsdf.response = microfacet_lossless(lobe) * F.value * factor * scale;
    }
    through *= scatter_mode == 0 ? 0.0 : 1.0;
    if (valued)
    {
        bsdf.response += through * scale * path_facet_pdf(lobe, true);
    }
    else
    {
        float reflects = path_mean(F.value * factor * scale) * path_unshadowed(lobe);
        float refracts = path_mean(through * scale);
        reflects = refracts > 0.0 ? reflects / (reflects + refracts) : 1.0;
        bool drawn = path_asked == PATH_DRAW;
        below = drawn ? path_u.z >= reflects : below;
        float part = below ? 1.0 - reflects : reflects;
        path_u.z = drawn ? (below ? path_u.z - reflects : path_u.z) / part : path_u.z;
        float draws = path_is_denser() && path_is_lost(lobe, path_partner(lobe)) ? 2.0 : 1.0;
        bool turned = distance(lobe.wo, closureData.V) > 0.0;
        bsdf.response = path_answer(path_mean((scatter_mode == 0 ? max(albedo, PATH_LEAST_SHARE) : vec3(1.0)) * scale),
                                    drawn ? path_facet_draw(lobe, below, turned) : PATH_WASTED,
                                    part * draws * path_facet_pdf(lobe, below));
    }
}

void path_microfacet_bsdf(ClosureData closureData, MicrofacetLobe lobe, FresnelData fd, MicrofacetFresnel F, vec3 tint,
                          float weight, int distribution, inout BSDF bsdf)
{
    path_microfacet_bsdf(closureData, lobe, fd, F, tint, weight, distribution, 0, bsdf);
}

// Replaces microfacet_is_off. Only the weight turns a lobe off.
bool path_microfacet_is_off(ClosureData closureData, float weight, int scatter_mode)
{
    return weight <= 0.0;
}

#define microfacet_lobe path_microfacet_lobe
#define microfacet_bsdf path_microfacet_bsdf
#define microfacet_is_off path_microfacet_is_off
#include "../dielectric_bsdf.glsl"
#include "../conductor_bsdf.glsl"
#include "../generalized_schlick_bsdf.glsl"
#undef microfacet_lobe
#undef microfacet_bsdf
#undef microfacet_is_off

void path_dielectric_bsdf(ClosureData closureData, float weight, vec3 tint, float ior, vec2 roughness,
                          bool retroreflective, float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X,
                          int distribution, int scatter_mode, inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        path_eta = path_eta_of(ior);
        dielectric_bsdf(path_question_in_direct_light(closureData), weight, tint,
                        path_is_denser() ? 1.0 / path_eta : path_inside ? path_eta : ior, roughness, retroreflective,
                         thinfilm_thickness, thinfilm_ior, N, X, distribution, scatter_mode, bsdf);
        path_end(bsdf);
    }
}

void path_conductor_bsdf(ClosureData closureData, float weight, vec3 ior, vec3 extinction, vec2 roughness,
                         bool retroreflective, float thinfilm_thickness, float thinfilm_ior, vec3 N, vec3 X,
                         int distribution, inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        path_eta = 1.0; // opaque
        conductor_bsdf(path_question(closureData), weight, ior, extinction, roughness, retroreflective,
                       thinfilm_thickness, thinfilm_ior, N, X, distribution, bsdf);
        path_end(bsdf);
    }
}

void path_generalized_schlick_bsdf(ClosureData closureData, float weight, vec3 color0, vec3 color82, vec3 color90,
                                   float exponent, vec2 roughness, bool retroreflective, float thinfilm_thickness,
                                   float thinfilm_ior, vec3 N, vec3 X, int distribution, int scatter_mode,
                                   inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        path_eta = path_eta_of(mx_f0_to_ior(path_mean(color0)));
        generalized_schlick_bsdf(path_question_in_direct_light(closureData), weight, color0, color82, color90, exponent, roughness,
                                 retroreflective, thinfilm_thickness, thinfilm_ior, N, X, distribution, scatter_mode,
                                 bsdf);
        path_end(bsdf);
    }
}
