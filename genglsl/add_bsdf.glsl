// SPDX-License-Identifier: Apache-2.0
// Node add for BSDFs. The throughput 1 - E is negative if the albedo E exceeds 1.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

void add_bsdf(ClosureData closureData, BSDF in1, BSDF in2, out BSDF result)
{
    result.response = in1.response + in2.response;
    result.throughput = in1.throughput + in2.throughput - 1.0;
}
