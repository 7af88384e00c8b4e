// SPDX-License-Identifier: Apache-2.0
// Entry point of the node add for two media: the coefficients of both.

#include "lib/medium.glsl"

void add_vdf(ClosureData closureData, VDF in1, VDF in2, out VDF result)
{
    result.response = vec3(0.0);
    result.throughput = in1.throughput * in2.throughput;
}
