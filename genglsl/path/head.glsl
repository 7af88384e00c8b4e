// SPDX-License-Identifier: Apache-2.0
// A surface point, and the global variables of one query of a material.

struct Point
{
    vec3 position;
    vec3 normal;   // shading normal, unit
    vec3 tangent;  // unit, orthogonal to normal
    vec2 texcoord;
    bool inside;   // whether wo lies inside a solid of this material
};

#define PATH_NOTHING 0
#define PATH_VALUE 1
#define PATH_PDF 2
#define PATH_DRAW 3

int path_asked;
vec3 path_wo;
vec3 path_wi;
vec3 path_u;
bool path_inside;
bool path_thin;
float path_eta; // index of refraction below the lobe / index above
vec3 path_facet; // normal of the facet: drawn, or computed from wo and wi
vec3 path_inner; // wo in the denser medium: transmitted fraction, E_ss, mean F of visible facets
float path_reversed; // G_1 of wi outside / G_1 of wo inside, or 0 if the facet transmits no light
vec3 path_root; // response of the closure called last

#define u_numActiveLightSources 1
#define u_refractionTwoSided false

// Octahedral map of unit vectors to the square [-1, 1]^2, inverted by path_unpacked.
vec2 path_fold(vec2 w)
{
    return vec2(w.x < 0.0 ? abs(w.y) - 1.0 : 1.0 - abs(w.y), w.y < 0.0 ? abs(w.x) - 1.0 : 1.0 - abs(w.x));
}

vec2 path_packed(vec3 w)
{
    vec2 flat_w = w.xy / (abs(w.x) + abs(w.y) + abs(w.z));
    return w.z < 0.0 ? path_fold(flat_w) : flat_w;
}

vec3 path_unpacked(vec2 w)
{
    float z = 1.0 - abs(w.x) - abs(w.y);
    return normalize(vec3(z < 0.0 ? path_fold(w) : w, z));
}
