// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Node add for two BSDFs. The throughput, 1 minus both albedos, may be negative.

void add_bsdf(ClosureData closureData, BSDF in1, BSDF in2, out BSDF result)
{
    result.response = in1.response + in2.response;
    result.throughput = in1.throughput + in2.throughput - 1.0;
}
