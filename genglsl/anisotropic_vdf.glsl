// SPDX-License-Identifier: Apache-2.0
// Node anisotropic_vdf: the transmittance of one meter that absorbs and scatters. The anisotropy
// has no effect, because light scattered into the ray is ignored.

#include "lib/medium.glsl"

void anisotropic_vdf(ClosureData closureData, vec3 absorption, vec3 scattering, float anisotropy,
                     inout EONLIB_VDF vdf)
{
    if (closureData.closureType == CLOSURE_TYPE_TRANSMISSION)
    {
        vdf.response = vec3(0.0);
        vdf.throughput = exp(-(absorption + scattering));
    }
}
