// SPDX-License-Identifier: Apache-2.0
// F_airy of [MaterialX2026], Thin-Film Iridescence Model: what vacuum, a film and a substrate reflect together,
// in linear Rec. 709. Comments name the section of each equation. Each color channel has its own substrate and
// its own sum over CIE XYZ. Amplitudes are complex, z = r_21 r_23, so no phase comes from an arctangent: the
// text's r_123^m cos(mu_k phi m + m (phi_21 + phi_23)) is the real part of z^m exp(i mu_k phi m). All orders
// count that are not negligible. A mean over cosines around mu is the same with waves that fade.

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// mu_k and sigma_k^2 of X, X, Y and Z, in 1/m and 1/m^2: Spectral Sensitivity. The first fades least.
#define THIN_FILM_POSITIONS vec4(1.6810e6, 2.2399e6, 1.7953e6, 2.2084e6)
#define THIN_FILM_VARIANCES vec4(4.3278e9, 4.5282e9, 9.3046e9, 6.6121e9)

// Their heights v_k sqrt(2 pi sigma_k^2) / 1.0685e-7 times the matrix from XYZ under white E to Rec. 709,
// `XYZ_TO_REC709_E` of mxeon.models.core.colorimetry: a film that vanishes leaves white alone.
#define THIN_FILM_RED vec4(2.663585, 0.4841083, -1.666494, -0.480666)
#define THIN_FILM_GREEN vec4(-0.84281, -0.1531813, 1.956197, 0.03981614)
#define THIN_FILM_BLUE vec4(0.05384126, 0.009785686, -0.2146441, 1.152291)

// Divisors that vanish: a root of 0, and full reflection at grazing.
#define THIN_FILM_LEAST 1e-12

// Orders are summed while the square of one exceeds the first number times the squared mean reflectances, or
// the second times the squared width. Each counts as smaller than the one before it by the third at least.
// Source: tools/fits/thin_film.py. Largest relative error of a film that reflects 1e-3 or more: 8e-4.
#define THIN_FILM_ORDER_VALUE 2e-14
#define THIN_FILM_ORDER_WIDTH 1e-3
#define THIN_FILM_ORDER_RATIO 0.6

// A complex number for each channel.
struct ThinFilmComplex
{
    vec3 re;
    vec3 im;
};

// One polarization: R_12 + R_dc, C_0, and z.
struct ThinFilmWave
{
    vec3 mean;
    vec3 C0;
    ThinFilmComplex z;
};

ThinFilmComplex thin_film_product(ThinFilmComplex a, ThinFilmComplex b)
{
    return ThinFilmComplex(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}

// (a - b) / (a + b)
ThinFilmComplex thin_film_amplitude(ThinFilmComplex a, ThinFilmComplex b)
{
    vec3 re = a.re + b.re;
    vec3 im = a.im + b.im;
    vec3 inverse = 1.0 / max(re * re + im * im, THIN_FILM_LEAST);
    return ThinFilmComplex((a.re * a.re + a.im * a.im - b.re * b.re - b.im * b.im) * inverse,
                           2.0 * (a.im * b.re - a.re * b.im) * inverse);
}

// U + i V of Second Interface Phase, the root of (eta_3 + i kappa_3)^2 - sin^2(theta). The smaller part is a
// quotient, since as a difference it cancels.
ThinFilmComplex thin_film_root(vec3 ior, vec3 extinction, float sin2)
{
    vec3 A = ior * ior - extinction * extinction - sin2;
    vec3 Q = ior * extinction;
    vec3 larger = sqrt(0.5 * (sqrt(A * A + 4.0 * Q * Q) + abs(A)));
    vec3 smaller = Q / max(larger, THIN_FILM_LEAST);
    vec3 positive = step(vec3(0.0), A);
    return ThinFilmComplex(mix(smaller, larger, positive), mix(larger, smaller, positive));
}

// Second Interface: r_23 of both polarizations, below a film of index n, at a cosine mu_t in it.
void thin_film_substrate(float n, float mu_t, float sin2, FresnelData fd, out ThinFilmComplex s,
                         out ThinFilmComplex p)
{
    vec3 zero = vec3(0.0);
    if (fd.model == FRESNEL_MODEL_SCHLICK)
    {
        // The phase is pi below a denser film. A negative curve has no amplitude.
        vec3 r = sqrt(max(mx_fresnel_hoffman_schlick(mu_t, fd), 0.0));
        vec3 least = vec3((n - 1.0) / (n + 1.0)); // as a root: its square rounds above an F0 of the same index
        p = ThinFilmComplex(r * (2.0 * step(least, sqrt(max(fd.F0, 0.0))) - 1.0), zero);
        s = ThinFilmComplex(-p.re, zero);
    }
    else
    {
        vec3 n2 = fd.ior * fd.ior - fd.extinction * fd.extinction;
        vec3 k2 = 2.0 * fd.ior * fd.extinction;
        ThinFilmComplex root = thin_film_root(fd.ior, fd.extinction, sin2);
        s = thin_film_amplitude(ThinFilmComplex(vec3(n * mu_t), zero), root);
        p = thin_film_amplitude(ThinFilmComplex(n2 * mu_t, k2 * mu_t),
                                ThinFilmComplex(n * root.re, n * root.im));
    }
}

// Airy Summation, DC term. C_0 = R_dc - T_12 is written as a product, in which nothing cancels.
ThinFilmWave thin_film_wave(float r21, ThinFilmComplex r23)
{
    float R12 = r21 * r21;
    float T12 = 1.0 - R12;
    vec3 R23 = r23.re * r23.re + r23.im * r23.im;
    vec3 passed = T12 / max(1.0 - R12 * R23, THIN_FILM_LEAST);
    return ThinFilmWave(R12 + T12 * passed * R23, -passed * (1.0 - R23),
                        ThinFilmComplex(r21 * r23.re, r21 * r23.im));
}

// Color Conversion: red, green and blue of what X, X, Y and Z respond with.
vec3 thin_film_color(vec4 response)
{
    return vec3(dot(THIN_FILM_RED, response), dot(THIN_FILM_GREEN, response),
                dot(THIN_FILM_BLUE, response));
}

// Airy Summation, higher-order terms: half the sum of C_m S_m of both polarizations. Each sensitivity has S_m =
// k^(m^2) exp(i mu_k phi m), k = exp(-sigma_k^2 phi^2), so S_(m + 1) = S_m k^(2 m) S_1. `spread` is what phi
// varies by in a mean: few waves are left to the other nodes, many fade.
vec3 thin_film_orders(ThinFilmWave s, ThinFilmWave p, float phi, float spread, float limit, bool is_real)
{
    vec4 waves = THIN_FILM_POSITIONS * spread;
    vec4 waves2 = waves * waves;
    vec4 k = exp(-THIN_FILM_VARIANCES * (phi * phi) - 0.25 * waves2 * waves2);
    vec4 k2 = k * k;
    vec4 S_re = k * mx_cos(THIN_FILM_POSITIONS * phi);
    vec4 S_im = k * mx_sin(THIN_FILM_POSITIONS * phi);
    vec4 ratio_re = k2 * S_re;
    vec4 ratio_im = k2 * S_im;

    // Squares of the largest order, and of its ratio to the next.
    vec3 R_s = s.z.re * s.z.re + s.z.im * s.z.im;
    vec3 R_p = p.z.re * p.z.re + p.z.im * p.z.im;
    vec3 R = max(R_s, R_p);
    vec3 first = max(s.C0 * s.C0 * R_s, p.C0 * p.C0 * R_p);
    float order2 = max(first.x, max(first.y, first.z)) * k2.x;
    float ratio2 = min(max(R.x, max(R.y, R.z)) * k2.x * k2.x * k2.x, THIN_FILM_ORDER_RATIO);

    vec3 sum = vec3(0.0);
    ThinFilmComplex C_s = ThinFilmComplex(s.C0 * s.z.re, s.C0 * s.z.im);
    ThinFilmComplex C_p = ThinFilmComplex(p.C0 * p.z.re, p.C0 * p.z.im);
    do
    {
        sum += (C_s.re + C_p.re) * thin_film_color(S_re);
        if (is_real)
        {
            C_s.re *= s.z.re;
            C_p.re *= p.z.re;
        }
        else
        {
            sum -= (C_s.im + C_p.im) * thin_film_color(S_im);
            C_s = thin_film_product(C_s, s.z);
            C_p = thin_film_product(C_p, p.z);
        }
        vec4 next = S_re * ratio_re - S_im * ratio_im;
        S_im = S_re * ratio_im + S_im * ratio_re;
        S_re = next;
        ratio_re *= k2;
        ratio_im *= k2;
        order2 *= ratio2;
        ratio2 *= k2.x * k2.x;
    } while (order2 > limit);
    return sum;
}

// F_airy at a cosine mu, or its mean over cosines of a width around mu. A film thinner than vacuum is vacuum.
vec3 thin_film_fresnel(float mu, float width, FresnelData fd)
{
    // Three-Layer Geometry
    float n = max(fd.tf_ior, 1.0);
    float sin2 = (1.0 - mu) * (1.0 + mu);
    float sin2_t = sin2 / (n * n);
    float mu_t = sqrt(max(1.0 - sin2_t, 0.0));

    // First Interface: (n mu_t - mu) / (n mu_t + mu) and (mu_t - n mu) / (mu_t + n mu), 0 without a film.
    float gap = (n - 1.0) * (n + 1.0);
    float sum_s = n * mu_t + mu;
    float sum_p = mu_t + n * mu;
    float r21_s = gap / max(sum_s * sum_s, THIN_FILM_LEAST);
    float r21_p = gap * (sin2_t - mu * mu) / max(sum_p * sum_p, THIN_FILM_LEAST);

    ThinFilmComplex r23_s, r23_p;
    thin_film_substrate(n, mu_t, sin2, fd, r23_s, r23_p);
    ThinFilmWave s = thin_film_wave(r21_s, r23_s);
    ThinFilmWave p = thin_film_wave(r21_p, r23_p);

    // Optical Path Difference: phi = 2 pi Delta, whose slope in mu is 4 pi d mu / (n mu_t).
    float scale = 4.0e-9 * M_PI * fd.tf_thickness;
    float phi = scale * n * mu_t;
    float spread = scale * width * mu / max(n * mu_t, THIN_FILM_LEAST);
    vec3 mean = s.mean + p.mean;
    float limit = max(THIN_FILM_ORDER_VALUE * dot(mean, mean), THIN_FILM_ORDER_WIDTH * width * width);
    bool is_real = fd.model == FRESNEL_MODEL_SCHLICK;
    return clamp(0.5 * mean + thin_film_orders(s, p, phi, spread, limit, is_real), 0.0, 1.0);
}
