// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// Prefiltered environment with MaterialX's lookup and eonlib's albedo. Changed from MaterialX's
// file of this name, Copyright Contributors to the MaterialX Project. This file replaces
// MaterialX's file for clients that search `genglsl/environment` before MaterialX's data.

#define EONLIB_PREFILTERED

// Mip level for a roughness alpha.
float mx_latlong_alpha_to_lod(float alpha)
{
    float lodBias = (alpha < 0.25) ? sqrt(alpha) : 0.5 * alpha + 0.375;
    return lodBias * float($envRadianceMips - 1);
}

// Mean of the environment over a lobe of reflected or refracted directions.
vec3 eonlib_prefiltered_light(vec3 N, vec3 V, vec2 alpha, FresnelData fd)
{
    vec3 L = fd.refraction ? mx_refraction_solid_sphere(-V, N, fd.ior.x) : -reflect(V, N);
    float lod = mx_latlong_alpha_to_lod(mx_average_alpha(alpha));
    return mx_latlong_map_lookup(L, $envMatrix, lod, $envRadiance) * $envLightIntensity;
}

// Prefiltered light times the share that facets reflect or transmit. Every version of MaterialX has
// this overload of mx_ggx_dir_albedo.
vec3 mx_environment_radiance(vec3 N, vec3 V, vec3 X, vec2 alpha, int distribution, FresnelData fd)
{
    N = mx_forward_facing_normal(N, V);
    float mu = clamp(dot(N, V), M_FLOAT_EPS, 1.0);
    vec3 F0 = mx_compute_fresnel(1.0, fd);
    vec3 F90 = mx_compute_fresnel(0.0, fd);
    vec3 share = mx_ggx_dir_albedo(mu, mx_average_alpha(alpha), F0, F90);
    return eonlib_prefiltered_light(N, V, alpha, fd) * (fd.refraction ? vec3(1.0) - share : share);
}

vec3 mx_environment_irradiance(vec3 N)
{
    return mx_latlong_map_lookup(N, $envMatrix, 0.0, $envIrradiance) * $envLightIntensity;
}
