// SPDX-License-Identifier: Apache-2.0
// Directional albedo of the Conty-Kulla sheen at full reflectance.

// Source: tools/fits/conty_kulla_albedo.py. Domain: mu and roughness in [1e-4, 1]. Largest absolute error
// of min(E, 1): 1.5e-3.
#define CONTY_KULLA_ALBEDO_N00 0.37829293
#define CONTY_KULLA_ALBEDO_N01 -0.085752877
#define CONTY_KULLA_ALBEDO_N02 0.19338446
#define CONTY_KULLA_ALBEDO_N10 -0.80374927
#define CONTY_KULLA_ALBEDO_N12 -0.47639912
#define CONTY_KULLA_ALBEDO_N20 0.87589422
#define CONTY_KULLA_ALBEDO_N22 0.6840578
#define CONTY_KULLA_ALBEDO_N30 -0.46522672
#define CONTY_KULLA_ALBEDO_N32 -0.47244566
#define CONTY_KULLA_ALBEDO_D01 -0.50989182
#define CONTY_KULLA_ALBEDO_D02 0.29851068
#define CONTY_KULLA_ALBEDO_D03 -0.028911384
#define CONTY_KULLA_ALBEDO_D10 -1.9514937
#define CONTY_KULLA_ALBEDO_D11 0.47005281
#define CONTY_KULLA_ALBEDO_D12 -0.25539595
#define CONTY_KULLA_ALBEDO_D20 1.0250566
#define CONTY_KULLA_ALBEDO_D30 -0.067575435

// min(E, 1) of [MaterialX2026], sheen_bsdf: below a roughness of 0.21 the lobe gains energy at
// grazing.
//   E = exp(-mu^2 / (r (8 - 4 mu^2))) s^2 / (mu + s)^3 N / D,  s = sqrt(r), z = sqrt(mu / (mu + s))
float conty_kulla_albedo_dir(float mu, float roughness)
{
    float s = sqrt(roughness);
    float sum = mu + s;
    float z2 = mu / sum;
    float z = sqrt(z2);
    float mu2 = mu * mu;
    float N0 = CONTY_KULLA_ALBEDO_N00 + s * (CONTY_KULLA_ALBEDO_N01 + s * CONTY_KULLA_ALBEDO_N02);
    float N1 = CONTY_KULLA_ALBEDO_N10 + roughness * CONTY_KULLA_ALBEDO_N12;
    float N2 = CONTY_KULLA_ALBEDO_N20 + roughness * CONTY_KULLA_ALBEDO_N22;
    float N3 = CONTY_KULLA_ALBEDO_N30 + roughness * CONTY_KULLA_ALBEDO_N32;
    float D0 = 1.0 + s * (CONTY_KULLA_ALBEDO_D01
                          + s * (CONTY_KULLA_ALBEDO_D02 + s * CONTY_KULLA_ALBEDO_D03));
    float D1 = CONTY_KULLA_ALBEDO_D10 + s * (CONTY_KULLA_ALBEDO_D11 + s * CONTY_KULLA_ALBEDO_D12);
    float N = N0 + z * (N1 + z * (N2 + z * N3));
    float D = D0 + z * (D1 + z * (CONTY_KULLA_ALBEDO_D20 + z * CONTY_KULLA_ALBEDO_D30));
    float density = exp(-mu2 / (roughness * (8.0 - 4.0 * mu2)));
    return min(density * roughness * N / (sum * sum * sum * D), 1.0);
}
