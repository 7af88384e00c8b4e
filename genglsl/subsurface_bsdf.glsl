// SPDX-License-Identifier: Apache-2.0
// Entry point of the node subsurface_bsdf. The diffusion profile is applied on a sphere that has
// the curvature of the surface.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
#include "lib/subsurface_blur.glsl"

void subsurface_bsdf(ClosureData closureData, float weight, vec3 color, vec3 radius,
                     float anisotropy, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));  // share that reaches the layer below

    // The curvature is that of the geometry, not that of the node's normal, since R(r) depends on
    // distances between points. The surface is flat if nothing changes between pixels. Derivatives
    // are undefined in branches, so they are taken first.
    float curvature = length(fwidth(closureData.N)) / max(length(fwidth(closureData.P)), 1e-30);

    // A weight of 0 or less turns the lobe off.
    if (weight <= 0.0)
    {
        return;
    }
    N = mx_forward_facing_normal(N, closureData.V);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, closureData.L), -1.0, 1.0);
        // The reduced mean free path, l / (1 - g), accounts for the anisotropy g.
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
