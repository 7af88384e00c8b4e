// SPDX-License-Identifier: Apache-2.0
// Entry point of the node subsurface_bsdf: the diffusion profile over a sphere of the surface's
// curvature.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
#include "lib/subsurface_blur.glsl"

void subsurface_bsdf(ClosureData closureData, float weight, vec3 color, vec3 radius,
                     float anisotropy, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));  // covers the share `weight` of its base

    // The curvature is the surface's: R(r) counts distances between its points, which a normal of the node does not
    // move. Where nothing changes from pixel to pixel, the surface is flat. Derivatives are defined where all pixels
    // come along.
    float curvature = length(fwidth(closureData.N)) / max(length(fwidth(closureData.P)), 1e-30);

    // A lobe that is switched off costs nothing; a negative weight, never valid, counts as 0.
    if (weight <= 0.0)
    {
        return;
    }
    N = mx_forward_facing_normal(N, closureData.V);

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, closureData.L), -1.0, 1.0);
        // The profile has no anisotropy: its mean free path is that of isotropic scattering,
        // l / (1 - g).
        vec3 reach = curvature * max(radius, vec3(0.0)) / max(1.0 - anisotropy, 1e-3);
        vec3 light = subsurface_blur(mu_i, min(reach, vec3(1e3)));
        bsdf.response = color * light * closureData.occlusion * weight * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        // A uniform environment lights every point alike, so that nothing is blurred.
        bsdf.response = mx_environment_irradiance(N) * color * weight;
    }
}
