// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// Sum of an environment over visible facets. Changed from MaterialX's file of this name, Copyright
// Contributors to the MaterialX Project. Unlike in MaterialX, masking depends on the direction, and
// reflectances are never negative. This file replaces MaterialX's file for clients that search
// `genglsl/environment` before MaterialX's data.

// Refracted light is not divided by G_1 of the view.
#define MX_REFRACTION_UNMASKED

vec3 mx_environment_radiance(vec3 N, vec3 V, vec3 X, vec2 alpha, int distribution, FresnelData fd)
{
    X = normalize(X - dot(X, N) * N);
    vec3 Y = cross(N, X);
    mat3 frame = mat3(X, Y, N);
    vec3 wo = vec3(dot(V, X), dot(V, Y), dot(V, N));
    float mu_o = clamp(wo.z, M_FLOAT_EPS, 1.0);

    // [Heitz2014], Eqs. (43), (86) and (99), where l = |(alpha_x x, alpha_y y, z)| of wo or wi.
    //   G_1 = 2 mu_o / (mu_o + l_o),  G_2 = 2 mu_o mu_i / (l_o mu_i + l_i mu_o)
    vec3 stretch = vec3(alpha, 1.0);
    float length_o = length(stretch * wo);
    vec3 light = vec3(0.0);
    int count = $envRadianceSamples;
    for (int i = 0; i < count; i++)
    {
        vec3 H = mx_ggx_importance_sample_VNDF(mx_spherical_fibonacci(i, count), wo, alpha);
        vec3 wi = fd.refraction ? mx_refraction_solid_sphere(-wo, H, fd.ior.x) : -reflect(wo, H);
        vec3 L = mx_matrix_mul(frame, wi);

        // Density of a reflected direction: G_1 D / (4 mu_o), where D is mx_ggx_NDF.
        float pdf = mx_ggx_NDF(H, alpha) / (2.0 * (mu_o + length_o));
        float lod = mx_latlong_compute_lod(L, pdf, float($envRadianceMips - 1), count);
        vec3 F = max(mx_compute_fresnel(clamp(dot(wo, H), M_FLOAT_EPS, 1.0), fd), 0.0);

        // A visible facet reflects F G_2 / G_1, and `lit` is G_2 / G_1.
        float mu_i = clamp(wi.z, M_FLOAT_EPS, 1.0);
        float lit = mu_i * (mu_o + length_o) / (length_o * mu_i + length(stretch * wi) * mu_o);
        light += mx_latlong_map_lookup(L, $envMatrix, lod, $envRadiance) * (fd.refraction ? 1.0 - F : lit * F);
    }
    return count == 0 ? vec3(0.0) : light / float(count) * $envLightIntensity;
}

vec3 mx_environment_irradiance(vec3 N)
{
    return mx_latlong_map_lookup(N, $envMatrix, 0.0, $envIrradiance) * $envLightIntensity;
}
