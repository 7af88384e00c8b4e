// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Node conical_edf, which emits light in a cone around the normal.

// Cosine of half an opening angle in degrees, as 1 - 2 sin^2(angle / 4). The sine is a series with
// an error of 7e-10 in [0, pi / 2], because built-in cosines may be off by 2e-4.
float conical_edf_cosine(float angle)
{
    float u = angle * (M_PI / 720.0);
    float w = u * u;
    float tail = 1.0 - w / 72.0 * (1.0 - w / 110.0 * (1.0 - w / 156.0));
    float sine = u * (1.0 - w / 6.0 * (1.0 - w / 20.0 * (1.0 - w / 42.0 * tail)));
    return 1.0 - 2.0 * sine * sine;
}

void conical_edf(ClosureData closureData, vec3 color, vec3 N, float inner_angle, float outer_angle,
                 out EDF result)
{
    result = vec3(0.0);
    if (closureData.closureType == CLOSURE_TYPE_EMISSION)
    {
        float mu = max(dot(N, closureData.V), 0.0);
        float inner = conical_edf_cosine(inner_angle);
        float outer = conical_edf_cosine(outer_angle);
        // The lower limit avoids 0 / 0, because rounded cosines of close angles may be equal.
        if (outer_angle > inner_angle)
        {
            float t = clamp((mu - outer) / max(inner - outer, 1e-8), 0.0, 1.0);
            result = color * (t * t * (3.0 - 2.0 * t));
        }
        else if (mu >= inner)
        {
            result = color;
        }
    }
}
