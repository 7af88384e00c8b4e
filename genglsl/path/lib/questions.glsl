// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl"

// path_asked selects the `response` of a closure.
//   PATH_VALUE: f cos(theta_i) for path_wo and path_wi
//   PATH_PDF: (weight, density of path_wi in 1/sr, 0)
//   PATH_DRAW: (weight, drawn direction packed into two numbers)
// The weight is the closure's approximate albedo. Draws choose between two closures by weight, and
// combined densities are averaged by weight. So densities are exact, although weights are not.

// In an environment of radiance 1, the response to CLOSURE_TYPE_INDIRECT is the albedo. Paths have
// no derivatives in screen space.
#define mx_environment_irradiance(N) vec3(1.0)
#define fwidth(x) vec3(0.0)

#define PATH_WASTED vec2(4.0, 0.0)

// A closure is evaluated only when the surface node evaluates a light.
bool path_is_asked(ClosureData closureData)
{
    return closureData.closureType == CLOSURE_TYPE_REFLECTION && path_asked != PATH_NOTHING;
}

// Arguments for the response to direct light.
ClosureData path_question_in_direct_light(ClosureData closureData)
{
    closureData.closureType = CLOSURE_TYPE_REFLECTION;
    closureData.L = path_wi;
    closureData.V = path_wo;
    closureData.occlusion = 1.0;
    return closureData;
}

// Arguments for the value if path_asked is PATH_VALUE, otherwise for the albedo.
ClosureData path_question(ClosureData closureData)
{
    closureData = path_question_in_direct_light(closureData);
    closureData.closureType = path_asked == PATH_VALUE ? CLOSURE_TYPE_REFLECTION : CLOSURE_TYPE_INDIRECT;
    return closureData;
}

float path_mean(vec3 color)
{
    return dot(max(color, 0.0), vec3(1.0 / 3.0));
}

// Components of w along X, cross(N, X) and N. path_world is the inverse.
vec3 path_local(vec3 w, vec3 X, vec3 N)
{
    return vec3(dot(w, X), dot(w, cross(N, X)), dot(w, N));
}

vec3 path_world(vec3 w, vec3 X, vec3 N)
{
    return normalize(w.x * X + w.y * cross(N, X) + w.z * N);
}

// A unit vector orthogonal to N.
vec3 path_across(vec3 N)
{
    return normalize(cross(abs(N.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), N));
}

// Response to PATH_DRAW (weight, direction) or to PATH_PDF (weight, density).
vec3 path_answer(float weight, vec2 drawn, float pdf)
{
    return path_asked == PATH_DRAW ? vec3(weight, drawn) : vec3(weight, pdf, 0.0);
}

// Response of two lobes. A draw chooses a lobe by path_u.z and rescales path_u.z.
vec3 path_either(vec3 a, vec3 b)
{
    float total = a.x + b.x;
    if (!(total > 0.0))
    {
        return vec3(0.0);
    }
    float share = a.x / total;
    if (path_asked == PATH_PDF)
    {
        return vec3(total, mix(b.y, a.y, share), 0.0);
    }
    bool first = path_u.z < share;
    path_u.z = first ? path_u.z / share : (path_u.z - share) / (1.0 - share);
    return vec3(total, first ? a.yz : b.yz);
}

vec3 path_scaled(vec3 response, vec3 factor)
{
    return path_asked == PATH_VALUE ? response * factor : vec3(response.x * path_mean(factor), response.yz);
}

// The closure called last is the root of the material.
void path_end(BSDF bsdf)
{
    path_root = bsdf.response;
}

// Draws wi in proportion to dot(wi, N). On entry, bsdf.response is the value or the albedo.
void path_cosine(vec3 N, inout BSDF bsdf)
{
    if (path_asked != PATH_VALUE)
    {
        vec3 X = path_across(N);
        float phi = 2.0 * M_PI * path_u.y;
        vec3 wi = vec3(sqrt(path_u.x) * vec2(mx_cos(phi), mx_sin(phi)), sqrt(1.0 - path_u.x));
        float pdf = max(dot(N, path_wi), 0.0) * M_PI_INV;
        bsdf.response = path_answer(path_mean(bsdf.response), path_packed(path_world(wi, X, N)), pdf);
    }
    path_end(bsdf);
}
