// SPDX-License-Identifier: Apache-2.0
// Directional albedo of isotropic GGX microfacets with height-correlated Smith shadowing; for anisotropic
// ones see ggx_anisotropic.glsl.
//
// mu is the cosine of wo with the normal, alpha the roughness of GGX. Both lie in [1e-8, 1].

// Source: tools/fits/ggx_albedo.py. Domain: mu and alpha in [1e-4, 1]. Largest absolute error: 4.92e-4.
#define GGX_ALBEDO_N00 0.12888349
#define GGX_ALBEDO_N02 8.7243822
#define GGX_ALBEDO_N10 1.3273749
#define GGX_ALBEDO_N11 0.72818699
#define GGX_ALBEDO_N12 -16.074653
#define GGX_ALBEDO_N20 -3.0643081
#define GGX_ALBEDO_N21 -1.4616543
#define GGX_ALBEDO_N22 5.79199
#define GGX_ALBEDO_N30 1.6080762
#define GGX_ALBEDO_N31 0.73190695
#define GGX_ALBEDO_N32 1.8295458
#define GGX_ALBEDO_D02 0.23169737
#define GGX_ALBEDO_D03 -0.10243737
#define GGX_ALBEDO_D10 4.0237192
#define GGX_ALBEDO_D11 1.5669072
#define GGX_ALBEDO_D13 0.54434563
#define GGX_ALBEDO_D20 -12.070429
#define GGX_ALBEDO_D21 -1.6823962
#define GGX_ALBEDO_D22 -1.0114147
#define GGX_ALBEDO_D30 7.5515813

// 1 - E_ss of [MaterialX2026], Energy Compensation, the energy lost by perfectly reflecting facets:
//   1 - E_ss = z^2 N / D,  z = sqrt(mu / (mu + alpha))
float ggx_missing(float mu, float alpha)
{
    float z2 = mu / (mu + alpha);
    float z = sqrt(z2);
    float a2 = alpha * alpha;
    float N = GGX_ALBEDO_N00 + a2 * GGX_ALBEDO_N02
              + z * (GGX_ALBEDO_N10 + alpha * GGX_ALBEDO_N11 + a2 * GGX_ALBEDO_N12
              + z * (GGX_ALBEDO_N20 + alpha * GGX_ALBEDO_N21 + a2 * GGX_ALBEDO_N22
              + z * (GGX_ALBEDO_N30 + alpha * GGX_ALBEDO_N31 + a2 * GGX_ALBEDO_N32)));
    float D = 1.0 + a2 * (GGX_ALBEDO_D02 + alpha * GGX_ALBEDO_D03)
              + z * (GGX_ALBEDO_D10 + alpha * (GGX_ALBEDO_D11 + a2 * GGX_ALBEDO_D13)
              + z * (GGX_ALBEDO_D20 + alpha * GGX_ALBEDO_D21 + a2 * GGX_ALBEDO_D22
              + z * GGX_ALBEDO_D30));
    return z2 * N / D;
}

float ggx_albedo_dir(float mu, float alpha)
{
    return 1.0 - ggx_missing(mu, alpha);
}
