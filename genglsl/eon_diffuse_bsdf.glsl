// SPDX-License-Identifier: Apache-2.0

#include "lib/oren_nayar_lobe.glsl"

void eon_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness,
                      vec3 N, inout BSDF bsdf)
{
    oren_nayar_lobe(closureData, weight, color, roughness, N, true, bsdf);
}
