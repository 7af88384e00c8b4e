// SPDX-License-Identifier: Apache-2.0
// Texture coordinates of points.

// Angle of (x, y) from the x axis as a fraction of a full turn, in [-0.5, 0.5].
float stage_turn(float y, float x);

// Longitude and latitude as on a globe, with the middle facing the viewer.
vec2 stage_globe(vec3 direction)
{
    float latitude = 2.0 * stage_turn(direction.y, length(direction.xz));
    return 0.5 + vec2(stage_turn(direction.x, direction.z), latitude);
}

// Texture coordinates of a globe or, for flat shapes, two axes in the plane at a similar scale.
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
