// SPDX-License-Identifier: Apache-2.0
// Averages of Hoffman's generalization of Schlick's curve: F_ss, weighted by the cosine over the hemisphere, and
// over the visible facets of GGX, by the cosine at which the curve equals it. mu is the cosine of wo with the normal.

// The cosine is mu + alpha^2 / (mu + alpha) N / D, x = mu / (mu + alpha).
// Source: tools/fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1], exponent 1 to 10. Largest absolute
// error of the albedo: 0.0032, at exponent 5 0.0019.
#define SCHLICK_N000 5.211763
#define SCHLICK_N001 42.311725
#define SCHLICK_N002 -10.177434
#define SCHLICK_N003 9.0471791
#define SCHLICK_N010 25.522575
#define SCHLICK_N011 7.80178
#define SCHLICK_N012 -19.109862
#define SCHLICK_N020 -51.576518
#define SCHLICK_N021 -1.9211355
#define SCHLICK_N030 22.933263
#define SCHLICK_N100 -9.6045313
#define SCHLICK_N101 -35.962843
#define SCHLICK_N102 -7.363016
#define SCHLICK_N110 -17.683059
#define SCHLICK_N111 20.252399
#define SCHLICK_N120 -6.4714124
#define SCHLICK_N200 -4.1751567
#define SCHLICK_N201 3.2087931
#define SCHLICK_N210 -18.218307
#define SCHLICK_N300 7.9395461
#define SCHLICK_D001 5.765519
#define SCHLICK_D002 -1.515595
#define SCHLICK_D010 42.67342
#define SCHLICK_D011 -0.008712644
#define SCHLICK_D020 -2.671278
#define SCHLICK_D100 -2.909114
#define SCHLICK_D101 -3.69908
#define SCHLICK_D110 -69.11994
#define SCHLICK_D200 1.541857
#define SCHLICK_D120 -6.01911
#define SCHLICK_D210 28.88318

// Source: tools/fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1]. Largest absolute error of the
// albedo: 0.0059 for a dip from 1 to 0.
#define GGX_DIP_N00 -1.1212709
#define GGX_DIP_N01 0.39603297
#define GGX_DIP_N02 5.6746531
#define GGX_DIP_N03 -8.8707989
#define GGX_DIP_N04 3.8607241
#define GGX_DIP_N10 -30.913482
#define GGX_DIP_N11 60.615644
#define GGX_DIP_N12 -35.65798
#define GGX_DIP_N13 3.7650801
#define GGX_DIP_N20 79.791011
#define GGX_DIP_N21 -126.02159
#define GGX_DIP_N22 53.958886
#define GGX_DIP_N30 -39.917245
#define GGX_DIP_N31 27.287925
#define GGX_DIP_N40 7.2080207
#define GGX_DIP_D01 -0.6779946
#define GGX_DIP_D02 31.30452
#define GGX_DIP_D03 -13.03859
#define GGX_DIP_D10 40.59569
#define GGX_DIP_D11 -261.7102
#define GGX_DIP_D12 996.3608
#define GGX_DIP_D20 110.6571
#define GGX_DIP_D21 -565.9562
#define GGX_DIP_D30 358.4267

// F_ss of Hoffman's generalization of Schlick's curve, in closed form: the mean of (1 - c)^q is
// 2 / ((q + 1) (q + 2)), that of c (1 - c)^6 is 1 / 126.
vec3 eonlib_fresnel_schlick_avg(vec3 color0, vec3 color90, float exponent, vec3 dip)
{
    return mix(color0, color90, 2.0 / ((exponent + 1.0) * (exponent + 2.0))) - dip / 126.0;
}

// Factor a of c (1 - c)^6 in Hoffman's curve: [MaterialX2026], Generalized Schlick Equations.
vec3 eonlib_fresnel_schlick_dip(vec3 color0, vec3 color82, vec3 color90, float exponent)
{
    float m = 6.0 / 7.0;
    float m2 = m * m;
    return mix(color0, color90, pow(m, exponent)) * (1.0 - color82) * (7.0 / (m2 * m2 * m2));
}

// Cosine for (1 - c)^exponent. Exponents are clamped to the domain.
float ggx_cosine_schlick(float mu, float alpha, float exponent)
{
    float x = mu / (mu + alpha);
    float y = sqrt(alpha);
    float s = 4.0 / (3.0 + clamp(exponent, 1.0, 10.0));
    float N = SCHLICK_N000
        + s * (SCHLICK_N001 + s * (SCHLICK_N002 + s * SCHLICK_N003))
        + y * (SCHLICK_N010 + s * (SCHLICK_N011 + s * SCHLICK_N012)
        + y * (SCHLICK_N020 + s * SCHLICK_N021 + y * SCHLICK_N030))
        + x * (SCHLICK_N100 + s * (SCHLICK_N101 + s * SCHLICK_N102)
        + y * (SCHLICK_N110 + s * SCHLICK_N111 + y * SCHLICK_N120)
        + x * (SCHLICK_N200 + s * SCHLICK_N201 + y * SCHLICK_N210
        + x * SCHLICK_N300));
    float D = 1.0 + s * (SCHLICK_D001 + s * SCHLICK_D002)
        + y * (SCHLICK_D010 + s * SCHLICK_D011 + y * SCHLICK_D020)
        + x * (SCHLICK_D100 + s * SCHLICK_D101
        + y * (SCHLICK_D110 + y * SCHLICK_D120)
        + x * (SCHLICK_D200 + y * SCHLICK_D210));
    return clamp(mu + alpha * (1.0 - x) * N / D, 0.0, 1.0);
}

// Average of Hoffman's dip c (1 - c)^6.
float ggx_dip(float mu, float alpha)
{
    float c = ggx_cosine_schlick(mu, alpha, 5.0);
    float m = 1.0 - c;
    float m2 = m * m;
    float y = sqrt(alpha);
    float N = GGX_DIP_N00
        + y * (GGX_DIP_N01 + y * (GGX_DIP_N02 + y * (GGX_DIP_N03 + y * GGX_DIP_N04)))
        + mu * (GGX_DIP_N10 + y * (GGX_DIP_N11 + y * (GGX_DIP_N12 + y * GGX_DIP_N13))
        + mu * (GGX_DIP_N20 + y * (GGX_DIP_N21 + y * GGX_DIP_N22)
        + mu * (GGX_DIP_N30 + y * GGX_DIP_N31
        + mu * GGX_DIP_N40)));
    float D = 1.0 + y * (GGX_DIP_D01 + y * (GGX_DIP_D02 + y * GGX_DIP_D03))
        + mu * (GGX_DIP_D10 + y * (GGX_DIP_D11 + y * GGX_DIP_D12)
        + mu * (GGX_DIP_D20 + y * GGX_DIP_D21
        + mu * GGX_DIP_D30));
    return c * m2 * m2 * m2 + alpha * alpha / (mu + alpha) * N / D;
}
