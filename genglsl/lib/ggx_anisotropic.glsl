// SPDX-License-Identifier: Apache-2.0

#include "ggx_albedo.glsl"

// Isotropic GGX facets that represent anisotropic facets in fits. wo is in the tangent frame.
// Source and equations: tools/fits/ggx_anisotropic.py. Domain: alphas in [1e-3, 1] with a ratio up
// to 50, cosines from 0.01. Largest relative error of E_ss: 2.5e-2. Largest absolute error of a
// dielectric's albedo: 3.4e-2.

// Returns (mu, alpha, k), where 1 - E_ss is k ggx_missing(mu, alpha). `visible` is (mu, alpha) for
// averages over visible facets.
vec3 ggx_facets(vec3 wo, vec2 roughness, out vec2 visible)
{
    vec2 a2 = roughness * roughness;
    float r2 = 0.5 * dot(a2, vec2(1.0));
    vec2 xy = wo.xy * wo.xy + 0.5 * wo.z * wo.z;
    vec2 alpha2 = vec2(dot(a2, xy), dot(a2, xy.yx));  // along wo, across wo
    float area2 = a2.x * a2.y;
    float correlated = max(1.0 - area2 / (alpha2.x * alpha2.y), 0.0);  // squared correlation of slopes
    vec2 alpha = sqrt(alpha2);
    vec2 k = vec2(0.35 * correlated, 0.7 + correlated);
    visible = vec2(wo.z, alpha.x) * (1.0 - k * max(alpha.y - alpha.x, 0.0) / (1.0 + k * alpha.y));
    float t = alpha2.x / r2;
    return vec3(wo.z / sqrt(t), sqrt(r2), 1.0 + 0.074 * (1.0 - area2 / (r2 * r2)) - 0.0792 * (t - 1.0)
                                          + correlated * (0.0696 * (t - 1.0) - 0.1268));
}
