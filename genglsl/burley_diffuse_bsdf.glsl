// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
#include "lib/half_vector.glsl"

// Directional albedo for color 1: burley_albedo_dir in python/mxeon/models/diffuse.py.
float burley_albedo_dir(float mu, float roughness)
{
    float r = roughness;
    float h = r - 0.5;
    float x = 1.0 - mu;
    float n = x * x * x * x * x;
    float both = (h * h + 0.5 * r * r * x * (1.0 + mu)) / 21.0 + h * r * mu / 42.0
               + r * r * (3.0 * mu * mu - 1.0) / 504.0;
    return 1.0 + n * (h + 2.0 / 3.0 * r * mu) + h / 21.0 + r * mu / 84.0 + n * both;
}

void burley_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness, vec3 N,
                         inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));

    if (weight <= 0.0)
    {
        return;
    }

    vec3 wo = closureData.V;
    vec3 wi = closureData.L;
    N = mx_forward_facing_normal(N, wo);
    float mu_o = clamp(dot(N, wo), 0.0, 1.0);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, wi), 0.0, 1.0);
        float cosine = clamp(dot(wi, eonlib_half_vector(wo, wi, N)), 0.0, 1.0);
        bsdf.response = color * closureData.occlusion * weight * mu_i * M_PI_INV
                        * mx_burley_diffuse(mu_o, mu_i, cosine, roughness);
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = mx_environment_irradiance(N) * color * weight
                        * burley_albedo_dir(mu_o, roughness);
    }
}
