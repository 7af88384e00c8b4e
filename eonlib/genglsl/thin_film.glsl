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

// The same in two cosines. Source: fits/thin_film_nodes.py.
#define THIN_FILM_PAIR1 vec2(0.294, 0.275)
#define THIN_FILM_PAIR2 vec2(0.785, 0.725)
#define THIN_FILM_PAIR_WIDTH 0.165

// Two quotients of 0 by 0 are kept finite: of a vanishing root, and of full reflection at grazing.
#define THIN_FILM_LEAST 1e-12

// Waves of a path difference: 2 pi mu opd, and exp(-k (2 pi sigma opd)^2) by k.
struct ThinFilmWaves
{
    vec4 cosine;
    vec4 sine;
    vec4 k1;
    vec4 k4;
    vec4 k9;
    vec4 k16;
    vec4 k25;
    vec4 k36;
    vec4 k49;
    vec4 k15;
    vec4 tail; // by how much the ratio of the series falls below k15 at full reflection
};

// Waves of path differences around opd, of standard deviation `width`. Wide fringes are seen by the
// nodes of a rule, narrow ones vanish from its mean: exp(-(2 pi mu width)^4 / 4).
ThinFilmWaves thin_film_waves(float opd, float width)
{
    float phase = 2.0 * M_PI * opd;
    vec4 spread = THIN_FILM_POSITIONS * (2.0 * M_PI * width);
    vec4 spread2 = spread * spread;
    ThinFilmWaves waves;
    waves.cosine = mx_cos(THIN_FILM_POSITIONS * phase);
    waves.sine = mx_sin(THIN_FILM_POSITIONS * phase);
    waves.k1 = exp(-THIN_FILM_VARIANCES * (phase * phase) - 0.25 * spread2 * spread2);
    vec4 k2 = waves.k1 * waves.k1;
    waves.k4 = k2 * k2;
    vec4 k8 = waves.k4 * waves.k4;
    waves.k9 = k8 * waves.k1;
    waves.k16 = k8 * k8;
    waves.k25 = waves.k16 * waves.k9;
    waves.k36 = waves.k16 * waves.k16 * waves.k4;
    waves.k49 = waves.k25 * k8 * waves.k16;
    waves.k15 = k8 * waves.k4 * k2 * waves.k1;
    waves.tail = waves.k15 * waves.k49 * (1.0 - waves.k4 * k2);
    return waves;
}

// Sum of r^m S(m opd, m phi) over all orders m, for r exp(i phi) = z: six by Clenshaw's recurrence,
// b_m = h_m + 2 Re w b_(m + 1) - r^2 b_(m + 2), w = z exp(2 pi i mu opd), and a geometric series.
// Its heights are k^(7 + j)^2 = k^49 k^(14 j + j^2). Where r is small or the film thick its ratio is
// k^15, which agrees at j = 1, the one that counts. Where r is near 1 and the film thin, k near 1, it
// is close to k^21, which agrees at j = 7: terms before it err in the other direction than later ones.
vec4 thin_film_orders(vec2 z, ThinFilmWaves waves)
{
    float r2 = dot(z, z);
    vec4 w = z.x * waves.cosine - z.y * waves.sine;
    vec4 twice = 2.0 * w;
    vec4 ratio = waves.k15 - r2 * waves.tail;
    vec4 next = twice - r2 * ratio;
    vec4 b7 = waves.k49 / max(1.0 - ratio * next, THIN_FILM_LEAST);
    vec4 b6 = waves.k36 + next * b7;
    vec4 b5 = waves.k25 + twice * b6 - r2 * b7;
    vec4 b4 = waves.k16 + twice * b5 - r2 * b6;
    vec4 b3 = waves.k9 + twice * b4 - r2 * b5;
    vec4 b2 = waves.k4 + twice * b3 - r2 * b4;
    vec4 b1 = waves.k1 + twice * b2 - r2 * b3;
    return w * b1 - r2 * b2;
}

// Sums of orders of both polarizations, by channel: a channel of a polarization in each step of one
// loop, of which compilers make one copy. Channels that are all alike have one sum.
void thin_film_sums(vec3 re_s, vec3 im_s, vec3 re_p, vec3 im_p, ThinFilmWaves waves, int channels,
                    out vec3 orders_s, out vec3 orders_p)
{
    orders_s = vec3(0.0);
    orders_p = vec3(0.0);
    int i = 0;
    do  // a loop that asks first takes one step more on llvmpipe
    {
        bool is_s = i < channels;
        int k = is_s ? i : i - channels;
        vec3 channel = vec3(k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0);
        vec2 z = vec2(dot(is_s ? re_s : re_p, channel), dot(is_s ? im_s : im_p, channel));
        vec4 orders = thin_film_orders(z, waves);
        vec3 sums = vec3(dot(THIN_FILM_RED, orders), dot(THIN_FILM_GREEN, orders),
                         dot(THIN_FILM_BLUE, orders));
        sums *= channels == 1 ? vec3(1.0) : channel;
        orders_s += is_s ? sums : vec3(0.0);
        orders_p += is_s ? vec3(0.0) : sums;
        i++;
    } while (i < 2 * channels);
}

// Reflectance of one polarization from the sums of its orders: r12 is the amplitude of the upper
// interface, re + i im that of the lower one.
vec3 thin_film_polarized(float r12, vec3 re, vec3 im, vec3 orders)
{
    float R12 = r12 * r12;
    float T12 = 1.0 - R12;
    vec3 R23 = re * re + im * im;
    vec3 trapped = max(1.0 - R12 * R23, THIN_FILM_LEAST);
    return R12 + T12 * (T12 * R23 - 2.0 * (1.0 - R23) * orders) / trapped;
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
    vec3 divisor = max((x + u) * (x + u) + (y + v) * (y + v), THIN_FILM_LEAST);
    re = (x * x + y * y - u * u - v * v) / divisor;
    im = 2.0 * (y * u - x * v) / divisor;
}

// Amplitudes of the lower interface under a film of index n, at cosines mu_t in the film and a sine
// above it whose square is sin2, for both polarizations.
void thin_film_lower(float mu_t, float n, float sin2, FresnelData fd, out vec3 re_s, out vec3 im_s,
                     out vec3 re_p, out vec3 im_p)
{
    if (fd.model == FRESNEL_MODEL_SCHLICK)
    {
        // A negative curve has no amplitude; below a denser film it changes its sign.
        vec3 denser = step(vec3((n - 1.0) / (n + 1.0)), sqrt(fd.F0));
        re_p = sqrt(max(mx_fresnel_hoffman_schlick(mu_t, fd), 0.0)) * (2.0 * denser - 1.0);
        re_s = -re_p;
        im_p = vec3(0.0);
        im_s = vec3(0.0);
    }
    else
    {
        vec3 U, V;
        thin_film_root(sin2, fd.ior, fd.extinction, U, V);
        thin_film_amplitude(vec3(n * mu_t), vec3(0.0), U, V, re_s, im_s);
        vec3 re = (fd.ior * fd.ior - fd.extinction * fd.extinction) * mu_t;
        vec3 im = 2.0 * fd.ior * fd.extinction * mu_t;
        thin_film_amplitude(re, im, n * U, n * V, re_p, im_p);
    }
}

// F_airy, its mean over a width of cosines around mu. A film thinner than vacuum counts as vacuum.
vec3 thin_film_fresnel(float mu, float width, FresnelData fd)
{
    // Refract into the film.
    float n = max(fd.tf_ior, 1.0);
    float sin2 = (1.0 - mu) * (1.0 + mu);
    float mu_t = sqrt(max(1.0 - sin2 / (n * n), 0.0));

    // Reflect at the upper interface, whose gap is 0 without a film, at grazing too.
    float gap = (n - 1.0) * (n + 1.0);
    float sum_s = mu + n * mu_t;
    float sum_p = n * mu + mu_t;
    float r_s = -gap / max(sum_s * sum_s, THIN_FILM_LEAST);
    float r_p = gap * (mu * mu - sin2 / (n * n)) / max(sum_p * sum_p, THIN_FILM_LEAST);

    // Reflect at the lower interface.
    vec3 re_s, im_s, re_p, im_p;
    thin_film_lower(mu_t, n, sin2, fd, re_s, im_s, re_p, im_p);

    // Sum the orders between both. The slope of 2 n mu_t d is 2 d mu / (n mu_t).
    float twice = 2.0e-9 * fd.tf_thickness;
    float nu = n * mu_t;
    ThinFilmWaves waves = thin_film_waves(twice * nu, twice * width * mu / max(nu, THIN_FILM_LEAST));
    vec3 colors = abs(re_s - re_s.x) + abs(im_s - im_s.x) + abs(re_p - re_p.x) + abs(im_p - im_p.x);
    int channels = dot(colors, vec3(1.0)) > 0.0 ? 3 : 1;
    vec3 orders_s, orders_p;
    thin_film_sums(-r_s * re_s, -r_s * im_s, -r_p * re_p, -r_p * im_p, waves, channels, orders_s,
                   orders_p);
    vec3 F_s = thin_film_polarized(r_s, re_s, im_s, orders_s);
    vec3 F_p = thin_film_polarized(r_p, re_p, im_p, orders_p);
    return clamp(0.5 * (F_s + F_p), 0.0, 1.0);
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
