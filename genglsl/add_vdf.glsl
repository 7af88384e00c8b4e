// SPDX-License-Identifier: Apache-2.0

#include "lib/medium.glsl"

// Node add for two media: coefficients are added.

void add_vdf(ClosureData closureData, EONLIB_VDF in1, EONLIB_VDF in2, out EONLIB_VDF result)
{
    result.response = vec3(0.0);
    result.throughput = in1.throughput * in2.throughput;
}
