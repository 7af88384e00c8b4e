// SPDX-License-Identifier: Apache-2.0
// Entry point of the node conical_edf: emission inside a cone around the normal.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Cosine of half an opening angle in degrees: 1 - 2 sin^2(angle / 4). The sine is a series up to
// the 13th power, accurate to 7e-10 in [0, pi / 2]; built-in cosines may be off by 2e-4.
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
        // Views from the back count as grazing.
        float mu = max(dot(N, closureData.V), 0.0);
        float inner = conical_edf_cosine(inner_angle);
        float outer = conical_edf_cosine(outer_angle);
        // Rounded cosines of close angles may be equal or swapped. 1e-8 is below the spacing of
        // floats.
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
