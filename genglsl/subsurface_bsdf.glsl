// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl"
#include "lib/subsurface_blur.glsl"

// Node subsurface_bsdf. The diffusion profile blurs the light on a sphere that has the curvature of
// the surface.

void subsurface_bsdf(ClosureData closureData, float weight, vec3 color, vec3 radius,
                     float anisotropy, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));

    // Diffusion depends on distances between points, so the geometry's normal is used here. If
    // nothing changes between pixels, the surface counts as flat. In a branch, fwidth would be
    // undefined.
    float curvature = length(fwidth(closureData.N)) / max(length(fwidth(closureData.P)), 1e-30);

    if (weight <= 0.0)
    {
        return;
    }
    N = mx_forward_facing_normal(N, closureData.V);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, closureData.L), -1.0, 1.0);
        // Anisotropy lengthens the mean free path by 1 / (1 - anisotropy).
        vec3 reach = curvature * max(radius, vec3(0.0)) / max(1.0 - anisotropy, 1e-3);
        vec3 light = subsurface_blur(mu_i, min(reach, vec3(1e3)));
        bsdf.response = color * light * closureData.occlusion * weight * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        // Blurring does not change the light of a uniform environment.
        bsdf.response = mx_environment_irradiance(N) * color * weight;
    }
}
