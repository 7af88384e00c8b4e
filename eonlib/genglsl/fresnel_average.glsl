// SPDX-License-Identifier: Apache-2.0
// Fresnel reflectances and their cosine-weighted averages over the hemisphere, F_ss.

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// 1 - F_ss of a dielectric is t N / D, t = 1 / ior. Source: fits/fresnel_average.py.
// Domain: ior >= 1. Largest absolute error: 5.3e-5.
#define FRESNEL_AVG_N0 5.2782628
#define FRESNEL_AVG_N1 94.973875
#define FRESNEL_AVG_N2 -107.33376
#define FRESNEL_AVG_N3 30.075991
#define FRESNEL_AVG_N4 -7.6046715
#define FRESNEL_AVG_D1 24.314418
#define FRESNEL_AVG_D2 43.891479
#define FRESNEL_AVG_D3 -53.815382

// 1 - F_ss of a metal from three cosines. Source: fits/fresnel_average.py.
// Domain: index in [0.05, 5], extinction in [0.5, 10]. Largest absolute error: 3.6e-4.
#define FRESNEL_AVG_C0 0.22
#define FRESNEL_AVG_W0 0.13509272
#define FRESNEL_AVG_C1 0.58
#define FRESNEL_AVG_W1 0.43804992
#define FRESNEL_AVG_C2 0.9
#define FRESNEL_AVG_W2 0.42364277

// [MaterialX2026], Dielectric Fresnel Equations, from the amplitudes: no quotient of 0 at ior 0.
float fresnel_dielectric(float mu, float ior)
{
    float n2 = ior * ior;
    float g2 = (ior - 1.0) * (ior + 1.0) + mu * mu;  // n^2 + mu^2 - 1 loses mu^2 at grazing
    float g = sqrt(max(g2, 0.0));
    float s = (mu - g) / (mu + g);
    float p = (n2 * mu - g) / (n2 * mu + g);
    return g2 <= 0.0 ? 1.0 : 0.5 * (s * s + p * p);
}

// F_ss of a dielectric; below 1 from the other side, 1 - F_ss(n) = n^2 (1 - F_ss(1 / n)).
float fresnel_dielectric_avg(float ior)
{
    float t = ior > 1.0 ? 1.0 / ior : ior;
    float N = FRESNEL_AVG_N0 + t * (FRESNEL_AVG_N1 + t * (FRESNEL_AVG_N2
              + t * (FRESNEL_AVG_N3 + t * FRESNEL_AVG_N4)));
    float D = 1.0 + t * (FRESNEL_AVG_D1 + t * (FRESNEL_AVG_D2 + t * FRESNEL_AVG_D3));
    float lost = t * N / D;
    return 1.0 - (ior > 1.0 ? lost : ior * ior * lost);
}

// F_ss of Hoffman's generalization of Schlick's curve, in closed form: the mean of (1 - c)^q is
// 2 / ((q + 1) (q + 2)), that of c (1 - c)^6 is 1 / 126.
vec3 fresnel_schlick_avg(vec3 color0, vec3 color90, float exponent, vec3 dip)
{
    return mix(color0, color90, 2.0 / ((exponent + 1.0) * (exponent + 2.0))) - dip / 126.0;
}

// Factor a of c (1 - c)^6 in Hoffman's curve: [MaterialX2026], Generalized Schlick Equations.
vec3 fresnel_schlick_dip(vec3 color0, vec3 color82, vec3 color90, float exponent)
{
    float m = 6.0 / 7.0;
    float m2 = m * m;
    return mix(color0, color90, pow(m, exponent)) * (1.0 - color82) * (7.0 / (m2 * m2 * m2));
}

// F_ss of a metal.
vec3 fresnel_conductor_avg(vec3 ior, vec3 extinction)
{
    return 1.0 - FRESNEL_AVG_W0 * (1.0 - mx_fresnel_conductor(FRESNEL_AVG_C0, ior, extinction))
           - FRESNEL_AVG_W1 * (1.0 - mx_fresnel_conductor(FRESNEL_AVG_C1, ior, extinction))
           - FRESNEL_AVG_W2 * (1.0 - mx_fresnel_conductor(FRESNEL_AVG_C2, ior, extinction));
}
