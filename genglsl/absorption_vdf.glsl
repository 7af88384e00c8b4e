// SPDX-License-Identifier: Apache-2.0

#include "lib/medium.glsl"

// Node absorption_vdf: transmittance of one meter of a medium, by Beer's law.

void absorption_vdf(ClosureData closureData, vec3 absorption, inout EONLIB_VDF vdf)
{
    if (closureData.closureType == CLOSURE_TYPE_TRANSMISSION)
    {
        vdf.response = vec3(0.0);
        vdf.throughput = exp(-absorption);
    }
}
