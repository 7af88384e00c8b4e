// SPDX-License-Identifier: Apache-2.0
// Entry point of the node mix for two media: a share of the coefficients of each, an exponent of what
// passes.

#include "lib/medium.glsl"

void mix_vdf(ClosureData closureData, EONLIB_VDF fg, EONLIB_VDF bg, float mixValue, out EONLIB_VDF result)
{
    // Avoid pow(0, x): what float32 has no logarithm of is black.
    float share = clamp(mixValue, 0.0, 1.0);
    vec3 front = pow(max(fg.throughput, vec3(1e-30)), vec3(share));
    vec3 back = pow(max(bg.throughput, vec3(1e-30)), vec3(1.0 - share));
    result.response = vec3(0.0);
    result.throughput = front * back;
}
