// SPDX-License-Identifier: Apache-2.0
// What each pixel shows: where it is and which way it faces. Materials read this, so that every
// one of them sees the same exact point, and a change of material draws no shape anew.

layout(location = 0) out vec4 stage_surface; // Normal in the viewer's frame, and the part.
layout(location = 1) out vec4 stage_place; // Position in the viewer's frame, share of surroundings.
layout(location = 2) out vec4 stage_detail; // Texture coordinates, opacity.

// Angle of (x, y) from the x axis as a share of a full turn, in [-0.5, 0.5].
float stage_turn(float y, float x)
{
    float radius = max(length(vec2(x, y)), 1.0e-30); // At a pole there is no angle: 0.
    float quarter = 0.25 * oren_nayar_angle(abs(y) / radius, abs(x) / radius);
    return (y < 0.0 ? -1.0 : 1.0) * (x < 0.0 ? 0.5 - quarter : quarter);
}

// Longitude and latitude as on a globe, the middle towards the viewer.
vec2 stage_globe(vec3 direction)
{
    float latitude = 2.0 * stage_turn(direction.y, length(direction.xz));
    return 0.5 + vec2(stage_turn(direction.x, direction.z), latitude);
}

// Texture coordinates: of a globe, and along what is plane its own two axes at about the same scale.
vec2 stage_texture_place(vec3 p, vec3 normal)
{
#if STAGE_SHAPE == 2 || STAGE_SHAPE == 4
    return 0.5 + 0.25 * p.xy;
#elif STAGE_SHAPE == 3
    float radius = length(p);
    if (radius > 1.0001)
        return vec2(stage_globe(normal).x, 0.5 + 0.25 * p.y);
    if (abs(dot(p, normal)) < 0.9 * radius)
        return 0.5 + 0.25 * (normal.y > 0.9 ? p.xz : vec2(length(p.xz), p.y));
    return stage_globe(p / radius);
#else
    return normal.y == 1.0 && p.y < -0.9999 ? 0.5 + 0.25 * vec2(p.x, -p.z) : stage_globe(normal);
#endif
}

// The sphere under the pixel in units of its radius. Whole numbers below 2^24 make the difference
// under the root exact in float32, so that the rim is as sharp as the middle.
void stage_exact_sphere()
{
    vec2 at = stage_from_center();
    float diameter = stage_frame.z;
    float depth = (diameter - at.x) * (diameter + at.x) - at.y * at.y;
    if (depth <= 0.0)
        return;
    vec3 normal = vec3(at, sqrt(depth)) / diameter;
    stage_surface = vec4(normal, STAGE_SUBJECT);
    stage_place = vec4(normal, 1.0);
    stage_detail = vec4(stage_texture_place(normal, normal), 1.0, 0.0);
}

void main()
{
    stage_surface = stage_place = stage_detail = vec4(0.0);
#if STAGE_SHAPE == 0
    stage_exact_sphere();
#else
    vec3 direction = stage_ray();
    Hit hit = stage_nearest(stage_eye, direction);
    if (hit.part == STAGE_NOTHING)
        return;
    vec3 p = stage_eye + hit.t * direction;
    stage_surface = vec4(hit.normal * stage_camera, hit.part);
    stage_place = vec4(p * stage_camera, stage_ambient(p, hit.normal));
    stage_detail = vec4(stage_texture_place(p, hit.normal), stage_opacity(p), 0.0);
#endif
}
