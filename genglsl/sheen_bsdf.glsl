// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_sheen.glsl"
#include "lib/conty_kulla_albedo.glsl"
#include "lib/half_vector.glsl"

// Node sheen_bsdf, with the modes 0 (Conty-Kulla) and 1 (Zeltner).
//
// Mode 0 clamps roughness to [1e-4, 1], the domain of the fit of the albedo.

// log(sin^2) of the angle between N and the half vector H. If the cosine is small, the code uses a
// series up to the cosine's eighth power. Relative error: 2e-9.
float conty_kulla_log_sine(vec3 N, vec3 H)
{
    float cosine = dot(N, H);
    float c2 = cosine * cosine;
    vec3 sine = cross(N, H);
    return c2 < 0.01 ? -c2 * (1.0 + c2 * (1.0 / 2.0 + c2 * (1.0 / 3.0 + c2 / 4.0)))
                     : log(max(dot(sine, sine), 1e-30));
}

// BRDF of the Conty-Kulla sheen for color 1: [MaterialX2026], Conty-Kulla Sheen Equations.
float conty_kulla_brdf(float mu_o, float mu_i, vec3 N, vec3 H, float roughness)
{
    float shape = 0.5 / roughness;
    float density = (1.0 + shape) * exp(shape * conty_kulla_log_sine(N, H)) * M_PI_INV;
    return density / (4.0 * (mu_i + mu_o - mu_i * mu_o));
}

// Zeltner's sheen for albedo 1, times the cosine: [MaterialX2026], Zeltner Sheen Model. The frame
// is built by a cross product, since wo - mu_o N is only a rounding error if wo is along N.
float zeltner_lobe(vec3 wo, vec3 wi, vec3 N, float mu_o, float roughness)
{
    vec3 Y = cross(N, wo);
    if (dot(Y, Y) < 1e-12)
    {
        Y = cross(N, abs(N.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
    }
    Y = normalize(Y);
    float a = mx_zeltner_sheen_ltc_aInv(mu_o, roughness);
    float b = mx_zeltner_sheen_ltc_bInv(mu_o, roughness);
    float mu_i = dot(N, wi);
    vec3 w = vec3(a * dot(cross(Y, N), wi) + b * mu_i, a * dot(Y, wi), mu_i);
    float quotient = a / dot(w, w);
    return max(mu_i, 0.0) * M_PI_INV * quotient * quotient;
}

void sheen_bsdf(ClosureData closureData, float weight, vec3 color, float roughness, vec3 N,
                int mode, inout BSDF bsdf)
{
    if (weight <= 0.0)
    {
        return;
    }

    vec3 wo = closureData.V;
    vec3 wi = closureData.L;
    N = mx_forward_facing_normal(N, wo);

    // A positive mu_o avoids a division by 0 where both cosines would be 0.
    float mu_o = clamp(dot(N, wo), M_FLOAT_EPS, 1.0);
    float rough = clamp(roughness, mode == 0 ? 1e-4 : 0.01, 1.0);
    float albedo = mode == 0 ? conty_kulla_albedo_dir(mu_o, rough)
                             : mx_zeltner_sheen_dir_albedo(mu_o, rough);

    // The throughput has no color, since light that the color removes is absorbed. The throughput
    // also applies to light that the base transmits.
    bsdf.throughput = vec3(max(1.0 - albedo * weight, 0.0));

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, wi), 0.0, 1.0);
        float lobe = mode == 0
            ? mu_i * conty_kulla_brdf(mu_o, mu_i, N, eonlib_half_vector(wo, wi, N), rough)
            : albedo * zeltner_lobe(wo, wi, N, mu_o, rough);
        bsdf.response = lobe * color * closureData.occlusion * weight;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = albedo * mx_environment_irradiance(N) * color * weight;
    }
}
