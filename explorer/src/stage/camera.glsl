// SPDX-License-Identifier: Apache-2.0
// Rays through the pixels of the picture.

uniform mat3 stage_camera; // The columns are the axes of the viewer's frame, in the world frame.
uniform vec3 stage_eye; // Eye position in the world frame, for perspective cameras.
uniform vec4 stage_frame; // Width, height, diameter of the sphere and focal length, in pixels.
// Offset in pixels; 0 in the first frame, whose samples are the pixel centers.
uniform vec2 stage_jitter;

// Twice the distance in pixels from the frame's center; without jitter, an odd integer.
vec2 stage_from_center()
{
    return 2.0 * (gl_FragCoord.xy + stage_jitter) - stage_frame.xy;
}

// Direction of the ray through the pixel, in the world frame.
vec3 stage_ray()
{
    return stage_camera * normalize(vec3(stage_from_center(), -2.0 * stage_frame.w));
}
