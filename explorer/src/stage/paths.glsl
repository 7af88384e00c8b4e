// SPDX-License-Identifier: Apache-2.0
// One path per pixel and pass, averaged with the passes before it. Stands behind the twins, the
// shapes, the camera and the macros STAGE_VALUE, STAGE_SAMPLE and STAGE_PDF.

uniform highp sampler2D stage_before;
uniform highp sampler2D stage_before_square;
uniform highp sampler2D stage_environment;
uniform int stage_pass;
uniform int stage_bounces; // Reflections that a path may have.
uniform float stage_share; // Of this pass in the averages.
uniform vec3 stage_light; // In the world, unit.
uniform float stage_intensity;
uniform vec3 stage_rho;
uniform float stage_parameter; // Roughness or sigma of the model
uniform float stage_roughness; // of the sampler

layout(location = 0) out vec4 stage_radiance; // Mean of the paths, and the share that met an object.
layout(location = 1) out vec4 stage_square; // Mean of the square of the mean of its three channels.

// One round of the generator below.
uvec4 stage_mixed(uvec4 v)
{
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// pcg4d of [Jarzynski2020]: random numbers of 24 bits in [0, 1), from counters alone.
vec4 stage_random(int dimension)
{
    uvec4 v = uvec4(uvec2(gl_FragCoord.xy), uint(stage_pass), uint(dimension));
    v = stage_mixed(v * 1664525u + 1013904223u);
    v = stage_mixed(v ^ (v >> 16u));
    return vec4(v >> 8u) / 16777216.0;
}

// The normal as the third of three axes, in columns.
mat3 stage_axes(vec3 normal)
{
    vec3 up = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, -1.0);
    vec3 x = normalize(cross(up, normal));
    return mat3(x, cross(normal, x), normal);
}

vec3 stage_value(int part, vec3 wo, vec3 wi)
{
    if (part == STAGE_FLOOR)
        return lambert_brdf(wo, wi, vec3(STAGE_FLOOR_RHO));
    vec3 rho = stage_rho;
    float r = stage_parameter;
    return STAGE_VALUE;
}

// What the light sends towards wo.
vec3 stage_reflected(int part, vec3 p, mat3 axes, vec3 wo)
{
    vec3 wi = stage_light * axes;
    if (stage_intensity == 0.0 || wi.z <= 0.0 || stage_nearest(p, stage_light).t < STAGE_NEVER)
        return vec3(0.0);
    return EON_PI * stage_intensity * wi.z * stage_value(part, wo, wi);
}

// Draws wi; returns the weight of the path that goes on there, 0 if it is wasted.
vec3 stage_drawn(int part, vec3 wo, vec2 u, out vec3 wi)
{
    wi = cosine_sample(u.x, u.y);
    float pdf = cosine_pdf(wi);
    if (part == STAGE_SUBJECT) {
        float r = stage_roughness;
        float rho = dot(stage_rho, vec3(1.0 / 3.0));
        wi = STAGE_SAMPLE;
        pdf = wi.z > 0.0 ? STAGE_PDF : 0.0;
    }
    return pdf > 0.0 ? stage_value(part, wo, wi) * wi.z / pdf : vec3(0.0);
}

// Radiance of one path that ends where it leaves the objects or has no reflection left.
vec4 stage_path(vec3 origin, vec3 direction)
{
    vec3 radiance = vec3(0.0);
    vec3 weight = vec3(1.0);
    for (int bounce = 0; bounce <= stage_bounces; ++bounce) {
        Hit hit = stage_nearest(origin, direction);
        if (hit.part == STAGE_NOTHING) {
            vec3 sky = textureLod(stage_environment, stage_latlong(direction), 0.0).xyz;
            return bounce == 0 ? vec4(0.0) : vec4(radiance + sky * weight, 1.0);
        }
        if (bounce == stage_bounces || weight == vec3(0.0))
            break;
        mat3 axes = stage_axes(hit.normal);
        vec3 wo = -direction * axes;
        wo.z = clamp(wo.z, 0.0, 1.0);
        origin += hit.t * direction + STAGE_OFFSET * hit.normal;
        radiance += weight * stage_reflected(hit.part, origin, axes, wo);
        vec3 wi;
        weight *= stage_drawn(hit.part, wo, stage_random(1 + bounce).xy, wi);
        direction = normalize(axes * wi);
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
