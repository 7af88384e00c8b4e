// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// Reflectance F_airy of a film (2) between vacuum (1) and a substrate (3) in linear Rec. 709:
// [MaterialX2026], Thin-Film Iridescence Model, whose sections are named below. Each color channel
// has its own substrate. python/mxeon/models/thin_film.py explains the complex z = r_21 r_23.

// Section Spectral Sensitivity: two Gaussians for X, one for Y, one for Z. Positions mu_k are
// in 1/m. Variances sigma_k^2 are in 1/m^2, and the first is the smallest. Heights are
// v_k sqrt(2 pi sigma_k^2) / 1.0685e-7. Colors in Rec. 709 are adapted from white E by Bradford's
// method.
#define THIN_FILM_POSITIONS vec4(1.6810e6, 2.2399e6, 1.7953e6, 2.2084e6)
#define THIN_FILM_VARIANCES vec4(4.3278e9, 4.5282e9, 9.3046e9, 6.6121e9)
#define THIN_FILM_HEIGHTS vec4(0.84659, 0.15386831, 1.0002219, 1.0011225)
#define THIN_FILM_COLOR_X vec3(3.1462511, -0.995535, 0.0635978)
#define THIN_FILM_COLOR_Y vec3(-1.666124, 1.9557635, -0.2145965)
#define THIN_FILM_COLOR_Z vec3(-0.4801271, 0.0397715, 1.1509987)

#define THIN_FILM_LEAST 1e-12  // avoids 0 / 0

// The sum ends when the square of the next term is at most VALUE times the squared mean reflectance
// or WIDTH times the squared cosine width. Squared terms fall at least by RATIO, so a mean of
// 1e-3 needs at most ln(VALUE 1e-6) / ln(RATIO) = 86.1 < COUNT terms. Source:
// tools/fits/thin_film.py. Largest relative error of a film that reflects 1e-3 or more: 8e-4.
#define THIN_FILM_ORDER_VALUE 8e-14
#define THIN_FILM_ORDER_WIDTH 1e-3
#define THIN_FILM_ORDER_RATIO 0.6
#define THIN_FILM_ORDER_COUNT 87

struct ThinFilmComplex
{
    vec3 re;
    vec3 im;
};

ThinFilmComplex thin_film_product(ThinFilmComplex a, ThinFilmComplex b)
{
    ThinFilmComplex z;  // Metal lacks struct constructors
    z.re = a.re * b.re - a.im * b.im;
    z.im = a.re * b.im + a.im * b.re;
    return z;
}

// Amplitude (a - b) / (a + b) of an interface.
ThinFilmComplex thin_film_interface(ThinFilmComplex a, ThinFilmComplex b)
{
    ThinFilmComplex z;
    z.re = a.re + b.re;
    z.im = a.im + b.im;
    vec3 inverse = 1.0 / max(z.re * z.re + z.im * z.im, THIN_FILM_LEAST);
    z.re = (a.re * a.re + a.im * a.im - b.re * b.re - b.im * b.im) * inverse;
    z.im = 2.0 * (a.im * b.re - a.re * b.im) * inverse;
    return z;
}

// Section Second Interface: r_23 of both polarizations. In the film of index n, the cosine is mu_t.
void thin_film_substrate(float n, float mu_t, float sin2, FresnelData fd, out ThinFilmComplex r23_s,
                         out ThinFilmComplex r23_p)
{
    if (fd.model == FRESNEL_MODEL_SCHLICK)
    {
        // The sign of r_23 depends on whether the substrate is denser. The factor 1 - 1e-6
        // tolerates rounding of F0. Negative values count as 0.
        float F0 = (1.0 - 1e-6) * mx_ior_to_f0(n);
        vec3 r = sqrt(max(mx_fresnel_hoffman_schlick(mu_t, fd), 0.0));
        r23_p.re = r * (2.0 * step(vec3(F0), fd.F0) - 1.0);
        r23_p.im = vec3(0.0);
        r23_s.re = -r23_p.re;
        r23_s.im = r23_p.im;
    }
    else
    {
        // Section Second Interface Phase: the root U + i V of (eta_3 + i kappa_3)^2 - sin^2(theta).
        // The smaller of U and V is a quotient, since a difference would cancel.
        vec3 n2 = fd.ior * fd.ior - fd.extinction * fd.extinction;
        vec3 Q = fd.ior * fd.extinction;
        vec3 A = n2 - sin2;
        vec3 larger = sqrt(0.5 * (sqrt(A * A + 4.0 * Q * Q) + abs(A)));
        vec3 smaller = Q / max(larger, THIN_FILM_LEAST);
        vec3 positive = step(vec3(0.0), A);
        ThinFilmComplex root, incident;
        root.re = mix(smaller, larger, positive);
        root.im = mix(larger, smaller, positive);
        incident.re = vec3(n * mu_t);
        incident.im = vec3(0.0);
        r23_s = thin_film_interface(incident, root);
        incident.re = n2 * mu_t;
        incident.im = 2.0 * Q * mu_t;
        root.re *= n;
        root.im *= n;
        r23_p = thin_film_interface(incident, root);
    }
}

// Section Airy Summation: the DC term R_12 + R_dc is 1 + C_0. C_0 = R_dc - T_12 is computed as a
// product without cancellation.
vec3 thin_film_c0(float r21, ThinFilmComplex r23)
{
    float R12 = r21 * r21;
    vec3 R23 = r23.re * r23.re + r23.im * r23.im;
    return (R12 - 1.0) * (1.0 - R23) / max(1.0 - R12 * R23, THIN_FILM_LEAST);
}

// XYZ to Rec. 709: section Color Conversion.
vec3 thin_film_rec709(vec4 S)
{
    return (S.x + S.y) * THIN_FILM_COLOR_X + S.z * THIN_FILM_COLOR_Y + S.w * THIN_FILM_COLOR_Z;
}

// Section Airy Summation, higher-order terms: the sum of Re(C_m S_m) / 2 over m and polarizations,
// where C_m = C_0 z^m and S_m / 2 = fade^(m^2) exp(i mu_k phi m). If z is real, the real parts of S
// suffice: S_(m + 1) = fade^(2 m) (S_1 S_m - fade^(2 m) S_(m - 1)). `spread` is the change of phi
// over the width. To damp fast waves, fade decreases with spread^4, an arbitrary power.
vec3 thin_film_orders(vec3 C0_s, ThinFilmComplex z_s, vec3 C0_p, ThinFilmComplex z_p, float phi, float spread,
                      float limit, bool is_real)
{
    const vec4 positions2 = THIN_FILM_POSITIONS * THIN_FILM_POSITIONS;
    float spread2 = spread * spread;
    vec4 fade = exp(-THIN_FILM_VARIANCES * (phi * phi) - 0.25 * positions2 * positions2 * (spread2 * spread2));
    vec4 fade2 = fade * fade;
    vec4 power = fade2;  // fade^(2 m)
    vec4 cosine = fade * mx_cos(THIN_FILM_POSITIONS * phi);
    vec4 sine = fade * mx_sin(THIN_FILM_POSITIONS * phi);
    vec4 before = THIN_FILM_HEIGHTS;
    vec4 S_re = THIN_FILM_HEIGHTS * cosine;  // S_m / 2 times the heights
    vec4 S_im = THIN_FILM_HEIGHTS * sine;

    // Bounds of the squares of the first term and of the ratio of successive terms. Polarization s
    // has the larger |z|, and p has the larger |C_0|.
    vec3 R = z_s.re * z_s.re + z_s.im * z_s.im;
    vec3 first = C0_p * C0_p * R;
    float order2 = max(first.x, max(first.y, first.z)) * fade2.x;
    float ratio2 = min(max(R.x, max(R.y, R.z)) * fade2.x * fade2.x * fade2.x, THIN_FILM_ORDER_RATIO);

    vec3 sum = vec3(0.0);
    ThinFilmComplex C_s, C_p;
    C_s.re = C0_s * z_s.re;
    C_s.im = C0_s * z_s.im;
    C_p.re = C0_p * z_p.re;
    C_p.im = C0_p * z_p.im;
    for (int m = 0; m < THIN_FILM_ORDER_COUNT; m++)
    {
        sum += (C_s.re + C_p.re) * thin_film_rec709(S_re);
        if (is_real)
        {
            C_s.re *= z_s.re;
            C_p.re *= z_p.re;
            vec4 next = power * (2.0 * cosine * S_re - power * before);
            before = S_re;
            S_re = next;
        }
        else
        {
            sum -= (C_s.im + C_p.im) * thin_film_rec709(S_im);
            C_s = thin_film_product(C_s, z_s);
            C_p = thin_film_product(C_p, z_p);
            vec4 next = power * (cosine * S_re - sine * S_im);
            S_im = power * (cosine * S_im + sine * S_re);
            S_re = next;
        }
        power *= fade2;
        order2 *= ratio2;
        ratio2 *= fade2.x * fade2.x;
        if (order2 <= limit)
        {
            break;
        }
    }
    return sum;
}

// F_airy at cosine mu, averaged over nearby cosines if width > 0. A film index below 1 counts as 1.
vec3 thin_film_fresnel(float mu, float width, FresnelData fd)
{
    // Section Three-Layer Geometry: g = n mu_t. Factoring n^2 - 1 keeps the digits of a small mu.
    float n = max(fd.tf_ior, 1.0);
    float g = sqrt((n - 1.0) * (n + 1.0) + mu * mu);

    // Amplitudes r_21: section First Interface.
    float r21_s = (g - mu) / max(g + mu, THIN_FILM_LEAST);
    float r21_p = (g - n * n * mu) / max(g + n * n * mu, THIN_FILM_LEAST);

    ThinFilmComplex z_s, z_p;  // r_23, later r_21 r_23
    thin_film_substrate(n, g / n, (1.0 - mu) * (1.0 + mu), fd, z_s, z_p);
    vec3 C0_s = thin_film_c0(r21_s, z_s);
    vec3 C0_p = thin_film_c0(r21_p, z_p);
    z_s.re *= r21_s;
    z_s.im *= r21_s;
    z_p.re *= r21_p;
    z_p.im *= r21_p;

    // Section Optical Path Difference: phi = 2 pi Delta = 4 pi d g, and dphi / dmu = 4 pi d mu / g.
    float scale = 4.0e-9 * M_PI * fd.tf_thickness;
    float phi = scale * g;
    float spread = scale * width * mu / max(g, THIN_FILM_LEAST);
    vec3 mean = 1.0 + 0.5 * (C0_s + C0_p);
    float limit = max(THIN_FILM_ORDER_VALUE * dot(mean, mean), THIN_FILM_ORDER_WIDTH * width * width);
    bool is_real = fd.model != FRESNEL_MODEL_CONDUCTOR;  // total reflection has complex z, but C_0 = 0
    return clamp(mean + thin_film_orders(C0_s, z_s, C0_p, z_p, phi, spread, limit, is_real), 0.0, 1.0);
}
