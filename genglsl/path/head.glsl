// SPDX-License-Identifier: Apache-2.0
// A point of a surface, and what one question to its material has to remember.

struct Point
{
    vec3 position;
    vec3 normal;   // of shading, unit
    vec3 tangent;  // unit, across the normal
    vec2 texcoord;
    bool inside;   // whether wo lies inside a solid of this material, which bends light the other way there
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
float path_eta; // index of the lobe below relative to that above
vec3 path_facet; // of the lobe: the one that is drawn, or that joins both directions
vec3 path_inner; // of the view from the denser side: share that a dielectric passes, E_ss, mean F of visible facets
float path_reversed; // G_1 outside over that inside; 0 where the facet lets nothing pass
vec3 path_root; // answer of the closure called last, which is that of the material

#define u_numActiveLightSources 1
#define u_refractionTwoSided false
