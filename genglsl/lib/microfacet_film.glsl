// SPDX-License-Identifier: Apache-2.0

#include "microfacet_lobe.glsl"
#include "thin_film.glsl"

// Reflectance F_airy of a microfacet lobe under a thin film: at the half vector, and averaged over
// the hemisphere (F_ss) and over visible facets. An average is a sum over three cosines
// (nodes), each with a width over which fringes partly cancel.

// Cosine, weight and width of the nodes of F_ss. Source: tools/fits/thin_film_nodes.py. Domain:
// films up to 1000 nm with index in [1, 2.5]. Largest error: 3.61e-2, or 4.4e-3 for a vanishing
// film.
#define FILM_AVERAGE_1 vec3(0.17999, 0.10982, 0.19938)
#define FILM_AVERAGE_2 vec3(0.55701, 0.43737, 0.13743)
#define FILM_AVERAGE_3 vec3(0.88292, 0.4528, 0.088681)

// For visible facets, Gauss's rule for a semicircle has the nodes -x, 0 and x = FILM_OUTER. A node
// y has the weight (1 - y^2) / 2.
#define FILM_OUTER 0.70710678

// A node is (cosine, width, weight of visible facets, weight of F_ss). Nodes 0 to 2 are for
// visible facets, 3 to 5 for F_ss, and node 6 is the half vector.
vec4 microfacet_film_node(int i, float mu_h, vec3 facets)
{
    float x = FILM_OUTER * float(i - 1);
    float mu = facets.x + facets.y * (x + facets.z * (4.0 * x * x - 1.0));  // the bend averages 0
    vec3 average = i < 4 ? FILM_AVERAGE_1 : FILM_AVERAGE_2;
    average = i == 5 ? FILM_AVERAGE_3 : average;

    vec4 node = vec4(clamp(mu, 0.0, 1.0), facets.y / 3.0, 0.5 - 0.5 * x * x, 0.0);
    node = i > 2 ? vec4(average.x, average.z, 0.0, average.y) : node;
    return i > 5 ? vec4(mu_h, 0.0, 0.0, 0.0) : node;
}

// Reflectances under a film. F at the half vector is skipped in environments. The average over
// visible facets is skipped for opaque metal in direct light.
void microfacet_film(MicrofacetLobe lobe, FresnelData fd, inout MicrofacetFresnel F)
{
    F.outside = vec3(1.0);
    if (fd.airy)
    {
        float mu = lobe.visible.x;
        float alpha = lobe.visible.y;
        float y = alpha / (alpha + 0.2);
        // Mean cosine, half width and bend of the nodes for visible facets. Source:
        // tools/fits/thin_film_nodes.py. Domain: mu in [0.1, 1], alpha in [0.01, 1]. Largest error:
        // 7.7e-2, for total reflection between a film of index 1.16 and a metal of lower index.
        // Outside the domain: 0.14.
        vec3 C = vec3(3.252, 0.32298, 0.14542)
            + y * (vec3(-0.91173, 3.3428, 0.030955) + y * (vec3(-4.1529, -4.255, -0.22576)
            + y * vec3(1.7917, 0.51298, -0.22374)))
            + mu * (vec3(-0.12447, 3.6133, 1.0328)
            + y * (vec3(2.405, -7.43, -1.4779) + y * vec3(-2.6953, 3.3391, 0.16285))
            + mu * (vec3(-7.6708, -2.597, -1.7185) + y * vec3(8.1838, 3.5172, 2.1385)
            + mu * vec3(0.0010818, -0.34239, 0.018052)));
        float s = alpha / sqrt(mu + alpha);
        vec3 facets = vec3(mu + s * s * C.x, s * C.y, C.z);
        bool is_lit = lobe.closure == CLOSURE_TYPE_REFLECTION;
        int i = is_lit && fd.model == FRESNEL_MODEL_CONDUCTOR ? 3 : 0;
        int end = is_lit ? 7 : 6;
        F.visible = vec3(0.0);
        F.average = vec3(0.0);
        do
        {
            vec4 node = microfacet_film_node(i, lobe.mu_h, facets);
            F.value = thin_film_fresnel(node.x, node.y, fd);  // the last node is the half vector
            F.visible += node.z * F.value;
            F.average += node.w * F.value;
            i++;
        } while (i < end);
        F.outside = F.visible;
    }
}
