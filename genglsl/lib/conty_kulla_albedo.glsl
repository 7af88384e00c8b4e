// SPDX-License-Identifier: Apache-2.0
// Directional albedo of the Conty-Kulla sheen with color 1.

// Albedo of [MaterialX2026], sheen_bsdf, clamped to 1, since the model exceeds 1 at grazing for
// roughness below 0.21. Source: tools/fits/conty_kulla_albedo.py. Domain: mu and roughness in
// [1e-4, 1]. Largest absolute error: 1.5e-3.
float conty_kulla_albedo_dir(float mu, float roughness)
{
    float s = sqrt(roughness);
    float sum = mu + s;
    float z2 = mu / sum;
    float z = sqrt(z2);
    float mu2 = mu * mu;
    float N0 = 0.37829293 + s * (-0.085752877 + s * 0.19338446);
    float N1 = -0.80374927 + roughness * -0.47639912;
    float N2 = 0.87589422 + roughness * 0.6840578;
    float N3 = -0.46522672 + roughness * -0.47244566;
    float D0 = 1.0 + s * (-0.50989182 + s * (0.29851068 + s * -0.028911384));
    float D1 = -1.9514937 + s * (0.47005281 + s * -0.25539595);
    float N = N0 + z * (N1 + z * (N2 + z * N3));
    float D = D0 + z * (D1 + z * (1.0250566 + z * -0.067575435));
    float density = exp(-mu2 / (roughness * (8.0 - 4.0 * mu2)));
    return min(density * roughness * N / (sum * sum * sum * D), 1.0);
}
