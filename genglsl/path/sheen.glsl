// SPDX-License-Identifier: Apache-2.0

#include "lib/questions.glsl"
#include "../sheen_bsdf.glsl"

// Sheen for path tracers. Zeltner's lobe is drawn as a linearly transformed cosine (LTC). Conty and
// Kulla's lobe is brightest at the horizon and is drawn uniformly.

// X axis of the frame of zeltner_lobe, in which wo has azimuth 0.
vec3 path_sheen_across(vec3 N)
{
    vec3 Y = cross(N, path_wo);
    return dot(Y, Y) < 1e-12 ? path_across(N) : normalize(cross(normalize(Y), N));
}

void path_sheen_bsdf(ClosureData closureData, float weight, vec3 color, float roughness, vec3 N, int mode,
                     inout BSDF bsdf)
{
    if (!path_is_asked(closureData))
    {
        return;
    }
    sheen_bsdf(path_question(closureData), weight, color, roughness, N, mode, bsdf);
    if (path_asked != PATH_VALUE)
    {
        N = mx_forward_facing_normal(N, path_wo);
        vec3 X = path_sheen_across(N);
        float phi = 2.0 * M_PI * path_u.y;
        float z = mode == 0 ? path_u.x : sqrt(1.0 - path_u.x);
        vec3 wi = vec3(sqrt(1.0 - z * z) * vec2(mx_cos(phi), mx_sin(phi)), z);
        float above = dot(N, path_wi) > 0.0 ? 1.0 : 0.0;
        float pdf = 0.5 * M_PI_INV;
        if (mode != 0)
        {
            // The inverse LTC matrix is [[a, 0, b], [0, a, 0], [0, 0, 1]]: [MaterialX2026], Zeltner
            // Sheen Model, LTC Inverse Matrix.
            float mu_o = clamp(dot(N, path_wo), M_FLOAT_EPS, 1.0);
            float rough = clamp(roughness, 0.01, 1.0);
            float a = mx_zeltner_sheen_ltc_aInv(mu_o, rough);
            float b = mx_zeltner_sheen_ltc_bInv(mu_o, rough);
            wi = normalize(vec3((wi.x - b * wi.z) / a, wi.y / a, wi.z));
            pdf = zeltner_lobe(path_wo, path_wi, N, mu_o, rough);
        }
        bsdf.response = path_answer(path_mean(bsdf.response), path_packed(path_world(wi, X, N)), above * pdf);
    }
    path_end(bsdf);
}
