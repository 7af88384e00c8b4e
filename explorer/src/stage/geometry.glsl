// SPDX-License-Identifier: Apache-2.0
// Position and normal of each pixel, which all materials read. So materials shade exactly the same
// points, and switching materials does not redraw the shape.

layout(location = 0) out vec4 stage_surface; // Normal in the viewer's frame, and the part's number.
// Position in the viewer's frame, and the visible share of the surroundings.
layout(location = 1) out vec4 stage_place;
layout(location = 2) out vec4 stage_detail; // Texture coordinates, opacity.

// Angle of (x, y) from the x axis as a fraction of a full turn, in [-0.5, 0.5].
float stage_turn(float y, float x)
{
    float radius = max(length(vec2(x, y)), 1.0e-30); // At a pole, the undefined angle becomes 0.
    float quarter = 0.25 * oren_nayar_angle(abs(y) / radius, abs(x) / radius);
    return (y < 0.0 ? -1.0 : 1.0) * (x < 0.0 ? 0.5 - quarter : quarter);
}

// The point of the sphere at the pixel, in units of the radius. For integers below 2^24, the
// difference under the root is exact in float32, which keeps the rim sharp.
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
