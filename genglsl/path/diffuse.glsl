// SPDX-License-Identifier: Apache-2.0

#include "lib/questions.glsl"
#include "../oren_nayar_diffuse_bsdf.glsl"
#include "../eon_diffuse_bsdf.glsl"
#include "../burley_diffuse_bsdf.glsl"
#include "../subsurface_bsdf.glsl"
#include "../translucent_bsdf.glsl"
#include "../sampling/eon_sampling.glsl"

// Diffuse lobes for path tracers. Lobes other than EON are drawn in proportion to the cosine.

// Draws directions in proportion to EON with the mean of the three color channels.
void path_eon(vec3 color, float roughness, vec3 N, inout BSDF bsdf)
{
    if (path_asked != PATH_VALUE)
    {
        N = mx_forward_facing_normal(N, path_wo);
        vec3 X = path_across(N);
        vec3 wo = path_local(path_wo, X, N);
        vec3 wi = path_local(path_wi, X, N);
        wo.z = max(wo.z, 0.0);
        float rho = min(path_mean(color), 1.0);
        float r = clamp(roughness, 0.0, 1.0);
        vec3 drawn = eon_sample(wo, path_u.x, path_u.y, rho, r);
        float pdf = wi.z > 0.0 ? eon_pdf(wo, wi, rho, r) : 0.0;
        bsdf.response = path_answer(path_mean(bsdf.response), path_packed(path_world(drawn, X, N)), pdf);
    }
    path_end(bsdf);
}

void path_oren_nayar_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness, vec3 N,
                                  bool energy_compensation, inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        closureData = path_question(closureData);
        oren_nayar_diffuse_bsdf(closureData, weight, color, roughness, N, energy_compensation, bsdf);
        if (energy_compensation)
        {
            path_eon(color, roughness, N, bsdf);
        }
        else
        {
            path_cosine(mx_forward_facing_normal(N, path_wo), bsdf);
        }
    }
}

void path_eon_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness, vec3 N, inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        eon_diffuse_bsdf(path_question(closureData), weight, color, roughness, N, bsdf);
        path_eon(color, roughness, N, bsdf);
    }
}

void path_burley_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness, vec3 N,
                              inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        burley_diffuse_bsdf(path_question(closureData), weight, color, roughness, N, bsdf);
        path_cosine(mx_forward_facing_normal(N, path_wo), bsdf);
    }
}

void path_subsurface_bsdf(ClosureData closureData, float weight, vec3 color, vec3 radius, float anisotropy, vec3 N,
                          inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        subsurface_bsdf(path_question(closureData), weight, color, radius, anisotropy, N, bsdf);
        path_cosine(mx_forward_facing_normal(N, path_wo), bsdf);
    }
}

void path_translucent_bsdf(ClosureData closureData, float weight, vec3 color, vec3 N, inout BSDF bsdf)
{
    if (path_is_asked(closureData))
    {
        translucent_bsdf(path_question(closureData), weight, color, N, bsdf);
        path_cosine(-mx_forward_facing_normal(N, path_wo), bsdf);
    }
}
