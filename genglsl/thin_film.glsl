// SPDX-License-Identifier: Apache-2.0
// Airy reflectance of a thin film in linear Rec. 709: [MaterialX2026], Thin-Film Iridescence Model.
//
// Each color channel has its own substrate, and its own sum over CIE XYZ. Reflected amplitudes are
// complex numbers as vec2, so that no phase is taken from an arctangent.

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// mu and sigma^2 of the sensitivities of X, X, Y and Z, in 1/m and 1/m^2.
#define THIN_FILM_POSITIONS vec4(1.6810e6, 2.2399e6, 1.7953e6, 2.2084e6)
#define THIN_FILM_VARIANCES vec4(4.3278e9, 4.5282e9, 9.3046e9, 6.6121e9)

// Their heights v sqrt(2 pi sigma^2) / 1.0685e-7 times the matrix from XYZ under white E to Rec. 709,
// `XYZ_TO_REC709_E` of mxeon.models.colorimetry: a film that vanishes has to leave white alone.
#define THIN_FILM_RED vec4(2.663585, 0.4841083, -1.666494, -0.480666)
#define THIN_FILM_GREEN vec4(-0.84281, -0.1531813, 1.956197, 0.03981614)
#define THIN_FILM_BLUE vec4(0.05384126, 0.009785686, -0.2146441, 1.152291)

// Gauss's rule for the average over a hemisphere, 2 F(mu) mu dmu: cosine and weight.
#define THIN_FILM_GAUSS1 vec2(0.07305433, 0.01747660)
#define THIN_FILM_GAUSS2 vec2(0.23076614, 0.08791033)
#define THIN_FILM_GAUSS3 vec2(0.44132848, 0.19732230)
#define THIN_FILM_GAUSS4 vec2(0.66301531, 0.28158511)
#define THIN_FILM_GAUSS5 vec2(0.85192140, 0.27108499)
#define THIN_FILM_GAUSS6 vec2(0.97068357, 0.14462066)

// Gauss's rule on [0, 1] in three nodes, the one in the middle at 1/2.
#define THIN_FILM_LOW 0.11270167
#define THIN_FILM_OUTER_WEIGHT (5.0 / 18.0)
#define THIN_FILM_MIDDLE_WEIGHT (8.0 / 18.0)

// Two quotients of 0 by 0 are kept finite: of a vanishing root, and of full reflection at grazing.
#define THIN_FILM_LEAST 1e-12

// Waves of a path difference: 2 pi mu opd, and exp(-k (2 pi sigma opd)^2) by k.
struct ThinFilmWaves
{
    vec4 angle;
    vec4 k1;
    vec4 k4;
    vec4 k9;
    vec4 k16;
    vec4 k25;
    vec4 k36;
    vec4 k49;
    vec4 k15;
};

ThinFilmWaves thin_film_waves(float opd)
{
    float phase = 2.0 * M_PI * opd;
    ThinFilmWaves waves;
    waves.angle = THIN_FILM_POSITIONS * phase;
    waves.k1 = exp(-THIN_FILM_VARIANCES * (phase * phase));
    vec4 k2 = waves.k1 * waves.k1;
    vec4 k8 = k2 * k2 * k2 * k2;
    waves.k4 = k2 * k2;
    waves.k9 = k8 * waves.k1;
    waves.k16 = k8 * k8;
    waves.k25 = waves.k16 * waves.k9;
    waves.k36 = waves.k16 * waves.k16 * waves.k4;
    waves.k49 = waves.k25 * k8 * waves.k16;
    waves.k15 = k8 * waves.k4 * k2 * waves.k1;
    return waves;
}

// Sum of r^m S(m opd, m phi) over all orders m, for r exp(i phi) = z. Six are summed; what follows is a
// geometric series from the seventh on, with the ratio of the eighth to it.
vec4 thin_film_orders(vec2 z, ThinFilmWaves waves)
{
    vec4 c = mx_cos(waves.angle);
    vec4 s = mx_sin(waves.angle);
    vec4 x = z.x * c - z.y * s;
    vec4 y = z.x * s + z.y * c;
    vec4 x2 = x * x - y * y;
    vec4 y2 = 2.0 * x * y;
    vec4 x3 = x2 * x - y2 * y;
    vec4 y3 = x2 * y + y2 * x;
    vec4 x4 = x2 * x2 - y2 * y2;
    vec4 y4 = 2.0 * x2 * y2;
    vec4 x7 = x4 * x3 - y4 * y3;
    vec4 y7 = x4 * y3 + y4 * x3;
    vec4 total = waves.k1 * x + waves.k4 * x2 + waves.k9 * x3 + waves.k16 * x4
                 + waves.k25 * (x4 * x - y4 * y) + waves.k36 * (x3 * x3 - y3 * y3);
    vec4 rest = 1.0 - waves.k15 * x;
    vec4 lost = waves.k15 * y;
    return total + waves.k49 * (x7 * rest - y7 * lost) / max(rest * rest + lost * lost, THIN_FILM_LEAST);
}

// Reflectance of one polarization: amplitude r12 of the upper interface, and re + i im of the lower one.
vec3 thin_film_polarized(float r12, vec3 re, vec3 im, ThinFilmWaves waves)
{
    float R12 = r12 * r12;
    float T12 = 1.0 - R12;
    vec3 R23 = re * re + im * im;
    vec3 left = max(1.0 - R12 * R23, THIN_FILM_LEAST);
    vec3 orders = vec3(dot(THIN_FILM_RED, thin_film_orders(-r12 * vec2(re.x, im.x), waves)),
                       dot(THIN_FILM_GREEN, thin_film_orders(-r12 * vec2(re.y, im.y), waves)),
                       dot(THIN_FILM_BLUE, thin_film_orders(-r12 * vec2(re.z, im.z), waves)));
    return R12 + T12 * (T12 * R23 - 2.0 * (1.0 - R23) * orders) / left;
}

// Root U + i V of (ior + i extinction)^2 - n^2 sin^2, of which the smaller part does not cancel.
void thin_film_root(float n2_sin2, vec3 ior, vec3 extinction, out vec3 U, out vec3 V)
{
    vec3 A = ior * ior - extinction * extinction - n2_sin2;
    vec3 Q = ior * extinction;
    vec3 larger = sqrt(0.5 * (sqrt(A * A + 4.0 * Q * Q) + abs(A)));
    vec3 smaller = Q / max(larger, THIN_FILM_LEAST);
    vec3 dense = step(vec3(0.0), A);
    U = mix(smaller, larger, dense);
    V = mix(larger, smaller, dense);
}

// (a - b) / (a + b) of complex vectors, a in x + i y, b in u + i v.
void thin_film_amplitude(vec3 x, vec3 y, vec3 u, vec3 v, out vec3 re, out vec3 im)
{
    vec3 below = max((x + u) * (x + u) + (y + v) * (y + v), THIN_FILM_LEAST);
    re = (x * x + y * y - u * u - v * v) / below;
    im = 2.0 * (y * u - x * v) / below;
}

// F_airy at a cosine. A film thinner than vacuum counts as vacuum; a negative curve has no amplitude.
vec3 thin_film_fresnel(float mu, FresnelData fd)
{
    float n = max(fd.tf_ior, 1.0);
    float sin2 = (1.0 - mu) * (1.0 + mu);
    float mu_t = sqrt(max(1.0 - sin2 / (n * n), 0.0));
    ThinFilmWaves waves = thin_film_waves(2.0e-9 * n * mu_t * fd.tf_thickness);
    float gap = (n - 1.0) * (n + 1.0);  // 0 without a film, at grazing too
    float s = mu + n * mu_t;
    float p = n * mu + mu_t;
    float r_s = -gap / max(s * s, THIN_FILM_LEAST);
    float r_p = gap * (mu * mu - sin2 / (n * n)) / max(p * p, THIN_FILM_LEAST);
    vec3 re_p, im_p, re_s, im_s;
    if (fd.model == FRESNEL_MODEL_SCHLICK)
    {
        re_p = sqrt(max(mx_fresnel_hoffman_schlick(mu_t, fd), 0.0))
               * (2.0 * step(vec3((n - 1.0) / (n + 1.0)), sqrt(fd.F0)) - 1.0);  // index above n
        re_s = -re_p;
        im_p = vec3(0.0);
        im_s = vec3(0.0);
    }
    else
    {
        vec3 U, V;
        thin_film_root(sin2, fd.ior, fd.extinction, U, V);
        thin_film_amplitude(vec3(n * mu_t), vec3(0.0), U, V, re_s, im_s);
        vec3 real = (fd.ior * fd.ior - fd.extinction * fd.extinction) * mu_t;
        thin_film_amplitude(real, 2.0 * fd.ior * fd.extinction * mu_t, n * U, n * V, re_p, im_p);
    }
    vec3 F = thin_film_polarized(r_p, re_p, im_p, waves) + thin_film_polarized(r_s, re_s, im_s, waves);
    return clamp(0.5 * F, 0.0, 1.0);
}

// Cosine and weight of node i, from 1 to 6, of F_ss, the cosine-weighted average over the hemisphere.
vec2 thin_film_gauss(int i)
{
    if (i < 4)
    {
        return i < 2 ? THIN_FILM_GAUSS1 : (i == 2 ? THIN_FILM_GAUSS2 : THIN_FILM_GAUSS3);
    }
    return i == 4 ? THIN_FILM_GAUSS4 : (i == 5 ? THIN_FILM_GAUSS5 : THIN_FILM_GAUSS6);
}
