// SPDX-License-Identifier: Apache-2.0
// Rays through the pixels of the picture.

uniform mat3 stage_camera; // Its columns are the axes of the viewer's frame in the world.
uniform vec3 stage_eye; // In the world; read by perspective cameras alone.
uniform vec4 stage_frame; // Width and height, the sphere's diameter, and the focal length, in pixels.
uniform vec2 stage_jitter; // In pixels; 0 in the first frame, which is exact at the centers.

// Twice the distance from the center of the frame, in pixels: odd whole numbers without jitter.
vec2 stage_from_center()
{
    return 2.0 * (gl_FragCoord.xy + stage_jitter) - stage_frame.xy;
}

// Direction of the ray through the pixel, in the world.
vec3 stage_ray()
{
    return stage_camera * normalize(vec3(stage_from_center(), -2.0 * stage_frame.w));
}
