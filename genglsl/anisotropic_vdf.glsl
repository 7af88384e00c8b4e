// SPDX-License-Identifier: Apache-2.0

#include "lib/medium.glsl"

// Node anisotropic_vdf: transmittance of one meter of a scattering medium. Light scattered into
// the ray is ignored, so the anisotropy has no effect.

void anisotropic_vdf(ClosureData closureData, vec3 absorption, vec3 scattering, float anisotropy,
                     inout EONLIB_VDF vdf)
{
    if (closureData.closureType == CLOSURE_TYPE_TRANSMISSION)
    {
        vdf.response = vec3(0.0);
        vdf.throughput = exp(-(absorption + scattering));
    }
}
