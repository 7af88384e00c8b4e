// SPDX-License-Identifier: Apache-2.0

#include "lib/medium.glsl"

// Node multiply for a medium and a number that scales the coefficients.

void multiply_vdfF(ClosureData closureData, EONLIB_VDF in1, float in2, out EONLIB_VDF result)
{
    // The lower limit avoids pow(0, x), which may be NaN.
    result.response = vec3(0.0);
    result.throughput = pow(max(in1.throughput, vec3(1e-30)), vec3(max(in2, 0.0)));
}
