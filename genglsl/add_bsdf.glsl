// SPDX-License-Identifier: Apache-2.0
// Entry point of the node add for two lobes: 1 - E of their sum, negative where E exceeds 1.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

void add_bsdf(ClosureData closureData, BSDF in1, BSDF in2, out BSDF result)
{
    result.response = in1.response + in2.response;
    result.throughput = in1.throughput + in2.throughput - 1.0;
}
