// SPDX-License-Identifier: Apache-2.0
// Averages of Fresnel curves over the visible facets of GGX, by the cosine at which each curve has
// its average. mu is the cosine of wo with the normal, alpha the roughness.
//
//   c = mu + alpha^2 / (mu + alpha) N / D,  x = mu / (mu + alpha)

// Source: fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1], index of refraction in [1.03, 3].
// Largest absolute error of the albedo: 3e-3, in [1.05, 2.5] 1.7e-3.
#define GGX_DIELECTRIC_N000 118.94605
#define GGX_DIELECTRIC_N001 696.51851
#define GGX_DIELECTRIC_N002 -850.97494
#define GGX_DIELECTRIC_N003 0.29444766
#define GGX_DIELECTRIC_N010 -69.352129
#define GGX_DIELECTRIC_N011 -408.3952
#define GGX_DIELECTRIC_N012 717.36557
#define GGX_DIELECTRIC_N020 -100.20088
#define GGX_DIELECTRIC_N021 -149.66491
#define GGX_DIELECTRIC_N030 84.993967
#define GGX_DIELECTRIC_N100 -101.2718
#define GGX_DIELECTRIC_N101 -333.98074
#define GGX_DIELECTRIC_N102 355.58144
#define GGX_DIELECTRIC_N110 -15.012712
#define GGX_DIELECTRIC_N111 -30.768657
#define GGX_DIELECTRIC_N120 71.489287
#define GGX_DIELECTRIC_N200 5.6983261
#define GGX_DIELECTRIC_N201 19.280812
#define GGX_DIELECTRIC_N210 -43.963699
#define GGX_DIELECTRIC_N300 -7.1696364
#define GGX_DIELECTRIC_D001 57.90553
#define GGX_DIELECTRIC_D002 -67.41115
#define GGX_DIELECTRIC_D010 181.8611
#define GGX_DIELECTRIC_D011 -7.478896
#define GGX_DIELECTRIC_D020 -50.38694
#define GGX_DIELECTRIC_D100 3.325208
#define GGX_DIELECTRIC_D101 0.0942464
#define GGX_DIELECTRIC_D110 -261.2011
#define GGX_DIELECTRIC_D200 -4.144666
#define GGX_DIELECTRIC_D120 -6.590822
#define GGX_DIELECTRIC_D210 107.1744

// Source: fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1], exponent 1 to 10. Largest absolute
// error of the albedo: 3.2e-3, at exponent 5 1.7e-3.
#define GGX_SCHLICK_N000 6.886951
#define GGX_SCHLICK_N001 72.20287
#define GGX_SCHLICK_N002 -17.02765
#define GGX_SCHLICK_N003 17.39619
#define GGX_SCHLICK_N010 49.42339
#define GGX_SCHLICK_N011 16.88316
#define GGX_SCHLICK_N012 -36.46048
#define GGX_SCHLICK_N020 -94.37639
#define GGX_SCHLICK_N021 -2.833864
#define GGX_SCHLICK_N030 41.28118
#define GGX_SCHLICK_N100 -10.44367
#define GGX_SCHLICK_N101 -58.17345
#define GGX_SCHLICK_N102 -10.35283
#define GGX_SCHLICK_N110 -35.54946
#define GGX_SCHLICK_N111 29.46729
#define GGX_SCHLICK_N120 -10.92889
#define GGX_SCHLICK_N200 -3.9405
#define GGX_SCHLICK_N201 -2.28018
#define GGX_SCHLICK_N210 -35.77534
#define GGX_SCHLICK_N300 7.950184
#define GGX_SCHLICK_D001 10.1126
#define GGX_SCHLICK_D002 -1.970135
#define GGX_SCHLICK_D010 72.88341
#define GGX_SCHLICK_D011 0.6907697
#define GGX_SCHLICK_D020 -2.319482
#define GGX_SCHLICK_D100 -2.104292
#define GGX_SCHLICK_D101 -7.543936
#define GGX_SCHLICK_D110 -112.0349
#define GGX_SCHLICK_D200 0.7941591
#define GGX_SCHLICK_D120 -16.24471
#define GGX_SCHLICK_D210 43.33361

// Source: fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1]. Largest absolute error of the
// albedo: 4.3e-3 for a dip from 1 to 0.
#define GGX_DIP_N00 -1.20679
#define GGX_DIP_N01 -5.233047
#define GGX_DIP_N02 1.996696
#define GGX_DIP_N03 -1.026089
#define GGX_DIP_N10 -36.85618
#define GGX_DIP_N11 36.02124
#define GGX_DIP_N12 2.386277
#define GGX_DIP_N20 104.768
#define GGX_DIP_N21 -61.12429
#define GGX_DIP_N30 -57.03399
#define GGX_DIP_D01 45.65231
#define GGX_DIP_D02 212.3247
#define GGX_DIP_D03 1196.218
#define GGX_DIP_D10 36.30322
#define GGX_DIP_D11 47.03659
#define GGX_DIP_D12 7209.172
#define GGX_DIP_D20 20.68808
#define GGX_DIP_D21 -413.8458
#define GGX_DIP_D30 430.6794

// Cosine for a dielectric. Indices beyond the domain have that of its end, and indices below 1 that
// of the other side of the interface.
float ggx_cosine_dielectric(float mu, float alpha, float ior)
{
    float n = clamp(max(ior, 1.0 / max(ior, 0.1)), 1.03, 3.0);
    float x = mu / (mu + alpha);
    float y = sqrt(sqrt(alpha));
    float s = sqrt((n - 1.0) / (n + 1.0));
    float N0 = GGX_DIELECTRIC_N000
               + s * (GGX_DIELECTRIC_N001 + s * (GGX_DIELECTRIC_N002 + s * GGX_DIELECTRIC_N003))
               + y * (GGX_DIELECTRIC_N010 + s * (GGX_DIELECTRIC_N011 + s * GGX_DIELECTRIC_N012) + y * (GGX_DIELECTRIC_N020 + s * GGX_DIELECTRIC_N021 + y * GGX_DIELECTRIC_N030));
    float N1 = GGX_DIELECTRIC_N100 + s * (GGX_DIELECTRIC_N101 + s * GGX_DIELECTRIC_N102)
               + y * (GGX_DIELECTRIC_N110 + s * GGX_DIELECTRIC_N111 + y * GGX_DIELECTRIC_N120);
    float N2 = GGX_DIELECTRIC_N200 + s * GGX_DIELECTRIC_N201 + y * GGX_DIELECTRIC_N210;
    float N = N0 + x * (N1 + x * (N2 + x * GGX_DIELECTRIC_N300));
    float D0 = 1.0 + s * (GGX_DIELECTRIC_D001 + s * GGX_DIELECTRIC_D002)
               + y * (GGX_DIELECTRIC_D010 + s * GGX_DIELECTRIC_D011 + y * GGX_DIELECTRIC_D020);
    float D1 = GGX_DIELECTRIC_D100 + s * GGX_DIELECTRIC_D101
               + y * (GGX_DIELECTRIC_D110 + y * GGX_DIELECTRIC_D120);
    float D2 = GGX_DIELECTRIC_D200 + y * GGX_DIELECTRIC_D210;
    float D = D0 + x * (D1 + x * D2);
    return clamp(mu + alpha * (1.0 - x) * N / D, 0.0, 1.0);
}

// Cosine for (1 - c)^exponent. Exponents beyond the domain have that of its end.
float ggx_cosine_schlick(float mu, float alpha, float exponent)
{
    float x = mu / (mu + alpha);
    float y = sqrt(alpha);
    float s = 4.0 / (3.0 + clamp(exponent, 1.0, 10.0));
    float N0 = GGX_SCHLICK_N000
               + s * (GGX_SCHLICK_N001 + s * (GGX_SCHLICK_N002 + s * GGX_SCHLICK_N003))
               + y * (GGX_SCHLICK_N010 + s * (GGX_SCHLICK_N011 + s * GGX_SCHLICK_N012) + y * (GGX_SCHLICK_N020 + s * GGX_SCHLICK_N021 + y * GGX_SCHLICK_N030));
    float N1 = GGX_SCHLICK_N100 + s * (GGX_SCHLICK_N101 + s * GGX_SCHLICK_N102)
               + y * (GGX_SCHLICK_N110 + s * GGX_SCHLICK_N111 + y * GGX_SCHLICK_N120);
    float N2 = GGX_SCHLICK_N200 + s * GGX_SCHLICK_N201 + y * GGX_SCHLICK_N210;
    float N = N0 + x * (N1 + x * (N2 + x * GGX_SCHLICK_N300));
    float D0 = 1.0 + s * (GGX_SCHLICK_D001 + s * GGX_SCHLICK_D002)
               + y * (GGX_SCHLICK_D010 + s * GGX_SCHLICK_D011 + y * GGX_SCHLICK_D020);
    float D1 = GGX_SCHLICK_D100 + s * GGX_SCHLICK_D101
               + y * (GGX_SCHLICK_D110 + y * GGX_SCHLICK_D120);
    float D2 = GGX_SCHLICK_D200 + y * GGX_SCHLICK_D210;
    float D = D0 + x * (D1 + x * D2);
    return clamp(mu + alpha * (1.0 - x) * N / D, 0.0, 1.0);
}

// Average of Hoffman's dip c (1 - c)^6.
float ggx_dip(float mu, float alpha)
{
    float c = ggx_cosine_schlick(mu, alpha, 5.0);
    float m = 1.0 - c;
    float m2 = m * m;
    float N0 = GGX_DIP_N00 + alpha * (GGX_DIP_N01 + alpha * (GGX_DIP_N02 + alpha * GGX_DIP_N03));
    float N1 = GGX_DIP_N10 + alpha * (GGX_DIP_N11 + alpha * GGX_DIP_N12);
    float N2 = GGX_DIP_N20 + alpha * GGX_DIP_N21;
    float N = N0 + mu * (N1 + mu * (N2 + mu * GGX_DIP_N30));
    float D0 = 1.0 + alpha * (GGX_DIP_D01 + alpha * (GGX_DIP_D02 + alpha * GGX_DIP_D03));
    float D1 = GGX_DIP_D10 + alpha * (GGX_DIP_D11 + alpha * GGX_DIP_D12);
    float D2 = GGX_DIP_D20 + alpha * GGX_DIP_D21;
    float D = D0 + mu * (D1 + mu * (D2 + mu * GGX_DIP_D30));
    return c * m2 * m2 * m2 + alpha * alpha / (mu + alpha) * N / D;
}
