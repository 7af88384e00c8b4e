// SPDX-License-Identifier: Apache-2.0

#include "lib/medium.glsl"

// Node mix for two media. Coefficients are interpolated, so powers of transmittances are
// multiplied.

void mix_vdf(ClosureData closureData, EONLIB_VDF fg, EONLIB_VDF bg, float mixValue, out EONLIB_VDF result)
{
    // The lower limit avoids pow(0, x), which may be NaN.
    float share = clamp(mixValue, 0.0, 1.0);
    vec3 front = pow(max(fg.throughput, vec3(1e-30)), vec3(share));
    vec3 back = pow(max(bg.throughput, vec3(1e-30)), vec3(1.0 - share));
    result.response = vec3(0.0);
    result.throughput = front * back;
}
