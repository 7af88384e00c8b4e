// SPDX-License-Identifier: Apache-2.0
// Fresnel reflectance F of a dielectric, and its averages over the hemisphere (F_ss,
// cosine-weighted) and over the GGX facets visible from wo. mu is dot(wo, N).

// Reflectance F: [MaterialX2026], Dielectric Fresnel Equations. Squared amplitudes avoid 0 / 0 at
// ior 0.
float eonlib_fresnel_dielectric(float mu, float ior)
{
    float n2 = ior * ior;
    float g2 = (ior - 1.0) * (ior + 1.0) + mu * mu;  // n^2 + mu^2 - 1 would lose mu^2 at grazing
    float g = sqrt(max(g2, 0.0));
    float s = (mu - g) / (mu + g);
    float p = (n2 * mu - g) / (n2 * mu + g);
    return g2 <= 0.0 ? 1.0 : 0.5 * (s * s + p * p);
}

// Average F_ss. Source: tools/fits/fresnel_average.py. Largest absolute error: 5.3e-5.
float eonlib_fresnel_dielectric_avg(float ior)
{
    float t = ior > 1.0 ? 1.0 / ior : ior;
    float N = 5.2782628 + t * (94.973875 + t * (-107.33376 + t * (30.075991 + t * -7.6046715)));
    float D = 1.0 + t * (24.314418 + t * (43.891479 + t * -53.815382));
    float lost = t * N / D;
    return 1.0 - (ior > 1.0 ? lost : ior * ior * lost);
}

// Cosine at which F equals its average over visible facets. The ior is clamped to the domain.
// Source: tools/fits/ggx_cosine.py. Domain: mu and alpha in [1e-4, 1], ior in [1.03, 3]. Largest
// absolute error of the albedo: 0.003, or 0.0017 for ior in [1.05, 2.5].
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

// Fractions of light that facets transmit if ior < 1. x is the average of 1 - F over visible
// facets. y is the average for reversed paths, without light that facets reflect back. Source and
// derivation: tools/fits/ggx_inside.py. Domain: mu and alpha in [1e-4, 1], ior in [0.33, 0.98].
// Largest absolute errors: 2.8e-2 of an albedo computed by x, 3.4e-2 of y.
vec2 eonlib_dielectric_passing(float mu, float alpha, float ior)
{
    float mu2 = mu * mu;
    float s2 = 1.0 - mu2;
    float alpha2 = alpha * alpha;
    float bent = 1.0 - ior * ior;
    float x = mu / (mu + alpha);
    float y = sqrt(alpha);
    float z = sqrt(s2) / (sqrt(s2) + alpha);
    float muy = mu * y;
    float xy = x * y;
    float zy = z * y;
    vec2 a = vec2(2.4147 + 0.3797 * muy, exp(-3.79563 + 6.57486 * zy + 3.15967 * xy));
    vec2 b = vec2(1.3886 + 2.8723 * mu - 0.7683 * ior - 5.2357 * xy, 0.2895 + 1.23639 * muy);
    vec2 k2 = vec2(0.5612 - 0.4144 * z + 0.5352 * muy, 0.34195) + vec2(0.374, 0.32674) * (mu2 * s2 / alpha2);
    vec2 part = vec2(0.609 + 0.7028 * zy, 0.50203);
    vec2 power = vec2(0.8025 - 0.3416 * muy, 0.52381 + 0.43633 * x);
    float risen = exp(1.80744 + 0.85484 * ior - 3.06595 * alpha - 3.09838 * x) * alpha * bent / mu;

    // r2 is the square of tau_m / tau_c in tools/fits/ggx_inside.py. Without clamps, r2 and the
    // divisor of p would be 0 at ior 0, and the square of v would overflow above 1e19.
    vec2 r2 = max((1.0 - bent) * (mu2 + a * alpha2) / (bent * (s2 + b * alpha2)), 1e-30);
    vec2 e2 = k2 / r2;
    vec2 v = clamp((r2 - 1.0) * sqrt(e2), -1e6, 1e6);
    vec2 h = sqrt(1.0 + v * v);
    vec2 tail = 0.5 / (h * (h + abs(v)));
    vec2 S = mix(tail, 1.0 - tail, step(vec2(0.0), v));
    vec2 Q = part * S;
    vec2 q = 4.0 * Q * (1.0 - Q);
    vec2 t = sqrt(1.0 + (4.0 * k2 - 1.0) * q) + 1.0 - 2.0 * Q;
    vec2 g = ior * sqrt(max(1.0 - 4.0 * e2 * q / (t * t), 0.0));  // sqrt(n^2 - 1 + c^2) / c
    vec2 s = 1.0 / (1.0 + g);
    vec2 p = ior / max(ior * ior + g, 1e-30);
    // Rounding may make 1 - F exceed 1.
    return min(pow(S, power) * 2.0 * g * (s * s + p * p), 1.0) / vec2(1.0, 1.0 + risen);
}

// Average of F over visible facets if ior >= 1. Near ior 1, F depends only on the cosine divided by
// sqrt(ior^2 - 1). So below ior 1.03, the fit for ior 1.03 is evaluated at k mu and k alpha, each
// at most 1, where k is sqrt(1.03^2 - 1) / sqrt(ior^2 - 1). The resulting cosine is divided by k,
// or multiplied by mu if k mu > 1. Largest absolute error of the albedo if k alpha > 1: 9.3e-3.
float eonlib_fresnel_dielectric_visible(float mu, float alpha, float ior)
{
    float k = sqrt(max(0.0609 / max((ior - 1.0) * (ior + 1.0), 1e-9), 1.0));
    return eonlib_fresnel_dielectric(
        ggx_cosine_dielectric(min(k * mu, 1.0), min(k * alpha, 1.0), ior) * max(mu, 1.0 / k), ior);
}
