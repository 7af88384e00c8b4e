// SPDX-License-Identifier: Apache-2.0
// Averages of Hoffman's generalized Schlick curve over the hemisphere (F_ss, cosine-weighted) and
// over the GGX facets visible from wo. mu is dot(wo, N).

// F_ss in closed form. The average of (1 - c)^q is 2 / ((q + 1) (q + 2)), and the average of the
// dip c (1 - c)^6 is 1 / 126.
vec3 eonlib_fresnel_schlick_avg(vec3 color0, vec3 color90, float exponent, vec3 dip)
{
    return mix(color0, color90, 2.0 / ((exponent + 1.0) * (exponent + 2.0))) - dip / 126.0;
}

// Factor of the dip c (1 - c)^6 in Hoffman's curve: [MaterialX2026], Generalized Schlick Equations.
vec3 eonlib_fresnel_schlick_dip(vec3 color0, vec3 color82, vec3 color90, float exponent)
{
    float m = 6.0 / 7.0;
    float m2 = m * m;
    return mix(color0, color90, pow(m, exponent)) * (1.0 - color82) * (7.0 / (m2 * m2 * m2));
}

// Cosine at which (1 - c)^exponent equals its average over visible facets. The exponent is clamped
// to the domain. Source: tools/fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1], exponent 1 to
// 10. Largest absolute error of the albedo: 0.0032, or 0.0019 at exponent 5.
float ggx_cosine_schlick(float mu, float alpha, float exponent)
{
    float x = mu / (mu + alpha);
    float y = sqrt(alpha);
    float s = 4.0 / (3.0 + clamp(exponent, 1.0, 10.0));
    float N = 5.211763
        + s * (42.311725 + s * (-10.177434 + s * 9.0471791))
        + y * (25.522575 + s * (7.80178 + s * -19.109862)
        + y * (-51.576518 + s * -1.9211355 + y * 22.933263))
        + x * (-9.6045313 + s * (-35.962843 + s * -7.363016)
        + y * (-17.683059 + s * 20.252399 + y * -6.4714124)
        + x * (-4.1751567 + s * 3.2087931 + y * -18.218307 + x * 7.9395461));
    float D = 1.0 + s * (5.765519 + s * -1.515595)
        + y * (42.67342 + s * -0.008712644 + y * -2.671278)
        + x * (-2.909114 + s * -3.69908 + y * (-69.11994 + y * -6.01911) + x * (1.541857 + y * 28.88318));
    return clamp(mu + alpha * (1.0 - x) * N / D, 0.0, 1.0);
}

// Average of Hoffman's dip c (1 - c)^6 over visible facets. Source: tools/fits/ggx_cosine.py.
// Domain: mu and alpha in [1e-4, 1]. Largest absolute error of the albedo: 0.0059 if the curve dips
// from 1 to 0.
float ggx_dip(float mu, float alpha)
{
    float c = ggx_cosine_schlick(mu, alpha, 5.0);
    float m = 1.0 - c;
    float m2 = m * m;
    float y = sqrt(alpha);
    float N = -1.1212709
        + y * (0.39603297 + y * (5.6746531 + y * (-8.8707989 + y * 3.8607241)))
        + mu * (-30.913482 + y * (60.615644 + y * (-35.65798 + y * 3.7650801))
        + mu * (79.791011 + y * (-126.02159 + y * 53.958886)
        + mu * (-39.917245 + y * 27.287925 + mu * 7.2080207)));
    float D = 1.0 + y * (-0.6779946 + y * (31.30452 + y * -13.03859))
        + mu * (40.59569 + y * (-261.7102 + y * 996.3608)
        + mu * (110.6571 + y * -565.9562 + mu * 358.4267));
    return c * m2 * m2 * m2 + alpha * alpha / (mu + alpha) * N / D;
}
