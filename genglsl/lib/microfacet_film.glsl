// SPDX-License-Identifier: Apache-2.0
// Reflectances of a microfacet lobe under a thin film: F_airy at the half vector, its average F_ss over the
// hemisphere, for the factor 1 + F_ss (1 - E_ss) / E_ss of [MaterialX2026], Energy Compensation, and its average
// over the visible facets, which times E_ss and that factor is the albedo. Each average is a sum over three nodes.
// A node stands for a width of cosines, whose waves fade. Each call computes what its closure needs, and keeps nothing.

#include "microfacet_lobe.glsl"
#include "thin_film.glsl"

// F_ss: cosine, weight and width of its nodes. Source: tools/fits/thin_film_nodes.py. Domain: films up to 1000 nm
// of indices in [1, 2.5]. Largest error: 3.5e-2, without a film 4.4e-3.
#define MICROFACET_FILM_AVERAGE_1 vec3(0.18007, 0.11003, 0.1992)
#define MICROFACET_FILM_AVERAGE_2 vec3(0.55789, 0.43884, 0.13803)
#define MICROFACET_FILM_AVERAGE_3 vec3(0.88374, 0.45114, 0.088381)

// Visible facets: mean of the nodes' cosines, their reach and their bend, coefficients of mu^i y^j with
// y = alpha / (alpha + 0.2). Source and films as above. Domain: mu in [0.1, 1], alpha in [0.01, 1]. Largest error
// of the average: 7.7e-2, of a film of index 1.16 in which a metal of a lower index reflects totally.
#define MICROFACET_FILM_FACETS_00 vec3(3.2739, 0.21155, 0.39911)
#define MICROFACET_FILM_FACETS_01 vec3(-1.0485, 3.7698, -1.0011)
#define MICROFACET_FILM_FACETS_02 vec3(-3.9422, -4.8277, 1.2036)
#define MICROFACET_FILM_FACETS_03 vec3(1.6943, 0.78139, -0.88274)
#define MICROFACET_FILM_FACETS_10 vec3(-0.10219, 3.7484, 0.42655)
#define MICROFACET_FILM_FACETS_11 vec3(2.4881, -7.6828, -0.10374)
#define MICROFACET_FILM_FACETS_12 vec3(-2.8084, 3.4317, -0.6846)
#define MICROFACET_FILM_FACETS_20 vec3(-7.7466, -2.6436, -1.2458)
#define MICROFACET_FILM_FACETS_21 vec3(8.2377, 3.5978, 1.73)
#define MICROFACET_FILM_FACETS_30 vec3(0.018445, -0.3586, -0.12605)

// Outer node of Gauss's rule of three for a semicircle over [-1, 1], in which x has the weight (1 - x^2) / 2.
#define MICROFACET_FILM_OUTER 0.70710678

// Mean of the cosines of wo with the visible facets, reach of the nodes around it, and their bend.
vec3 microfacet_film_facets(float mu, float alpha)
{
    float y = alpha / (alpha + 0.2);
    vec3 C0 = MICROFACET_FILM_FACETS_00
              + y * (MICROFACET_FILM_FACETS_01 + y * (MICROFACET_FILM_FACETS_02 + y * MICROFACET_FILM_FACETS_03));
    vec3 C1 = MICROFACET_FILM_FACETS_10 + y * (MICROFACET_FILM_FACETS_11 + y * MICROFACET_FILM_FACETS_12);
    vec3 C2 = MICROFACET_FILM_FACETS_20 + y * MICROFACET_FILM_FACETS_21;
    vec3 C = C0 + mu * (C1 + mu * (C2 + mu * MICROFACET_FILM_FACETS_30));
    float s = alpha / sqrt(mu + alpha);
    return vec3(mu + s * s * C.x, s * C.y, C.z);
}

// Cosine and width of node i, and its weights in the averages: 0 to 2 are of the visible facets, 3 to 5 of F_ss,
// 6 is the half vector.
vec4 microfacet_film_node(int i, float mu_h, vec3 facets)
{
    float x = MICROFACET_FILM_OUTER * float(i - 1);
    float mu = facets.x + facets.y * (x + facets.z * (4.0 * x * x - 1.0));  // a bend keeps the mean
    vec3 average = i < 4 ? MICROFACET_FILM_AVERAGE_1 : MICROFACET_FILM_AVERAGE_2;
    average = i == 5 ? MICROFACET_FILM_AVERAGE_3 : average;

    vec4 node = vec4(clamp(mu, 0.0, 1.0), facets.y / 3.0, 0.5 - 0.5 * x * x, 0.0);
    node = i > 2 ? vec4(average.x, average.z, 0.0, average.y) : node;
    return i > 5 ? vec4(mu_h, 0.0, 0.0, 0.0) : node;
}

// Reflectances under a film instead of those without one. What no closure asks for is not averaged: the value in
// an environment, and the visible facets of a metal in a light: nothing lies below it.
void microfacet_film(MicrofacetLobe lobe, FresnelData fd, inout MicrofacetFresnel F)
{
    if (fd.airy)
    {
        vec3 facets = microfacet_film_facets(lobe.mu_o, lobe.alpha);
        bool is_lit = lobe.closure == CLOSURE_TYPE_REFLECTION;
        int i = is_lit && fd.model == FRESNEL_MODEL_CONDUCTOR ? 3 : 0;
        int end = is_lit ? 7 : 6;
        F = MicrofacetFresnel(vec3(0.0), vec3(0.0), vec3(0.0));
        do
        {
            vec4 node = microfacet_film_node(i, lobe.mu_h, facets);
            F.value = thin_film_fresnel(node.x, node.y, fd);  // the last node's is the half vector's
            F.visible += node.z * F.value;
            F.average += node.w * F.value;
            i++;
        } while (i < end);
    }
}
