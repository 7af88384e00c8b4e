// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Node multiply for a BSDF and a number that scales response and albedo.

void multiply_bsdfF(ClosureData closureData, BSDF in1, float in2, out BSDF result)
{
    float weight = clamp(in2, 0.0, 1.0);
    result.response = in1.response * weight;
    result.throughput = 1.0 - weight * (1.0 - in1.throughput);
}
