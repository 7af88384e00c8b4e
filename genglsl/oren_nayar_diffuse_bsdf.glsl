// SPDX-License-Identifier: Apache-2.0

#include "lib/oren_nayar_lobe.glsl"

void oren_nayar_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness,
                             vec3 N, bool energy_compensation, inout BSDF bsdf)
{
    oren_nayar_lobe(closureData, weight, color, roughness, N, energy_compensation, bsdf);
}
