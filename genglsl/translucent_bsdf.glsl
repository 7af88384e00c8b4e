// SPDX-License-Identifier: Apache-2.0
// Entry point of the node translucent_bsdf. Light comes from the side that the viewer does not see.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"

void translucent_bsdf(ClosureData closureData, float weight, vec3 color, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));  // share that reaches the layer below

    // A weight of 0 or less turns the lobe off.
    if (weight <= 0.0)
    {
        return;
    }

    N = -mx_forward_facing_normal(N, closureData.V);

    // Occlusion of the visible side does not apply to the lit side.
    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        bsdf.response = color * weight * clamp(dot(N, closureData.L), 0.0, 1.0) * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = mx_environment_irradiance(N) * color * weight;
    }
}
