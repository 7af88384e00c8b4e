// SPDX-License-Identifier: Apache-2.0
// Airy reflectance of a thin film in linear Rec. 709: [MaterialX2026], Thin-Film Iridescence Model.
//
// Each color channel has its own substrate, and its own sum over CIE XYZ. Reflected amplitudes are
// complex numbers as vec2, so that no phase is taken from an arctangent.

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// mu and sigma^2 of the sensitivities of X, X, Y and Z, in 1/m and 1/m^2.
#define THIN_FILM_POSITIONS vec4(1.6810e6, 2.2399e6, 1.7953e6, 2.2084e6)
#define THIN_FILM_VARIANCES vec4(4.3278e9, 4.5282e9, 9.3046e9, 6.6121e9)

// Their heights v sqrt(2 pi sigma^2) / 1.0685e-7 times the matrix from XYZ under white E to Rec.
// 709, `XYZ_TO_REC709_E` of mxeon.models.core.colorimetry: a film that vanishes leaves white alone.
#define THIN_FILM_RED vec4(2.663585, 0.4841083, -1.666494, -0.480666)
#define THIN_FILM_GREEN vec4(-0.84281, -0.1531813, 1.956197, 0.03981614)
#define THIN_FILM_BLUE vec4(0.05384126, 0.009785686, -0.2146441, 1.152291)

// Gauss's rule for 2 F(mu) mu dmu: cosine and weight; and the width of its nodes.
#define THIN_FILM_GAUSS1 vec2(0.09853509, 0.03149583)
#define THIN_FILM_GAUSS2 vec2(0.30453573, 0.14781774)
#define THIN_FILM_GAUSS3 vec2(0.56202519, 0.29277397)
#define THIN_FILM_GAUSS4 vec2(0.80198658, 0.33434928)
#define THIN_FILM_GAUSS5 vec2(0.96019014, 0.19356318)
#define THIN_FILM_WIDTH 0.07

// The same in two cosines. Source: tools/fits/thin_film_nodes.py.
#define THIN_FILM_PAIR1 vec2(0.294, 0.275)
#define THIN_FILM_PAIR2 vec2(0.785, 0.725)
#define THIN_FILM_PAIR_WIDTH 0.165

// Two quotients of 0 by 0 are kept finite: of a vanishing root, and of full reflection at grazing.
#define THIN_FILM_LEAST 1e-12

// Orders are summed while the square of one exceeds a limit, of a value this times the square of both mean
// reflectances, of a node of a rule this times the cube of its width, since a node that stands for few
// cosines is to be as exact as a value; each counts as smaller than the one before it by a factor at least.
#define THIN_FILM_ORDER_VALUE 2e-14
#define THIN_FILM_ORDER_MEAN 2e-4
#define THIN_FILM_ORDER_RATIO 0.6

// What all cosines share: the film's index, at least that of vacuum, the inverse of its square, twice the
// thickness in m, and the sign of the amplitude that a Schlick substrate reflects.
struct ThinFilm
{
    float n;
    float inverse;
    float twice;
    vec3 sign;
};

// Below a denser film the amplitude of a Schlick substrate changes its sign.
ThinFilm thin_film(FresnelData fd)
{
    ThinFilm film;
    film.n = max(fd.tf_ior, 1.0);
    film.inverse = 1.0 / (film.n * film.n);
    film.twice = 2.0e-9 * fd.tf_thickness;
    film.sign = 2.0 * step(vec3((film.n - 1.0) / (film.n + 1.0)), sqrt(fd.F0)) - 1.0;
    return film;
}

// Red, green and blue of what X, X, Y and Z respond with.
vec3 thin_film_color(vec4 response)
{
    return vec3(dot(THIN_FILM_RED, response), dot(THIN_FILM_GREEN, response),
                dot(THIN_FILM_BLUE, response));
}

// Multiply complex numbers, one for each channel.
void thin_film_multiply(inout vec3 re, inout vec3 im, vec3 x, vec3 y)
{
    vec3 product = re * x - im * y;
    im = re * y + im * x;
    re = product;
}

// Sum over orders m of the colors of Re A z^m S_m, z of each polarization and channel, A its weight, S_m =
// k^(m^2) exp(i m x) of each sensitivity, x = 2 pi mu opd, k = exp(-(2 pi sigma opd)^2). A color of S_m serves
// all z. Where all z are real, cosines suffice, C_m = Re S_m: C_(m + 1) = 2 k^(2 m) C_1 C_m - k^(4 m) C_(m - 1),
// and compilers drop the sines and half of a step.
vec3 thin_film_orders(vec3 A_s, vec3 A_p, vec3 re_s, vec3 im_s, vec3 re_p, vec3 im_p, float opd,
                      float width, float limit, bool is_real)
{
    // The first order, its ratio to the second, and the order before it with its share of a real second.
    // Wide fringes are seen by the nodes of a rule, narrow ones vanish from its mean: exp(-(2 pi mu width)^4 / 4).
    float phase = 2.0 * M_PI * opd;
    vec4 spread = THIN_FILM_POSITIONS * (2.0 * M_PI * width);
    vec4 spread2 = spread * spread;
    vec4 k = exp(-THIN_FILM_VARIANCES * (phase * phase) - 0.25 * spread2 * spread2);
    vec4 k2 = k * k;
    vec4 k4 = k2 * k2;
    vec4 wave_re = k * mx_cos(THIN_FILM_POSITIONS * phase);
    vec4 wave_im = k * mx_sin(THIN_FILM_POSITIONS * phase);
    vec4 ratio_re = k2 * wave_re;
    vec4 ratio_im = k2 * wave_im;
    vec4 before = vec4(1.0);
    vec4 share = k4;

    // Squares of the largest first order, and of its ratio to the second. The first sensitivity is narrowest.
    vec3 R_s = re_s * re_s + im_s * im_s;
    vec3 R_p = re_p * re_p + im_p * im_p;
    vec3 largest = max(R_s, R_p);
    vec3 first = max(A_s * A_s * R_s, A_p * A_p * R_p);
    float narrow2 = k4.x;
    float ratio2 = max(largest.x, max(largest.y, largest.z)) * narrow2 * k2.x;
    float order2 = max(first.x, max(first.y, first.z)) * k2.x;
    ratio2 = min(ratio2, THIN_FILM_ORDER_RATIO);

    // Add order by order.
    vec3 orders = vec3(0.0);
    vec3 power_re_s = A_s * re_s;
    vec3 power_im_s = A_s * im_s;
    vec3 power_re_p = A_p * re_p;
    vec3 power_im_p = A_p * im_p;
    do  // a loop that asks first takes one step more on llvmpipe
    {
        orders += (power_re_s + power_re_p) * thin_film_color(wave_re);
        if (is_real)
        {
            power_re_s *= re_s;
            power_re_p *= re_p;
            vec4 next = 2.0 * ratio_re * wave_re - share * before;
            before = wave_re;
            wave_re = next;
            share *= k4;
        }
        else
        {
            orders -= (power_im_s + power_im_p) * thin_film_color(wave_im);
            thin_film_multiply(power_re_s, power_im_s, re_s, im_s);
            thin_film_multiply(power_re_p, power_im_p, re_p, im_p);
            vec4 next = wave_re * ratio_re - wave_im * ratio_im;
            wave_im = wave_re * ratio_im + wave_im * ratio_re;
            wave_re = next;
            ratio_im *= k2;
        }
        ratio_re *= k2;
        order2 *= ratio2;
        ratio2 *= narrow2;
    } while (order2 > limit);
    return orders;
}

// Mean reflectance of one polarization over all phases, and the weight of its orders, from the reflectances
// of both interfaces.
vec3 thin_film_polarized(float R12, vec3 R23, out vec3 weight)
{
    float T12 = 1.0 - R12;
    vec3 passed = T12 / max(1.0 - R12 * R23, THIN_FILM_LEAST);
    weight = passed * (1.0 - R23);
    return R12 + T12 * passed * R23;
}

// Root of (ior + i extinction)^2 - sin^2, of which the smaller part does not cancel.
void thin_film_root(float sin2, vec3 ior, vec3 extinction, out vec3 re, out vec3 im)
{
    vec3 A = ior * ior - extinction * extinction - sin2;
    vec3 Q = ior * extinction;
    vec3 larger = sqrt(0.5 * (sqrt(A * A + 4.0 * Q * Q) + abs(A)));
    vec3 smaller = Q / max(larger, THIN_FILM_LEAST);
    vec3 positive = step(vec3(0.0), A);
    re = mix(smaller, larger, positive);
    im = mix(larger, smaller, positive);
}

// (a - b) / (a + b) of complex numbers, a in x + i y, b in u + i v.
void thin_film_amplitude(vec3 x, vec3 y, vec3 u, vec3 v, out vec3 re, out vec3 im)
{
    vec3 inverse = 1.0 / max((x + u) * (x + u) + (y + v) * (y + v), THIN_FILM_LEAST);
    re = (x * x + y * y - u * u - v * v) * inverse;
    im = 2.0 * (y * u - x * v) * inverse;
}

// Amplitudes of the lower interface under a film, at a cosine mu_t in the film and a sine above it whose
// square is sin2, for both polarizations.
void thin_film_lower(float mu_t, ThinFilm film, float sin2, FresnelData fd, out vec3 re_s,
                     out vec3 im_s, out vec3 re_p, out vec3 im_p)
{
    if (fd.model == FRESNEL_MODEL_SCHLICK)
    {
        // A negative curve has no amplitude.
        re_p = sqrt(max(mx_fresnel_hoffman_schlick(mu_t, fd), 0.0)) * film.sign;
        re_s = -re_p;
        im_p = vec3(0.0);
        im_s = vec3(0.0);
    }
    else
    {
        float n = film.n;
        vec3 U, V;
        thin_film_root(sin2, fd.ior, fd.extinction, U, V);
        thin_film_amplitude(vec3(n * mu_t), vec3(0.0), U, V, re_s, im_s);
        vec3 re = (fd.ior * fd.ior - fd.extinction * fd.extinction) * mu_t;
        vec3 im = 2.0 * fd.ior * fd.extinction * mu_t;
        thin_film_amplitude(re, im, n * U, n * V, re_p, im_p);
    }
}

// F_airy, its mean over a width of cosines around mu. A film thinner than vacuum counts as vacuum.
vec3 thin_film_fresnel(float mu, float width, ThinFilm film, FresnelData fd)
{
    // Refract into the film.
    float n = film.n;
    float sin2 = (1.0 - mu) * (1.0 + mu);
    float sin2_t = sin2 * film.inverse;
    float mu_t = sqrt(max(1.0 - sin2_t, 0.0));
    float nu = n * mu_t;

    // Reflect at the upper interface, whose gap is 0 without a film, at grazing too.
    float gap = (n - 1.0) * (n + 1.0);
    float sum_s = mu + nu;
    float sum_p = n * mu + mu_t;
    float r_s = -gap / max(sum_s * sum_s, THIN_FILM_LEAST);
    float r_p = gap * (mu * mu - sin2_t) / max(sum_p * sum_p, THIN_FILM_LEAST);

    // Reflect at the lower interface.
    vec3 re_s, im_s, re_p, im_p;
    thin_film_lower(mu_t, film, sin2, fd, re_s, im_s, re_p, im_p);

    // Sum the orders between both. The slope of 2 n mu_t d is 2 d mu / (n mu_t).
    vec3 A_s, A_p;
    vec3 mean = thin_film_polarized(r_s * r_s, re_s * re_s + im_s * im_s, A_s)
                + thin_film_polarized(r_p * r_p, re_p * re_p + im_p * im_p, A_p);
    float limit = max(THIN_FILM_ORDER_VALUE * dot(mean, mean), THIN_FILM_ORDER_MEAN * width * width * width);
    vec3 orders = thin_film_orders(A_s, A_p, -r_s * re_s, -r_s * im_s, -r_p * re_p, -r_p * im_p,
                                   film.twice * nu,
                                   film.twice * width * mu / max(nu, THIN_FILM_LEAST), limit,
                                   fd.model == FRESNEL_MODEL_SCHLICK);
    return clamp(0.5 * mean - orders, 0.0, 1.0);
}

// Node i of 2 or 5 for F_ss: cosine, weight and width.
vec3 thin_film_gauss(int i, int count)
{
    if (count == 2)
    {
        return vec3(i == 0 ? THIN_FILM_PAIR1 : THIN_FILM_PAIR2, THIN_FILM_PAIR_WIDTH);
    }
    vec2 low = i == 0 ? THIN_FILM_GAUSS1 : (i == 1 ? THIN_FILM_GAUSS2 : THIN_FILM_GAUSS3);
    vec2 high = i == 3 ? THIN_FILM_GAUSS4 : THIN_FILM_GAUSS5;
    return vec3(i < 3 ? low : high, THIN_FILM_WIDTH);
}
