// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Node layer for two lobes. The throughput of the top (at least 0) multiplies the base.

void layer_bsdf(ClosureData closureData, BSDF top, BSDF base, out BSDF result)
{
    vec3 passed = max(top.throughput, 0.0);
    result.response = top.response + base.response * passed;
    result.throughput = min(top.throughput, 0.0) + passed * base.throughput;
}
