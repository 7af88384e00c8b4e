// SPDX-License-Identifier: Apache-2.0
// Entry point of the node subsurface_bsdf: the diffusion profile over a sphere of the surface's
// curvature.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
#include "lib/subsurface_blur.glsl"

void subsurface_bsdf(ClosureData closureData, float weight, vec3 color, vec3 radius,
                     float anisotropy, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));  // the base keeps the share 1 - weight

    // Curvature of the geometry, not of the node's normal, since R(r) depends on distances between points. If nothing
    // changes between pixels, the surface is flat. Derivatives are undefined in branches, so they come first.
    float curvature = length(fwidth(closureData.N)) / max(length(fwidth(closureData.P)), 1e-30);

    // Disabled lobes cost nothing; negative weights are invalid and count as 0.
    if (weight <= 0.0)
    {
        return;
    }
    N = mx_forward_facing_normal(N, closureData.V);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, closureData.L), -1.0, 1.0);
        // The profile has no anisotropy, so it uses the reduced mean free path, l / (1 - g).
        vec3 reach = curvature * max(radius, vec3(0.0)) / max(1.0 - anisotropy, 1e-3);
        vec3 light = subsurface_blur(mu_i, min(reach, vec3(1e3)));
        bsdf.response = color * light * closureData.occlusion * weight * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        // A uniform environment lights all points equally, so nothing is blurred.
        bsdf.response = mx_environment_irradiance(N) * color * weight;
    }
}
