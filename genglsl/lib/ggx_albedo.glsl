// SPDX-License-Identifier: Apache-2.0
// Directional albedo of isotropic GGX microfacets with height-correlated Smith shadowing.
//
// mu, the cosine between wo and the normal, and alpha, the roughness of GGX, lie in [1e-8, 1].

// Energy 1 - E_ss that perfectly reflecting facets lose: [MaterialX2026], Energy Compensation.
// Source: tools/fits/ggx_albedo.py. Domain: mu and alpha in [1e-4, 1]. Largest absolute error:
// 4.92e-4.
float ggx_missing(float mu, float alpha)
{
    float z2 = mu / (mu + alpha);
    float z = sqrt(z2);
    float a2 = alpha * alpha;
    float N = 0.12888349 + a2 * 8.7243822
              + z * (1.3273749 + alpha * 0.72818699 + a2 * -16.074653
              + z * (-3.0643081 + alpha * -1.4616543 + a2 * 5.79199
              + z * (1.6080762 + alpha * 0.73190695 + a2 * 1.8295458)));
    float D = 1.0 + a2 * (0.23169737 + alpha * -0.10243737)
              + z * (4.0237192 + alpha * (1.5669072 + a2 * 0.54434563)
              + z * (-12.070429 + alpha * -1.6823962 + a2 * -1.0114147 + z * 7.5515813));
    return z2 * N / D;
}
