// SPDX-License-Identifier: Apache-2.0
// Fresnel reflectance of a dielectric; F_ss, its cosine-weighted average over the hemisphere; and its average over the
// visible facets of GGX. mu is the cosine of wo with the normal.

// [MaterialX2026], Dielectric Fresnel Equations, from the amplitudes: no quotient of 0 at ior 0.
float eonlib_fresnel_dielectric(float mu, float ior)
{
    float n2 = ior * ior;
    float g2 = (ior - 1.0) * (ior + 1.0) + mu * mu;  // n^2 + mu^2 - 1 loses mu^2 at grazing
    float g = sqrt(max(g2, 0.0));
    float s = (mu - g) / (mu + g);
    float p = (n2 * mu - g) / (n2 * mu + g);
    return g2 <= 0.0 ? 1.0 : 0.5 * (s * s + p * p);
}

// F_ss of a dielectric: 1 - F_ss is t N / D, t = 1 / ior; for an index below 1 from the other side,
// 1 - F_ss(n) = n^2 (1 - F_ss(1 / n)). Source: tools/fits/fresnel_average.py. Largest absolute error: 5.3e-5.
float eonlib_fresnel_dielectric_avg(float ior)
{
    float t = ior > 1.0 ? 1.0 / ior : ior;
    float N = 5.2782628 + t * (94.973875 + t * (-107.33376 + t * (30.075991 + t * -7.6046715)));
    float D = 1.0 + t * (24.314418 + t * (43.891479 + t * -53.815382));
    float lost = t * N / D;
    return 1.0 - (ior > 1.0 ? lost : ior * ior * lost);
}

// The cosine at which the curve equals its average over the visible facets: mu + alpha^2 / (mu + alpha) N / D. Indices
// are clamped to the domain.
// Source: tools/fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1], index of refraction in [1.03, 3].
// Largest absolute error of the albedo: 0.003, in [1.05, 2.5] 0.0017.
float ggx_cosine_dielectric(float mu, float alpha, float ior)
{
    float n = clamp(ior, 1.03, 3.0);
    float x = mu / (mu + alpha);
    float y = sqrt(sqrt(alpha));
    float s = sqrt((n - 1.0) / (n + 1.0));
    float N = 121.31539
        + s * (695.29722 + s * (-852.70243 + s * 0.95958787))
        + y * (-79.111812 + s * (-404.20459 + s * 719.38075)
        + y * (-87.272915 + s * -153.03073 + y * 79.441552))
        + x * (-107.09138 + s * (-328.78907 + s * 356.88066)
        + y * (-2.5500696 + s * -40.596539 + y * 68.03638)
        + x * (10.033399 + s * 16.886608 + y * -50.014696 + x * -7.2080572));
    float D = 1.0 + s * (57.90553 + s * -67.41115)
        + y * (181.8611 + s * -7.478896 + y * -50.38694)
        + x * (3.325208 + s * 0.0942464 + y * (-261.2011 + y * -6.590822) + x * (-4.144666 + y * 107.1744));
    return clamp(mu + alpha * (1.0 - x) * N / D, 0.0, 1.0);
}

// Light that passes to the less dense side (index below 1): the mean of 1 - F over the visible facets; reversed (1), the
// share by reversed paths from that side. tau, the cotangent of the angle to a facet, is tau_c at the critical angle and
// tau_m near the median:
//   share below the critical angle: t^-p, t = 1 + exp(g asinh(k ln(tau_c^2 / tau_m^2)))
//   their reflectance: F(tau), with 0.7213 of them above tau: 1 / 0.7213 = exp(0.326707)
// Source and derivation: tools/fits/ggx_inside.py.
// Domain: mu and alpha in [1e-4, 1], index in [0.33, 0.98]. Largest absolute error of the albedo: 2.8e-2; reversed, from
// mu 0.01 on: 3.6e-2.
float eonlib_dielectric_passing(float mu, float alpha, float ior, float reversed)
{
    float s2 = 1.0 - mu * mu;
    float alpha2 = alpha * alpha;
    float x = mu / (mu + alpha);
    float y = sqrt(alpha);
    float z = sqrt(s2) / (sqrt(s2) + alpha);
    vec3 a_b_k0 = exp(mix(vec3(0.57832, 3.8455, -12.129), vec3(-25.163, -5.6857, -9.8286), reversed)
                      + x * mix(vec3(-1.0501, -0.97191, -2.2817), vec3(-3.263, 5.8209, 12.063), reversed)
                      + z * mix(vec3(0.58237, -0.54814, 10.885), vec3(19.954, 0.9032, -6.3576), reversed)
                      + y * (mix(vec3(-0.1491, -2.3176, -1.0809), vec3(12.468, 5.6708, 12.907), reversed)
                             + x * mix(vec3(1.1587, -1.5649, 7.7815), vec3(13.305, -6.5546, -25.022), reversed)));
    vec3 k1_p_g = exp(mix(vec3(-11.175, -1.1887, 6.9511), vec3(-10.586, 0.98278, 9.0803), reversed)
                      + x * mix(vec3(-2.49, -0.20226, 0.41509), vec3(14.551, 0.10551, -8.7017), reversed)
                      + z * mix(vec3(11.808, 1.1983, -6.4646), vec3(-4.3803, -1.3063, 0.023203), reversed)
                      + y * (mix(vec3(-2.918, -0.0033244, 0.40729), vec3(14.04, -1.3351, -7.8286), reversed)
                             + x * mix(vec3(7.0708, -0.19455, -2.4622), vec3(-22.556, 1.1153, 9.5757), reversed)));
    float median2 = (mu * mu + a_b_k0.x * alpha2) / (s2 + a_b_k0.y * alpha2);
    float k = sqrt(a_b_k0.z + k1_p_g.x * mu * mu * s2 / alpha2);
    float t = k * log((1.0 - ior * ior) / max(ior * ior * median2, 1e-30));  // k ln(tau_c^2 / tau_m^2)
    t = 1.0 + exp(min(k1_p_g.z * sign(t) * log(abs(t) + sqrt(t * t + 1.0)), 60.0));  // HLSL has no asinh
    float typical = sinh(log(t * exp(0.326707 / k1_p_g.y) - 1.0) / k1_p_g.z) / k;  // ln(tau^2 / tau_m^2)
    return (1.0 - eonlib_fresnel_dielectric(1.0 / sqrt(1.0 + exp(-typical) / median2), ior)) / pow(t, k1_p_g.y);
}

// Average over the visible facets. Near index 1 the curve only depends on the cosine over sqrt(n^2 - 1): an index below
// 1.03 uses the average of 1.03 at k mu and k alpha, at most 1. If k mu exceeds 1, the cosine grows with mu.
// Largest absolute error of the albedo below index 1.03, where k alpha exceeds 1: 9.3e-3.
float eonlib_fresnel_dielectric_visible(float mu, float alpha, float ior)
{
    if (ior < 1.0)
    {
        return 1.0 - eonlib_dielectric_passing(mu, alpha, ior, 0.0);
    }
    float k = sqrt(max(0.0609 / max((ior - 1.0) * (ior + 1.0), 1e-9), 1.0));
    return eonlib_fresnel_dielectric(
        ggx_cosine_dielectric(min(k * mu, 1.0), min(k * alpha, 1.0), ior) * max(mu, 1.0 / k), ior);
}
