// SPDX-License-Identifier: Apache-2.0
// Traces one path per pixel and pass, and averages the paths of all passes. docs/path_tracing.md
// describes the functions of the material.

uniform highp sampler2D stage_before;
uniform highp sampler2D stage_before_square;
uniform highp sampler2D stage_environment;
uniform int stage_pass;
uniform int stage_bounces; // Maximum number of scattering events on a path.
uniform float stage_share; // Weight of this pass in the averages.
uniform vec3 stage_light; // Unit vector towards the light, in the world frame.
uniform float stage_intensity;
uniform vec2 stage_bend; // Fibers: (height of the center of the bend, 1); other shapes: (0, 0).

// Mean of the paths, and the fraction of paths that hit an object.
layout(location = 0) out vec4 stage_radiance;
// Mean square of the paths' brightness, which is the mean of three channels.
layout(location = 1) out vec4 stage_square;

const float STAGE_PI = 3.14159265358979;

float stage_turn(float y, float x)
{
    return atan(y, x) / (2.0 * STAGE_PI);
}

vec3 stage_random(int dimension)
{
    return path_random(uvec4(uvec2(gl_FragCoord.xy), uint(stage_pass), uint(dimension))).xyz;
}

Point stage_point(vec3 position, vec3 normal, bool inside)
{
    vec3 beside = vec3(normal.z, 0.0, -normal.x);
    if (stage_bend.y > 0.0)
        beside = cross(position - vec3(0.0, stage_bend.x, 0.0), vec3(0.0, 0.0, 1.0));
    vec3 tangent = dot(beside, beside) > 0.0 ? normalize(beside) : vec3(1.0, 0.0, 0.0);
    return Point(position, normal, tangent, stage_texture_place(position, normal), inside);
}

// Direct light that is scattered towards wo.
vec3 stage_reflected(Hit hit, Point p, vec3 wo)
{
    float cosine = dot(hit.normal, stage_light);
    vec3 origin = p.position + STAGE_OFFSET * sign(cosine) * hit.normal;
    if (stage_intensity == 0.0 || stage_nearest(origin, stage_light).t < STAGE_NEVER)
        return vec3(0.0);
    if (hit.part == STAGE_FLOOR)
        return vec3(stage_intensity * STAGE_FLOOR_RHO * max(cosine, 0.0));
    return STAGE_PI * stage_intensity * material_evaluate(p, wo, stage_light);
}

// Samples wi. The result tells whether the path continues along wi.
bool stage_drawn(Hit hit, Point p, vec3 wo, vec3 u, out vec3 wi, out vec3 weight)
{
    float pdf;
    if (hit.part != STAGE_FLOOR)
        return material_sample(p, wo, u, wi, weight, pdf);
    float phi = 2.0 * STAGE_PI * u.x;
    float z = 2.0 * u.y - 1.0;
    // A cosine-distributed direction around the normal.
    wi = normalize(hit.normal + vec3(sqrt(1.0 - z * z) * vec2(cos(phi), sin(phi)), z));
    weight = vec3(STAGE_FLOOR_RHO);
    return true;
}

// Radiance of a path. A path ends outside the scene or after stage_bounces scattering events.
vec4 stage_path(vec3 origin, vec3 direction)
{
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (int bounce = 0; bounce <= stage_bounces; ++bounce) {
        Hit hit = stage_nearest(origin, direction);
        if (hit.part == STAGE_NOTHING) {
            vec3 sky = textureLod(stage_environment, stage_latlong(direction), 0.0).xyz;
            return bounce == 0 ? vec4(0.0) : vec4(radiance + sky * throughput, 1.0);
        }
        // Only spheres have an inside. All other shapes are infinitely thin sheets.
        bool inside = STAGE_SHAPE < 2 && dot(origin, origin) < 1.0;
        vec3 outward = inside ? -hit.normal : hit.normal;
        Point p = stage_point(origin + hit.t * direction, outward, inside && !(material_is_thin_walled));
        if (hit.part == STAGE_SUBJECT)
            radiance += throughput * material_emitted(p, -direction);
        if (bounce == stage_bounces)
            break;
        radiance += throughput * stage_reflected(hit, p, -direction);
        vec3 wi;
        vec3 weight;
        if (!stage_drawn(hit, p, -direction, stage_random(1 + bounce), wi, weight))
            break;
        throughput *= weight;
        direction = wi;
        origin = p.position + STAGE_OFFSET * sign(dot(wi, hit.normal)) * hit.normal;
    }
    return vec4(radiance, 1.0);
}

void main()
{
#if STAGE_SHAPE == 0
    vec2 at = (stage_from_center()) / stage_frame.z;
    vec4 path = stage_path(vec3(at, 4.0), vec3(0.0, 0.0, -1.0));
#else
    vec4 path = stage_path(stage_eye, stage_ray());
#endif
    float gray = dot(path.xyz, vec3(1.0 / 3.0));
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    stage_radiance = path;
    stage_square = vec4(gray * gray, 0.0, 0.0, 1.0);
    if (stage_share < 1.0) {
        stage_radiance = mix(texelFetch(stage_before, pixel, 0), path, stage_share);
        stage_square = mix(texelFetch(stage_before_square, pixel, 0), stage_square, stage_share);
    }
}
