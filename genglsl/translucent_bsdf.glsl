// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl"

// Node translucent_bsdf. Light comes from the side that the viewer does not see.

void translucent_bsdf(ClosureData closureData, float weight, vec3 color, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));

    if (weight <= 0.0)
    {
        return;
    }

    N = -mx_forward_facing_normal(N, closureData.V);

    // The occlusion describes the viewer's side and is not used.
    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        bsdf.response = color * weight * clamp(dot(N, closureData.L), 0.0, 1.0) * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = mx_environment_irradiance(N) * color * weight;
    }
}
